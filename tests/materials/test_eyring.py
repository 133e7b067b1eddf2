"""Eyring flow, alone and beside Burgers creep: against integration of the rate equations, and under a cone."""

import numpy as np
import pytest
from homogeneous import BURGERS_TERMS, HOOKE, error, integrated, updated
from under_a_cone import check_law

from palpate.materials import LAWS
from palpate.materials.flow.point import solve
from palpate.materials.flow.row import SHEAR, step_weights

FLOW = {"reference_rate": 1e-8, "eyring_stress": 0.004, "pressure_coefficient": 0.1}


def creep(q, pressure, alpha):
    sigma_e = max(np.sqrt(3.0) * q, 1e-12)
    return 1.5 / sigma_e * 1e-8 * np.sinh(sigma_e / 0.004) * np.exp(-0.1 * pressure / 0.004)


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_under_pressure_gives_the_stress_of_the_rate_equations(joined):
    values, model, elements = HOOKE | FLOW, "eyring", ()
    both = creep
    if joined:
        values, model = values | BURGERS_TERMS["values"], "eyring+nonlinear_burgers"
        steady, elements = BURGERS_TERMS["terms"]["creep"], BURGERS_TERMS["terms"]["elements"]
        both = lambda *at: creep(*at) + steady(*at)  # noqa: E731
    expected = integrated(HOOKE, 0.05, 0.03, creep=both, elements=elements)
    coarse, fine = (error(updated(model, values, steps, 0.05, 0.03), expected) for steps in (100, 200))
    assert fine < 1e-4 and fine < 0.3 * coarse


@pytest.mark.parametrize("modulus", [1e-3, 3.0, 2000.0])
@pytest.mark.parametrize("stress", [1e-5, 1e-3, 1.0])
@pytest.mark.parametrize("pressure", [-5.0, 0.0, 5.0])
def test_no_stress_overflows(modulus, stress, pressure):
    """The radial equation holds at the solution however far the elastic guess lies beyond the sinh's range."""
    law = LAWS["eyring"].coefficients(FLOW | {"youngs_modulus": modulus, "poisson_ratio": 0.3, "eyring_stress": stress})
    for rho in (1e-9, 1e-3, 1.0):
        q, slope, push = solve(rho, 0.0, 0.0, pressure, step_weights(law[None], 1.0)[0], law)
        barrier = min(max(0.1 * pressure / stress, -100.0), 500.0)
        z = np.sqrt(3.0) * q / stress
        rate = np.sinh(z) * np.exp(-barrier) if z < 1.0 else 0.5 * np.exp(z - barrier) * (1.0 - np.exp(-2.0 * z))
        found = q / (2.0 * law[SHEAR]) + 0.5 * 0.5 * np.sqrt(3.0) * 1e-8 * rate
        assert np.isfinite([q, slope, push]).all()
        assert found == pytest.approx(rho, rel=1e-6)


def test_under_a_cone():
    flow = {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1}
    check_law("eyring", flow, {"pressure_coefficient": 0.05}, flow | {"reference_rate": 1e-7})
