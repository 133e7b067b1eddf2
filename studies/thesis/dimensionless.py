r"""One surrogate over dimensionless groups serves every loading time and every largest load.

A sharp cone has no length and the law has the scaling symmetries of stress and of time, so for triangular tests

    h(t) = sqrt(P / E) F(t/T; C_s E^(2 m_s + 1) T, m_s, C_t E^(2 m_t + 1), m_t, t_eps / T).

Eight arguments become five. The groups are expressed as the equivalent parameters at a reference modulus and loading
time (3.25 GPa, 30 s), which keeps their ranges small; the first, the third and the last enter as logarithms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from palpate.design.sampling import sobol
from palpate.surrogate import PODRBF
from studies.thesis.fitted import Fitted
from studies.thesis.grids import CALIBRATED, EPOXY_GRIDS, EPOXY_SCREENING, Outcomes, Studies, ranges
from studies.thesis.runs import Curves, Design, Run, study_runs
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy
from studies.thesis.surrogates import epoxy_surrogates

MODULUS, DURATION = 3.25, 30.0
SIZES = (32, 64, 96, 128, 192, 256, 384)
TESTS = 16
TIMES = (30.0, 240.0)  # s, the fastest and the slowest loading
NAMES = tuple(EPOXY_SCREENING)
LOADS = ("P0.50_T030", "P0.75_T045")


def groups(parameters: np.ndarray, duration: np.ndarray) -> np.ndarray:
    """Return the groups (n, 5) of parameters (n, 6), in the order of `NAMES`, and loading times (n,) [s]."""
    modulus, steady, m_s, transient, m_t, retardation = parameters.T
    ratio = modulus / MODULUS
    return np.column_stack(
        [
            np.log(steady * ratio ** (2 * m_s + 1) * duration / DURATION),
            m_s,
            np.log(transient * ratio ** (2 * m_t + 1)),
            m_t,
            np.log(retardation * DURATION / duration),
        ]
    )


def box() -> dict[str, tuple[float, float]]:
    """Return the range of each group over the parameters' ranges and the loading times."""
    corners = np.array(np.meshgrid(*ranges(EPOXY_SCREENING).values(), TIMES, indexing="ij")).reshape(7, -1)
    values = groups(corners[:6].T, corners[6])
    low, high = values.min(axis=0), values.max(axis=0)
    names = ("log_steady", "steady_exponent", "log_transient", "transient_exponent", "log_retardation")
    return {name: (float(a), float(b)) for name, a, b in zip(names, low, high, strict=True)}


