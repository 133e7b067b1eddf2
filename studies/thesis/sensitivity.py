"""Chapter 5: the largest and the residual depth when one Burgers parameter goes from its lowest to its highest level.

The other parameters stay at their middle levels, which the thesis does not state.
"""

from __future__ import annotations

import numpy as np

from studies.thesis.grids import CALIBRATED, EPOXY_SCREENING, Outcomes, Studies
from studies.thesis.rules import Rule, at_most
from studies.thesis.runs import Design, Run, study_runs
from studies.thesis.study import Context, Outcome, Rows, ThesisStudy, compare

CENTRE = {name: levels[1] for name, levels in EPOXY_SCREENING.items()}
STEADY = ("steady_coefficient", "steady_exponent")


def runs(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return the centre and both ends of every parameter, at the four loading times."""
    points = [CENTRE]
    points += [{**CENTRE, name: value} for name, levels in EPOXY_SCREENING.items() for value in (levels[0], levels[2])]
    return study_runs(studies["epoxy"], points, CALIBRATED)


DESIGNS = {"sensitivity": Design(runs)}


def run(context: Context) -> Outcome:
    """Return the change over each parameter's range, per cent of the depth at the centre."""
    rows: Rows = []
    for condition in CALIBRATED:
        curves = context.curves["sensitivity"].where(condition=condition)
        points = curves.matrix(CENTRE)
        for name, levels in EPOXY_SCREENING.items():
            low, high, middle = (
                int(np.flatnonzero(np.all(points == list({**CENTRE, name: value}.values()), axis=1))[0])
                for value in (levels[0], levels[2], CENTRE[name])
            )
            rows.append(
                {
                    "condition": condition,
                    "parameter": name,
                    "max_depth_percent": _change(curves.max_depth, low, high, middle),
                    "residual_depth_percent": _change(curves.residual_depth, low, high, middle),
                }
            )
    size = {(row["condition"], row["parameter"]): row for row in rows}

    def absolute(condition: str, name: str, key: str) -> float:
        return abs(size[condition, name][key])

    largest = {
        key: [sorted(CENTRE, key=lambda n: -absolute(c, n, key))[:2] for c in CALIBRATED]
        for key in ("max_depth_percent", "residual_depth_percent")
    }
    more = all(
        absolute(c, n, "residual_depth_percent") > absolute(c, n, "max_depth_percent")
        for c in CALIBRATED
        for n in STEADY
    )
    modulus = {
        key: [absolute(c, "youngs_modulus", key) for c in CALIBRATED]
        for key in ("max_depth_percent", "residual_depth_percent")
    }
    retardation = max(absolute(c, "retardation_time", key) for c in CALIBRATED for key in largest)
    shown = ("transient_coefficient", "transient_exponent")
    transient = [absolute(CALIBRATED[0], n, "max_depth_percent") for n in shown]
    return Outcome(
        tables={"change over the range, per cent of the depth at the centre": rows},
        findings=[
            compare(
                "most influential on both depths",
                "C_s and m_s",
                " and ".join(largest["max_depth_percent"][0]),
                Rule(
                    "the two largest on both depths at every loading time",
                    all(set(pair) == set(STEADY) for pairs in largest.values() for pair in pairs),
                ),
                "over the ranges of the L27, from the middle of the others",
            ),
            compare(
                "stronger on the residual than on the largest depth",
                "yes",
                "yes" if more else "no",
                Rule("C_s and m_s, every loading time", more),
                "elastic strain, on which they do not act, is given back on unloading",
            ),
            compare(
                "E matters more in fast tests, on both depths",
                "yes",
                "largest depth "
                + ", ".join(f"{v:.2f}" for v in modulus["max_depth_percent"])
                + "; residual "
                + ", ".join(f"{v:.2f}" for v in modulus["residual_depth_percent"])
                + " per cent",
                Rule(
                    "each slower test less than the one before, on both depths",
                    all(bool(np.all(np.diff(values) < 0)) for values in modulus.values()),
                ),
                "the share of the elastic strain falls as creep goes on",
            ),
            compare(
                "t_eps",
                "little to no impact",
                f"at most {retardation:.2f} per cent",
                at_most(retardation, 0.5),
                "t_eps is a hundredth of the loading time or less",
            ),
            compare(
                "m_t shows, C_t hardly",
                "m_t good sensitivity, C_t fairly insignificant",
                f"largest depth, 30 s: C_t {transient[0]:.2f}, m_t {transient[1]:.2f} per cent",
                Rule("m_t at least half as much again as C_t", transient[1] > 1.5 * transient[0]),
                "both act through C_t q^(2 m_t + 1) alone, at one pressure: they cannot be told apart by one tip",
            ),
        ],
        series={"rows": rows},
    )


def _change(depth: np.ndarray, low: int, high: int, middle: int) -> float:
    return float(100 * (depth[high] - depth[low]) / depth[middle])


STUDY = ThesisStudy(
    "sensitivity", "Sensitivity of both depths, one parameter at a time (chapter 5)", run, designs=("sensitivity",)
)
