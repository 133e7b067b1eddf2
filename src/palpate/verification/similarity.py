"""The exact scaling laws: pairs of simulations whose curves must be related."""

from __future__ import annotations

from palpate.analytic import scaling
from palpate.protocol import trapezoid
from palpate.specification import Specification
from palpate.verification.case import Case, Outcome, Settings, depth, worst
from palpate.verification.materials import ALUMINIUM, BURGERS, CONE

LOAD, STRESS, TIME = 2.7, 5.0, 3.0
ALLOWED_LOAD, ALLOWED = 1e-3, 1e-6


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
    return Outcome(rows, notes=["Worst sample of the whole curve, less the last one, where the load is zero."])


CASE = Case("similarity", "Exact scaling laws", run)
