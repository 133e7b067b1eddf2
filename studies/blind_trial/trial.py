"""The steps of the trial that follow the recordings: diagnose, and only then score with the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import chi2

from palpate.configuration.study_file import Study
from palpate.data.study_recordings import observations
from palpate.diagnosis.candidates import candidates
from palpate.diagnosis.parts import in_segments
from palpate.diagnosis.screen import screened_places
from palpate.diagnosis.study_diagnosis import run_diagnosis
from palpate.errors import PalpateError
from palpate.inference.covariance import errors, noise_of
from palpate.inference.explanation import Fit
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.solver.variation import added_by_instrument
from palpate.study.prescribed_segments import segments
from palpate.workflow_support.result_files import read_json
from studies.blind_trial.cases import Case
from studies.blind_trial.laboratory import body_depths
from studies.blind_trial.score import row


def diagnose_case(study: Study, folder: Path, report: Callable[[str], None]) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose the recordings in `folder`; nothing of the truth is read."""
    return run_diagnosis(replace(study, recordings={"case": folder}), "case", report=report)


def strength(study: Study, case: Case, folder: Path) -> float:
    """Return the projected signature of the weakest library effect over the detection limit; NaN where there is none.

    A signature is the true effect at the true material, with whatever else acts, on the laboratory's own mesh, whitened
    and projected off the base model's tangent space there and off the other effect. The limit is the size that the most
    sensitive filter notices at a family-wise one per cent (Bonferroni).

    Raises
    ------
    PalpateError
        When a simulation fails.
    """
    if not case.mechanisms:
        return float("nan")
    problem = Problem.of(study, observations(replace(study, recordings={"case": folder}), "case"))
    z = problem.forward.coordinates.scaled(case.parameters)
    base = problem.forward.reanchored(z)
    (found,) = base.tangents([z])
    if isinstance(found, str):
        raise PalpateError(found)
    curve, tangent = (problem.stacked(parts) for parts in found)
    scatter, solver_error = study.calibration.site_scatter, study.calibration.solver_error
    noise = noise_of(problem, (), problem.mean - curve, scatter)
    fit = Fit(problem, (), base, z, errors(problem, base, (), curve, noise, solver_error), curve, tangent)
    signatures = fit.whiten(_effects(study, problem, case))
    sizes = []
    for k, white in enumerate(signatures.T):
        others = np.linalg.qr(np.column_stack([fit.tangent_space, np.delete(signatures, k, axis=1)]))[0]
        sizes.append(float(np.linalg.norm(white - others @ (others.T @ white))))
    count = sum(1 for _ in in_segments(problem, segments))
    count += sum(len(screened_places(problem, key)) + MECHANISMS[key].varies for key in candidates(study))
    return min(sizes) / float(np.sqrt(chi2.isf(study.diagnosis.significance / count, 1)))


def _effects(study: Study, problem: Problem, case: Case) -> np.ndarray:
    """Return what each mechanism of a case adds to the depth of all conditions (n_all, mechanisms) [nm]."""
    bodily = [key for key in case.mechanisms if not MECHANISMS[key].varies]
    without = [replace(case, mechanisms={k: v for k, v in case.mechanisms.items() if k != key}) for key in bodily]
    accuracy = study.challenge.accuracy
    simulated = body_depths(study, [case, *without] if bodily else [], problem.conditions, accuracy)
    parts = []
    for condition, depths in zip(problem.conditions, simulated, strict=True):
        added = {key: depths[0] - depth for key, depth in zip(bodily, depths[1:], strict=True)}
        for key in case.mechanisms:
            if key not in added:
                added[key] = added_by_instrument(
                    {key: case.mechanisms[key]}, condition.protocol, np.zeros(len(condition.protocol.sample_time))
                )
        parts.append(np.column_stack([added[key] for key in case.mechanisms]))
    return np.concatenate(parts)


def score_case(study: Study, case: Case, diagnosis: Path, folder: Path) -> dict[str, Any]:
    """Return the row of one case; a strength that cannot be simulated is NaN, and counts as weak."""
    try:
        size = strength(study, case, folder)
    except PalpateError as error:
        print(f"strength not known: {error}")
        size = float("nan")
    return row(vars(case), read_json(diagnosis), size)
