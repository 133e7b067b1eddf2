"""The bilinear law against SciPy's integration of its rate equations, with and without hardening."""

import pytest
from homogeneous import check_yielding


@pytest.mark.parametrize("joined", [False, True])
@pytest.mark.parametrize("hardening", [0.3, 0.0])
def test_it_keeps_to_its_rate_equations(hardening, joined):
    flow = {"yield_stress": 0.05, "hardening": hardening}
    check_yielding("bilinear_plasticity", flow, lambda alpha: (0.05 + hardening * alpha, hardening), joined)
