"""Voce hardening, alone and beside Burgers creep: against integration of the rate equations, and under a cone."""

import numpy as np
import pytest
from homogeneous import check_yielding
from under_a_cone import check_law

FLOW = {"yield_stress": 0.03, "saturation_stress": 0.07, "saturation_strain": 0.01}


def strength(alpha):
    return 0.07 - 0.04 * np.exp(-alpha / 0.01), 4.0 * np.exp(-alpha / 0.01)


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_gives_the_stress_of_the_rate_equations(joined):
    check_yielding("voce_plasticity", FLOW, strength, joined)


def test_under_a_cone():
    flow = {"yield_stress": 0.06, "saturation_stress": 0.12, "saturation_strain": 0.05}
    check_law("voce_plasticity", flow, {"saturation_stress": 0.1}, flow)
