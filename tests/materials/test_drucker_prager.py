"""Yielding that pressure impedes: against integration of the rate equations, and under a cone."""

import pytest
from homogeneous import check_yielding
from under_a_cone import check_law

FLOW = {"yield_stress": 0.05, "hardening": 0.2, "pressure_coefficient": 0.15}


def strength(alpha):
    return 0.05 + 0.2 * alpha, 0.2


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_gives_the_stress_of_the_rate_equations(joined):
    check_yielding("drucker_prager", FLOW, strength, joined, squeeze=0.03, pressed=0.15)


def test_under_a_cone():
    flow = {"yield_stress": 0.08, "hardening": 0.2, "pressure_coefficient": 0.15}
    check_law("drucker_prager", flow, {"pressure_coefficient": 0.0}, flow)
