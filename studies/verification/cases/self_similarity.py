"""The exact scaling laws: pairs of simulations whose curves must be related."""

from __future__ import annotations

import numpy as np

from palpate.analytic import scaling
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth, worst
from studies.verification.reference_materials import ALUMINIUM, BURGERS, CONE, HOOKE

LOAD, STRESS, TIME = 2.7, 5.0, 3.0  # factors; no law knows them
ALLOWED_LOAD, ALLOWED = 1e-3, 1e-6  # relative; a mesh knows the load, but neither stress nor time
ALLOWED_WITHIN = {"standard": 0.005, "fine": 1e-3}  # the same from one accuracy's mesh to another


def run(settings: Settings) -> Outcome:
    """Compare whole curves, loading to the end of unloading, for creep and plasticity, small and large strains."""
    rows = []
    protocol = trapezoid(1.0, 30.0, 5.0, 30.0, points=60)
    cases = [("nonlinear_burgers", BURGERS, "small"), ("nonlinear_burgers", BURGERS, "large")]
    if not settings.quick:
        cases.append(("bilinear_plasticity", ALUMINIUM, "small"))
    for law, values, kinematics in cases:
        one = Specification(law, values, CONE, protocol, kinematics=kinematics)
        base = depth(one)[:-1]
        label = f"{law}, {kinematics} strain"
        other, ratio = scaling.load_scaled(one, LOAD)
        rows.append(
            worst(f"{label}: depth at {LOAD:g} times the load [nm]", ratio * base, depth(other)[:-1], ALLOWED_LOAD)
        )
        other = scaling.stress_scaled(one, STRESS)
        rows.append(worst(f"{label}: depth at {STRESS:g} times all stresses [nm]", base, depth(other)[:-1], ALLOWED))
        other = scaling.time_scaled(one, TIME)
        rows.append(worst(f"{label}: depth at {TIME:g} times the duration [nm]", base, depth(other)[:-1], ALLOWED))
    plots = [_within_one_curve(kinematics, rows) for kinematics in ("small", "large")]
    notes = [
        "Pairs: worst sample of the whole curve, less the last one, where the load is zero.",
        "The mesh follows the estimated contact radius, so both tests of a pair have similar meshes.",
        "Within one curve the contact grows through a mesh that stays: there the law tests the mesh too.",
    ]
    return Outcome(rows, plots, notes)


def _within_one_curve(kinematics: str, rows: list[Row]) -> Plot:
    """Append the row, and return the plot, of depth over the square root of the load along one elastic curve."""
    load = np.arange(1, 41) / 40
    protocol = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), load)
    series = []
    for accuracy, allowed in ALLOWED_WITHIN.items():
        ratio = depth(Specification("elastic", HOOKE, CONE, protocol, kinematics=kinematics, accuracy=accuracy))
        ratio = ratio / np.sqrt(load)
        quantity = f"elastic, {kinematics} strain, {accuracy}: depth / sqrt(load) along one curve [nm/mN^0.5]"
        rows.append(worst(quantity, np.full(len(load), ratio.mean()), ratio, allowed, "expected: its mean"))
        series.append(PlottedSeries(accuracy, load, ratio))
    return Plot(f"similarity_{kinematics}", "load [mN]", f"depth / sqrt(load), {kinematics} strain", series)


CASES = (Verification("similarity", "Exact scaling laws", run),)
