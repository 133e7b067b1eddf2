"""The fit of one set, by the code of a calibration, and what its intervals say; the truth is not read before."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from palpate.configuration.settings import CalibrationSettings
from palpate.data.observation import Observation
from palpate.inference.calibrate import LEAST_R2, base_fit
from palpate.inference.calibration_result import MOST_MISFIT
from palpate.inference.estimates import condition_errors, estimates, intervals, law_discrepancy
from palpate.inference.problem import Problem
from palpate.mechanisms import Scale
from studies.coverage.sets import Case, recordings
from studies.coverage.solid import MATERIAL, BurgersSolid

SCALE = Scale(depth=500, load=10.0, modulus=3.0, duration=240, loading_time=10, half_angle=70.3, pressure=0.2)


def fitted(case: Case, law_error: float) -> dict[str, Any]:
    """Return the row of a set: estimates, intervals, the discrepancy of the law, and seconds of processor time."""
    begun = time.process_time()
    observed = recordings(case)
    solid = BurgersSolid(case.conditions)
    problem = Problem(case.conditions, observed, solid, SCALE)  # type: ignore[arg-type]  # nothing is simulated
    settings = CalibrationSettings(law_error=law_error, solver_error=0.0)  # a closed form has no mesh
    start = MATERIAL.named(np.full(len(MATERIAL.free), 0.5))
    problem, fit = base_fit(problem, settings, [start], np.random.default_rng(case.seed), lambda line: None)
    found = estimates(fit, intervals(fit), _explained(problem.replicated, fit.misfit_ratio, observed, fit.everywhere))
    row: dict[str, Any] = {"name": case.name, "law_error": law_error, "converged": bool(fit.converged)}
    row |= {"misfit_ratio": float(fit.misfit_ratio), "rms_nm": float(np.sqrt(np.mean(fit.residual**2)))}
    for name, each in found.items():
        row |= {f"{name}.{key}": getattr(each, key) for key in ("estimate", "lower", "upper", "identified")}
    row |= {f"law.{key}": value for key, value in (law_discrepancy(fit) or {}).items()}
    return row | {"seconds": time.process_time() - begun}


def _explained(
    replicated: bool, ratio: float, observed: Mapping[str, Observation], curves: Mapping[str, np.ndarray | str]
) -> bool:
    """Return whether a fit explains its recordings, as `palpate.inference.calibrate.calibrate` has it."""
    simulated = {name: curve for name, curve in curves.items() if not isinstance(curve, str)}
    table = condition_errors(observed, simulated)
    return (not replicated or ratio < MOST_MISFIT) and all(each["r2"] > LEAST_R2 for each in table.values())
