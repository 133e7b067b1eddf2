"""Chapter 4 from end to end: surrogates of 64 and 36 points, calibration against recordings of known truth, errors.

The surrogate's leave-one-out errors join the covariance; the solver judges the estimate and does not correct it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from palpate.data.measures import relative
from palpate.data.study_recordings import observations
from palpate.inference.calibrate import calibrate
from palpate.inference.problem import Problem
from palpate.solver.simulation import simulate
from palpate.surrogate import PODRBF
from studies.thesis.fitted import Fitted, beside_truth
from studies.thesis.grids import ALUMINIUM, ranges
from studies.thesis.grids import ALUMINIUM_GRIDS as GRIDS
from studies.thesis.rules import at_most
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare
from studies.thesis.surrogate_forward import SurrogateForward


def run(context: Context) -> Outcome:
    """Calibrate with both grids."""
    study = context.studies["aluminium"]
    measured = observations(study, "virtual")
    truth = study.laboratory["virtual"].parameters
    bounds = ranges(study.levels)
    (name,) = ALUMINIUM
    recorded = measured[name].mean
    parameters: Rows = []
    errors: Rows = []
    fitted: list[Fitted] = []
    series: dict[str, Any] = {
        "time": measured[name].time.tolist(),
        "load": study.condition(name).protocol.sample_load.tolist(),
        "recorded": recorded.tolist(),
        "bounds": bounds,
    }
    for grid, design in GRIDS.items():
        training = context.curves[design].where(role="training").succeeded()
        snapshots = training.matrix(study.levels), training.depth
        surrogate = PODRBF(**dict(study.surrogate)).fit(*snapshots)
        on_surrogate = SurrogateForward({name: surrogate}, bounds)
        found = calibrate(
            replace(Problem.of(study, measured), forward=on_surrogate),
            on_surrogate.predictors,
            bounds,
            rng=np.random.default_rng(study.seed),
            settings=study.calibration,
        )
        simulated = simulate(study.specification(found.values, study.condition(name))).depth
        fitted += [
            Fitted.surrogate(f"aluminium, {grid} points", surrogate, *snapshots),
            Fitted.of_calibration(f"aluminium, {grid} points", found, study=study.name),
        ]
        parameters += [{"snapshots": grid, **row} for row in beside_truth(found, truth, found.parameters)]
        for source, curve in (("surrogate", found.surrogate_curves[name]), ("finite elements", simulated)):
            errors.append(
                {
                    "snapshots": grid,
                    "curve": source,
                    "relative_percent": float(100 * relative(recorded, curve)),
                    "rmse_nm": float(np.sqrt(np.mean((curve - recorded) ** 2))),
                }
            )
        series[f"fe_{grid}"] = simulated.tolist()
        series[f"surrogate_{grid}"] = found.surrogate_curves[name].tolist()
    return Outcome(
        tables={"parameters": parameters, "errors at the estimate": errors},
        findings=findings(parameters, errors),
        series=series,
        fitted=fitted,
    )


def findings(parameters: Rows, errors: Rows) -> list[Finding]:
    """Judge errors and parameters of both grids."""
    percent = {row["snapshots"]: row["relative_percent"] for row in errors if row["curve"] == "surrogate"}
    solver = {row["snapshots"]: row["relative_percent"] for row in errors if row["curve"] == "finite elements"}
    missed = sorted({row["parameter"] for row in parameters if not row["holds_truth"]})
    unknown = sorted({row["parameter"] for row in parameters if not row["identified"]})
    return [
        compare(
            "36 points serve as well as 64",
            "about 0.5 per cent difference in accuracy",
            f"error at the estimate {percent['64']:.2f} (64) and {percent['36']:.2f} per cent (36); "
            f"of the finite elements there {solver['64']:.2f} and {solver['36']:.2f}",
            at_most(abs(percent["64"] - percent["36"]), 1.0),
            "measured at mid-points in the radial kernels' study; here where the calibration ends",
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
            "one sharp tip gives one loading coefficient and one elastic recovery, two numbers for three parameters; "
            f"not identified: {', '.join(unknown) or 'none'}; intervals that miss the truth: "
            f"{', '.join(missed) or 'none'}",
        ),
    ]


STUDY = ThesisStudy(
    "aluminium", "Aluminium from end to end (chapter 4)", run, designs=tuple(GRIDS.values()), recordings=("aluminium",)
)
