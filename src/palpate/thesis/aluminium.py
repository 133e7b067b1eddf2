"""Chapter 4 from end to end: surrogates of 64 and 36 points, calibration against recordings of known truth, errors.

Simulations with plasticity scatter by 1 per cent from mesh to mesh, because the contact grows from node to node.
Differences of the solver over small steps are then noise, so the solver judges the estimate and does not correct it;
and the scatter of the recording's own mesh joins the surrogate's leave-one-out errors in the covariance.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.calibration import calibrate
from palpate.calibration.measures import relative
from palpate.fem.discretisation import RESOLUTIONS
from palpate.laboratory import exact_curve
from palpate.observations import observations
from palpate.steps import settings_of
from palpate.surrogate import PODRBF
from palpate.thesis.fitted import Fitted
from palpate.thesis.grids import ALUMINIUM
from palpate.thesis.rules import at_most
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
        surrogate = PODRBF(**study.surrogate).fit(*snapshots)
        found = calibrate(
            {name: surrogate},
            measured,
            bounds,
            rng=np.random.default_rng(study.seed),
            settings=settings_of(study),
            surrogate_error={name: error_curves(surrogate, recorded, RESOLUTIONS[study.accuracy].growth)},
        )
        simulated = exact_curve(study.specification(found.values, study.condition(name)), name).depth
        fitted += [
            Fitted.surrogate(f"aluminium, {grid} points", surrogate, *snapshots),
            Fitted.of_calibration(f"aluminium, {grid} points", found, study=study.name),
        ]
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
                    "at_bound": entry.at_bound,
                    "holds_truth": entry.lower <= truth[key] <= entry.upper,
                }
            )
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


def error_curves(surrogate: PODRBF, recorded: np.ndarray, growth: float) -> np.ndarray:
    """Return curves (k, points) [nm] whose mean outer product is the covariance of surrogate and mesh.

    To the leave-one-out errors comes a scatter of the same size whose correlation falls by e when the contact has grown
    by one ring of nodes, and which stays as it is once the contact no longer grows: on unloading.

    Parameters
    ----------
    growth
        Ratio of the radii of neighbouring rings of nodes.
    """
    size = np.log(np.maximum.accumulate(recorded)) / np.log(growth)
    scatter = np.outer(surrogate.loo_rms_, surrogate.loo_rms_) * np.exp(-np.abs(size[:, None] - size))
    values, vectors = np.linalg.eigh(scatter)
    parts = surrogate.loo_error_, np.sqrt(len(size) * np.maximum(values, 0.0))[:, None] * vectors.T
    total = sum(map(len, parts))
    return np.vstack([np.sqrt(total / len(part)) * part for part in parts])


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
