"""Chapter 5: friction between tip and sample, over loading times and largest loads.

Both kinematics are asked for. What the solver does not offer is reported as not run, with the solver's own words.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from palpate.study.specification import Specification
from studies.thesis.grids import CALIBRATED, Outcomes, Studies
from studies.thesis.rules import about, at_most, falling, rising
from studies.thesis.runs import Curves, Design, Run
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare

COEFFICIENTS = (0.0, 0.125, 0.25, 0.5)
LOADS = ("P0.50_T030", "P0.75_T030", "P1.00_T030")
KINEMATICS = ("small", "large")
LABELS = ("kinematics", "condition", "loading_time", "max_load", "friction")
WHY = {
    "small": "small strains leave out that the surface turns as the tip sinks in, and so overstate what friction holds "
    "back; CalculiX gives as much (1.7 per cent of the largest depth at f = 0.25). The thesis' figures need large "
    "strains",
    "large": "differences of a few tenths of a per cent are of the order of the mesh error of either solver",
}
TREND = "slow tests creep more: friction matters more while the contact grows, less for what is left after unloading"
CURVES = (len(COEFFICIENTS) - 1) * len({*CALIBRATED, *LOADS})


def runs(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return the calibrated epoxy at every coefficient, loading time and largest load."""
    study = studies["epoxy"]
    found = []
    for kinematics in KINEMATICS:
        for name in dict.fromkeys((*CALIBRATED, *LOADS)):
            condition = study.condition(name)
            for coefficient in COEFFICIENTS:
                labels = {
                    "condition": name,
                    "kinematics": kinematics,
                    "friction": coefficient,
                    "max_load": condition.protocol.max_load,
                    "loading_time": float(condition.protocol.sample_time[-1] / 2),
                }
                found.append(Run.of(labels, partial(build, studies, labels)))
    return found


def build(studies: Studies, labels: Mapping[str, Any]) -> Specification:
    """Return the calibrated epoxy with the friction and the kinematics that the labels say."""
    study = studies["epoxy"]
    plain = study.specification(study.laboratory["virtual"].parameters, study.condition(labels["condition"]))
    indenter = replace(study.indenter, friction=labels["friction"])
    return replace(plain, kinematics=labels["kinematics"], indenter=indenter)


DESIGNS = {"friction": Design(runs)}


def run(context: Context) -> Outcome:
    """Compare each curve with the frictionless one."""
    curves = context.curves["friction"]
    rows = [row for kinematics in KINEMATICS for row in reductions(curves.where(kinematics=kinematics))]
    done = [row for row in rows if row["friction"] > 0 and row["max_depth_reduction_percent"] is not None]
    missing = sorted({reason for reason in curves.reasons if reason})
    tables: dict[str, Rows] = {"reduction of depth by friction": rows}
    findings: list[Finding] = []
    for kinematics in KINEMATICS:
        own = [row for row in done if row["kinematics"] == kinematics]
        if len(own) == CURVES:
            findings += judge(own, kinematics)
        else:
            findings.append(
                Finding(
                    f"friction, {kinematics} strains",
                    "0.5 per cent at the largest, 1 to 1.8 per cent of the residual depth",
                    f"{len(own)} of {CURVES} curves",
                    "not run",
                    missing[0] if missing else "the frictionless curve failed",
                )
            )
    return Outcome(tables, findings, {"rows": rows})


def reductions(curves: Curves) -> Rows:
    """Return, for each curve, by how much friction makes it shallower at the largest load and after unloading."""
    rows: Rows = []
    peak, residual = curves.max_depth, curves.residual_depth
    for k, labels in enumerate(curves.labels):
        plain = next(
            j
            for j, other in enumerate(curves.labels)
            if other["condition"] == labels["condition"] and other["friction"] == 0
        )
        row: dict[str, Any] = {key: labels[key] for key in LABELS}
        for name, depth in (("max_depth", peak), ("residual_depth", residual)):
            lost = 100 * (1 - depth[k] / depth[plain])
            row |= {f"{name}_nm": _number(depth[k]), f"{name}_reduction_percent": _number(lost)}
        rows.append(row)
    return rows


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def judge(rows: Rows, kinematics: str) -> list[Finding]:
    """Compare reductions with the thesis' numbers and patterns."""

    def pick(name: str, **wanted: Any) -> list[float]:
        return [row[name] for row in rows if all(row[key] == value for key, value in wanted.items())]

    peak, residual = "max_depth_reduction_percent", "residual_depth_reduction_percent"
    largest, left = max(pick(peak, friction=0.5)), max(pick(residual, friction=0.5))
    times = [pick(peak, friction=0.5, condition=name)[0] for name in CALIBRATED]
    after = [pick(residual, friction=0.5, condition=name)[0] for name in CALIBRATED]
    loads = [pick(peak, friction=0.5, condition=name)[0] for name in LOADS]
    label = f", {kinematics} strains"
    return [
        compare(
            f"largest reduction of the largest depth, f = 0.5{label}",
            "about 0.5 per cent",
            f"{largest:.4f} per cent",
            about(largest, 0.5),
            WHY[kinematics],
        ),
        compare(
            f"largest reduction of the residual depth, f = 0.5{label}",
            "1 to 1.8 per cent",
            f"{left:.2f} per cent",
            about(left, 1, 1.8),
            WHY[kinematics],
        ),
        compare(
            f"reduction of the largest depth grows with loading time{label}",
            "yes",
            _list(times),
            rising(times),
            TREND,
        ),
        compare(
            f"reduction of the residual depth falls with loading time{label}",
            "yes",
            _list(after),
            falling(after),
            TREND,
        ),
        compare(
            f"no dependence on the largest load{label}",
            "hardly any",
            _list(loads),
            at_most(float(np.ptp(loads)), 0.05),
            "a sharp cone has no length: exact",
        ),
    ]


def _list(values: list[float]) -> str:
    return ", ".join(f"{value:.2f}" for value in values) + " per cent"


STUDY = ThesisStudy("friction", "Friction (chapter 5)", run, designs=("friction",))