def training_runs(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return a Sobol design over the groups, simulated at the reference modulus and loading time."""
    points = [
        {
            "youngs_modulus": MODULUS,
            "steady_coefficient": float(np.exp(point["log_steady"])),
            "steady_exponent": point["steady_exponent"],
            "transient_coefficient": float(np.exp(point["log_transient"])),
            "transient_exponent": point["transient_exponent"],
            "retardation_time": float(np.exp(point["log_retardation"])),
        }
        for point in sobol(box(), max(SIZES), seed=studies["epoxy"].seed)
    ]
    return study_runs(studies["epoxy"], points, ("P1.00_T030",))


def judging_runs(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return points that no surrogate saw, at all loading times and two other largest loads; t_eps is 0.25 s."""
    bounds = ranges(EPOXY_SCREENING)
    del bounds["retardation_time"]
    points = [{**point, "retardation_time": 0.25} for point in sobol(bounds, TESTS, seed=studies["epoxy"].seed + 1)]
    return study_runs(studies["epoxy"], points, (*CALIBRATED, *LOADS))


DESIGNS = {"groups_training": Design(training_runs), "groups_test": Design(judging_runs)}


def fit(training: Curves) -> PODRBF:
    """Fit the logarithm of the depth over the groups."""
    return PODRBF(shape="loo", energy=1 - 1e-11).fit(*inputs(training))


def inputs(training: Curves) -> tuple[np.ndarray, np.ndarray]:
    """Return the groups (n, 5) and the logarithm of the depth (n, points) of the curves that did not fail."""
    good = training.succeeded()
    return groups(good.matrix(NAMES), np.full(len(good.labels), DURATION)), np.log(good.depth)


def predict(model: PODRBF, parameters: np.ndarray, duration: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return depths (n, points) [nm] for parameters (n, 6), loading times (n,) [s] and largest loads (n,) [mN]."""
    factor = np.sqrt(load * MODULUS / parameters[:, 0])
    return factor[:, None] * np.exp(model.predict(groups(parameters, duration)))


def run(context: Context) -> Outcome:
    """Compare one surrogate of growing size with four separate ones of 288 points, at the same test points."""
    training, tests = context.curves["groups_training"], context.curves["groups_test"]
    curve = []
    for size in SIZES:
        model = fit(training.take(range(size)))
        curve.append({"snapshots": size, **errors(tests, lambda part: predict(model, *conditions_of(part)))})  # noqa: B023
    separate = separate_errors(context)
    as_good = [row["snapshots"] for row in curve if all(row[key] <= separate[key] for key in separate)]
    needed = min(as_good, default=None)
    whole = fit(training)
    other = loads_table(whole, tests)
    last = curve[-1]
    return Outcome(
        tables={
            "one surrogate over the groups, all four loading times": curve,
            "four surrogates of 288 points each": [{"snapshots": 1152, **separate}],
            "other largest loads, none simulated for training": other,
        },
        findings=[
            Finding(
                "one surrogate in place of four",
                "4 x 288 = 1152 snapshots",
                (f"{needed} snapshots have" if needed else f"{max(SIZES)} snapshots do not have")
                + f" no larger errors than the four (root mean square {separate['rmse_nm']:.2f}, largest "
                f"{separate['largest_nm']:.1f} nm); {last['snapshots']} have {last['rmse_nm']:.2f} and "
                f"{last['largest_nm']:.1f} nm",
                "not in the thesis",
                f"saves {100 * (1 - needed / 1152):.0f} per cent of the snapshots, and frees t_eps" if needed else "",
            ),
            Finding(
                "other largest loads",
                "a validation of their own",
                "; ".join(f"{row['condition']}: {row['rmse_nm']:.2f} nm" for row in other),
                "not in the thesis",
                "sqrt(P) is exact for a sharp cone: such a validation tests tip and instrument, not the law",
            ),
        ],
        series={"curve": curve, "separate": separate},
        fitted=[
            Fitted.surrogate(
                "epoxy, all loading times, over groups (logarithm of the depth)", whole, *inputs(training)
            ),
            *(Fitted.row(f"epoxy, over groups, {row['snapshots']} points", "surrogate", row) for row in curve),
        ],
    )


def conditions_of(part: Curves) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return parameters (n, 6), loading times (n,) and largest loads (n,) of curves."""
    return part.matrix(NAMES), part.time[:, -1] / 2, part.load.max(axis=1)


def errors(
    tests: Curves, predicted: Callable[[Curves], np.ndarray], conditions: Sequence[str] = CALIBRATED
) -> dict[str, float]:
    """Return the root mean square and the largest error under some conditions [nm], and per cent of the depth."""
    parts = [tests.where(condition=name).succeeded() for name in conditions]
    error = np.concatenate([predicted(part) - part.depth for part in parts])
    share = np.concatenate([(predicted(part) - part.depth) / part.max_depth[:, None] for part in parts])
    return {
        "rmse_nm": float(np.sqrt(np.mean(error**2))),
        "largest_nm": float(np.abs(error).max()),
        "percent": float(100 * np.sqrt(np.mean(share**2))),
    }


def separate_errors(context: Context) -> dict[str, float]:
    """Return the same errors of the four surrogates over the parameters themselves."""
    study, tests = context.studies["epoxy"], context.curves["groups_test"]
    models = epoxy_surrogates(context)

    def predicted(part: Curves) -> np.ndarray:
        return models[part.labels[0]["condition"]].predict(part.matrix(study.levels))

    return errors(tests, predicted)


def loads_table(model: PODRBF, tests: Curves) -> Rows:
    """Return errors at largest loads that the training never saw."""
    rows: Rows = []
    for name in LOADS:
        found = errors(tests, lambda part: predict(model, *conditions_of(part)), (name,))
        rows.append({"condition": name, "rmse_nm": found["rmse_nm"], "percent": found["percent"]})
    return rows


STUDY = ThesisStudy(
    "dimensionless",
    "One dimensionless surrogate in place of four",
    run,
    designs=("groups_training", "groups_test", *EPOXY_GRIDS.values()),
)
