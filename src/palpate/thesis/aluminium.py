"""Chapter 4 from end to end: surrogates of 64 and 36 points, calibration against recordings of known truth, errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from palpate.calibration import calibrate
from palpate.calibration.measures import relative
from palpate.config import Study
from palpate.errors import PalpateError
from palpate.model import simulate
from palpate.observations import observations
from palpate.steps import settings_of
from palpate.surrogate import PODRBF
from palpate.thesis.grids import ALUMINIUM
from palpate.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare

GRIDS = {"64": "aluminium_full", "36": "aluminium_reduced"}


def run(context: Context) -> Outcome:
    """Calibrate with both grids; the solver confirms and corrects."""
    study = context.studies["aluminium"]
    measured = observations(study, "virtual")
    truth = study.laboratory["virtual"]["parameters"]
    bounds = {name: (min(levels), max(levels)) for name, levels in study.levels.items()}
    (name,) = ALUMINIUM
    recorded = measured[name].mean
    parameters: Rows = []
    errors: Rows = []
    series: dict[str, Any] = {
        "time": measured[name].time.tolist(),
        "load": study.condition(name).protocol.sample_load.tolist(),
        "recorded": recorded.tolist(),
    }
    for grid, design in GRIDS.items():
        training = context.curves[design].where(role="training").succeeded()
        surrogate = PODRBF(**study.surrogate).fit(training.matrix(study.levels), training.depth)
        found = calibrate(
            {name: surrogate},
            measured,
            bounds,
            rng=np.random.default_rng(study.seed),
            settings=settings_of(study),
            surrogate_error={name: surrogate.loo_error_},
            confirm=lambda values: {name: solved(study, values, name)},
        )
        for key, entry in found.parameters.items():
            parameters.append(
                {
                    "snapshots": grid,
                    "parameter": key,
                    "truth": truth[key],
                    "estimate": entry.estimate,
                    "lower": entry.lower,
                    "upper": entry.upper,
                    "identified": entry.identified,
                    "holds_truth": entry.lower <= truth[key] <= entry.upper,
                }
            )
        for source, curve in (("surrogate", found.surrogate_curves[name]), ("finite elements", found.fe_curves[name])):
            errors.append(
                {
                    "snapshots": grid,
                    "curve": source,
                    "relative_percent": float(100 * relative(recorded, curve)),
                    "rmse_nm": float(np.sqrt(np.mean((curve - recorded) ** 2))),
                }
            )
        series[f"fe_{grid}"] = found.fe_curves[name].tolist()
    percent = {row["snapshots"]: row["relative_percent"] for row in errors if row["curve"] == "finite elements"}
    missed = sorted({row["parameter"] for row in parameters if not row["holds_truth"]})
    unknown = sorted({row["parameter"] for row in parameters if not row["identified"]})
    return Outcome(
        tables={"parameters": parameters, "errors at the estimate": errors},
        findings=[
            compare(
                "36 points serve as well as 64",
                "about 0.5 per cent difference in accuracy",
                f"error at the estimate {percent['64']:.2f} (64) and {percent['36']:.2f} per cent (36)",
                abs(percent["64"] - percent["36"]) < 0.5,
            ),
            Finding(
                "calibrated parameters",
                "not given",
                "; ".join(
                    f"{grid} points: "
                    + ", ".join(
                        f"{row['parameter']} {row['estimate']:.3g} "
                        f"({row['lower']:.3g} to {row['upper']:.3g}, truth {row['truth']:g})"
                        for row in parameters
                        if row["snapshots"] == grid
                    )
                    for grid in GRIDS
                ),
                "not in the thesis",
                "one sharp tip gives one loading coefficient and one unloading stiffness, so modulus and hardening end "
                f"on bounds; not identified: {', '.join(unknown) or 'none'}; intervals that miss the truth: "
                f"{', '.join(missed) or 'none'} (with others on their bounds they are too narrow, and the solver's "
                "error at the first loads, several per cent with plasticity, is larger than assumed)",
            ),
        ],
        series=series,
    )


def solved(study: Study, values: Mapping[str, float], name: str) -> np.ndarray:
    """Return the solver's depth [nm] at fine accuracy, or at standard accuracy where that fails.

    Raises
    ------
    PalpateError
        When both fail.
    """
    for accuracy in ("fine", "standard"):
        simulation = simulate(study.specification(values, study.condition(name), accuracy))
        if simulation.status == "ok":
            return simulation.depth
    raise PalpateError(f"{name} at {dict(values)}: {simulation.reason}")


STUDY = ThesisStudy(
    "aluminium", "Aluminium from end to end (chapter 4)", run, designs=tuple(GRIDS.values()), recordings=("aluminium",)
)
