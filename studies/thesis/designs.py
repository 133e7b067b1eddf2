"""Where to put the snapshots: the full factorial grid of chapter 5 against Sobol and Latin hypercube designs.

All three spread over the same ranges and are judged at the same points, which none of them saw.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from palpate.design.sampling import latin_hypercube, sobol
from palpate.surrogate import PODRBF
from studies.thesis.fitted import Fitted
from studies.thesis.grids import CALIBRATED, EPOXY_GRIDS, Outcomes, Studies, ranges
from studies.thesis.runs import Curves, Design, Run, study_runs
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy

CONDITION = CALIBRATED[0]
SIZES = (72, 144, 288)
SAMPLERS = {"sobol": sobol, "latin_hypercube": latin_hypercube}


def runs(sampler: str, size: int, studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return a space-filling design over the ranges of chapter 5's grid."""
    study = studies["epoxy"]
    bounds = {name: ends for name, ends in ranges(study.levels).items() if name in study.free_parameters}
    held = {name: levels[0] for name, levels in study.levels.items() if name not in bounds}
    points = [{**point, **held} for point in SAMPLERS[sampler](bounds, size, seed=study.seed + 2)]
    return study_runs(study, points, (CONDITION,))


DESIGNS = {
    "filling_sobol": Design(partial(runs, "sobol", max(SIZES))),
    **{f"filling_latin_hypercube_{size}": Design(partial(runs, "latin_hypercube", size)) for size in SIZES},
}


def run(context: Context) -> Outcome:
    """Fit a surrogate to every design and judge it at points that none saw."""
    study, curves = context.studies["epoxy"], context.curves
    tests = curves["groups_test"].where(condition=CONDITION).succeeded()
    sets = {("full factorial", 288): curves[EPOXY_GRIDS[CONDITION]]}
    sets |= {("Sobol", size): curves["filling_sobol"].take(range(size)) for size in SIZES}
    sets |= {("Latin hypercube", size): curves[f"filling_latin_hypercube_{size}"] for size in SIZES}
    rows: Rows = []
    fitted = []
    for (design, size), snapshots in sets.items():
        good = snapshots.succeeded()
        training = good.matrix(study.levels), good.depth
        model = PODRBF(**dict(study.surrogate)).fit(*training)
        rows.append({"design": design, "snapshots": size, **errors(model, tests, list(study.levels))})
        fitted.append(Fitted.surrogate(f"epoxy {CONDITION}, {design}, {size} points", model, *training))
    grid = rows[0]
    return Outcome(
        tables={f"error of the surrogate at {len(tests.labels)} unseen points, {CONDITION}": rows},
        findings=[
            Finding(
                "full factorial grid against space-filling designs",
                "full factorial, 288 points; no other tried",
                f"root mean square {grid['rmse_nm']:.2f} nm; "
                + ", ".join(f"{row['design']} {row['snapshots']}: {row['rmse_nm']:.2f}" for row in rows[1:])
                + " nm",
                "not in the thesis",
                "a grid of few levels tells no more of a parameter than its two to four levels do; a space-filling "
                "design has as many values of each parameter as points",
            )
        ],
        series={"rows": rows},
        fitted=fitted,
    )


def errors(model: PODRBF, tests: Curves, names: list[str]) -> dict[str, float]:
    """Return root mean square and largest error over all points of all test curves [nm]."""
    error = model.predict(tests.matrix(names)) - tests.depth
    return {"rmse_nm": float(np.sqrt(np.mean(error**2))), "largest_nm": float(np.abs(error).max())}


STUDY = ThesisStudy(
    "designs",
    "Full factorial, Sobol and Latin hypercube designs",
    run,
    designs=(EPOXY_GRIDS[CONDITION], "groups_test", *DESIGNS),
)
