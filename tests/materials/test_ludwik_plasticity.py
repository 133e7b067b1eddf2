"""Ludwik hardening, alone and beside Burgers creep: against integration of the rate equations, and under a cone."""

import pytest
from homogeneous import check_yielding
from under_a_cone import check_law

FLOW = {"yield_stress": 0.03, "strength": 0.1, "hardening_exponent": 0.3}


def strength(alpha):
    alpha = max(alpha, 1e-14)
    return 0.03 + 0.1 * alpha**0.3, 0.3 * 0.1 * alpha**-0.7


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_gives_the_stress_of_the_rate_equations(joined):
    check_yielding("ludwik_plasticity", FLOW, strength, joined)


def test_under_a_cone():
    flow = {"yield_stress": 0.06, "strength": 0.2, "hardening_exponent": 0.3}
    check_law("ludwik_plasticity", flow, {"strength": 0.1}, flow)
