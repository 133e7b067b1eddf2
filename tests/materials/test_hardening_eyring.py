"""Eyring flow that hardens: against integration of the rate equations, at a constant rate, and under a cone."""

import numpy as np
import pytest
from homogeneous import BURGERS_TERMS, HOOKE, error, integrated, updated
from scipy.special import lambertw
from under_a_cone import check_law

from palpate.errors import InputError
from palpate.materials import law_of
from palpate.materials.flow.point import solve
from palpate.materials.flow.row import SHEAR, step_weights
from palpate.materials.hardening_eyring import lambert

FLOW = {"reference_rate": 1e-8, "eyring_stress": 0.004, "pressure_coefficient": 0.1, "hardening": 0.2}


def creep(q, pressure, alpha):
    sigma_e = max(np.sqrt(3.0) * q, 1e-12)
    return 1.5 / sigma_e * 1e-8 * np.sinh(sigma_e / 0.004) * np.exp(-(0.1 * pressure + 0.2 * alpha) / 0.004)


@pytest.mark.parametrize("back", [0.0, 0.4])
def test_a_turning_strain_under_pressure_gives_the_stress_of_the_rate_equations(back):
    expected = integrated(HOOKE, 0.05, 0.03, creep=creep, back=2 / 3 * back)
    model, values = "hardening_eyring+kinematic_hardening", HOOKE | FLOW | {"kinematic_modulus": back}
    coarse, fine = (error(updated(model, values, steps, 0.05, 0.03), expected) for steps in (100, 200))
    assert fine < 1e-4 and fine < 0.35 * coarse


def test_beside_burgers_creep_it_hardens_with_its_own_strain():
    """Without back stress alpha would be the strain of both; the law counts its own."""
    values = HOOKE | FLOW | BURGERS_TERMS["values"]
    none = updated("hardening_eyring+nonlinear_burgers", values | {"hardening": 0.0}, 400, 0.05)
    plain = {name: value for name, value in values.items() if name != "hardening"}
    assert none == pytest.approx(updated("eyring+nonlinear_burgers", plain, 400, 0.05), rel=1e-8)


@pytest.mark.parametrize("hardening", [0.0, 1e-9, 0.2, 1e3])
@pytest.mark.parametrize("stress", [1e-5, 1e-3, 1.0])
def test_the_stress_at_the_end_of_a_step_is_that_of_its_own_rate(stress, hardening):
    """The closed form meets the rate at the strain that it leads to, however far from the elastic guess it lies."""
    law = law_of("hardening_eyring").coefficients(HOOKE | FLOW | {"eyring_stress": stress, "hardening": hardening})
    flows = 0
    for rho in (1e-9, 1e-3, 1.0):
        q, slope, push = solve(rho, 0.0, 0.01, 0.0, step_weights(law[None], 1.0)[0], law)
        assert np.isfinite([q, slope, push]).all()
        flown = rho - q / (2.0 * law[SHEAR])
        if flown > 1e-6 * rho:
            log_sinh = np.log(flown / (0.25 * np.sqrt(3.0) * 1e-8))
            log_sinh += hardening * (0.01 + 2.0 / np.sqrt(3.0) * flown) / stress
            z = np.arcsinh(np.exp(log_sinh)) if log_sinh < 300.0 else log_sinh + np.log(2.0)
            assert q == pytest.approx(stress / np.sqrt(3.0) * z, rel=1e-5)
            flows += 1
    assert flows or stress == 1.0 or hardening == 1e3


def test_lamberts_function_is_scipys():
    z = np.geomspace(1e-280, 1e80, 50)
    assert [lambert(np.log(x)) for x in z] == pytest.approx(lambertw(z).real, rel=1e-12)


def test_with_a_yield_stress_it_is_refused():
    with pytest.raises(InputError, match="hardens with its plastic strain") as caught:
        law_of("hardening_eyring+ludwik_plasticity")
    assert caught.value.place == "model" and "\n" not in str(caught.value)


def test_under_a_cone():
    flow = {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1, "hardening": 0.1}
    check_law("hardening_eyring", flow, {"hardening": 0.03}, flow | {"reference_rate": 1e-7})
