"""Yielding that pressure impedes: against integration of the rate equations, and under a cone."""

import pytest
from homogeneous import BURGERS_TERMS, HOOKE, error, integrated, updated
from under_a_cone import check_law

FLOW = {"yield_stress": 0.05, "hardening": 0.2, "pressure_coefficient": 0.15}


def strength(alpha):
    return 0.05 + 0.2 * alpha, 0.2


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_gives_the_stress_of_the_rate_equations(joined):
    creep = BURGERS_TERMS if joined else {}
    values, model = HOOKE | FLOW | creep.get("values", {}), "drucker_prager" + "+nonlinear_burgers" * joined
    expected = integrated(HOOKE, 0.05, 0.03, strength=strength, pressed=0.15, **creep.get("terms", {}))
    coarse, fine = (error(updated(model, values, steps, 0.05, 0.03), expected) for steps in (100, 400))
    assert fine < 0.005 and fine < 0.5 * coarse


def test_under_a_cone():
    flow = {"yield_stress": 0.08, "hardening": 0.2, "pressure_coefficient": 0.15}
    check_law("drucker_prager", flow, {"pressure_coefficient": 0.0}, flow)
