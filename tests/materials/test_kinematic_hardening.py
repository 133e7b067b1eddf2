"""A back stress beside yielding, creep and Eyring flow: against the rate equations, in a cycle, and under a cone."""

import numpy as np
import pytest
from homogeneous import BURGERS_TERMS, HOOKE, check_yielding, error, integrated, updated
from under_a_cone import depths, specification

from palpate.errors import InputError
from palpate.materials import law_of
from palpate.materials.flow.point import commit, history, length, residual, solve, state_size
from palpate.materials.flow.row import SHEAR, step_weights

BACK = {"kinematic_modulus": 0.4}
YIELDING = {"yield_stress": 0.03, "hardening": 0.1}
EYRING = {"reference_rate": 1e-8, "eyring_stress": 0.004, "pressure_coefficient": 0.1}
SPECTRUM = {"spectrum_coefficient": 0.05, "spectrum_exponent": 0.2, "elements": 2, "longest_time": 10.0}


def eyring(q, pressure, alpha):
    sigma_e = max(np.sqrt(3.0) * q, 1e-12)
    return 1.5 / sigma_e * 1e-8 * np.sinh(sigma_e / 0.004) * np.exp(-0.1 * pressure / 0.004)


@pytest.mark.parametrize("joined", [False, True])
def test_yielding_keeps_to_the_rate_equations(joined):
    key, strength = "bilinear_plasticity+kinematic_hardening", lambda alpha: (0.03 + 0.1 * alpha, 0.1)
    check_yielding(key, YIELDING | BACK, strength, joined, back=2 / 3 * 0.4)


def test_creep_keeps_to_the_rate_equations():
    values = HOOKE | BACK | BURGERS_TERMS["values"]
    expected = integrated(HOOKE, 0.05, back=2 / 3 * 0.4, **BURGERS_TERMS["terms"])
    model = "kinematic_hardening+nonlinear_burgers"
    coarse, fine = (error(updated(model, values, steps, 0.05), expected) for steps in (100, 200))
    assert fine < 1e-4 and fine < 0.3 * coarse


def test_eyring_flow_beside_a_spectrum_keeps_to_the_rate_equations():
    """The spectrum feels the whole stress, the flow what the back stress leaves of it."""
    linear = [(time, 0.05 * time**0.2) for time in (0.1, 10.0)]
    expected = integrated(HOOKE, 0.05, 0.03, creep=eyring, back=2 / 3 * 0.4, linear=linear)
    model, values = "eyring+kinematic_hardening+retardation_spectrum", HOOKE | BACK | EYRING | SPECTRUM
    coarse, fine = (error(updated(model, values, steps, 0.05, 0.03), expected) for steps in (200, 400))
    assert fine < 2e-4 and fine < 0.35 * coarse


def test_a_cycle_of_shear_yields_again_after_twice_the_yield_stress():
    """Bauschinger's effect: with the back stress alone the elastic range keeps its size (Prager 1956)."""
    values = HOOKE | {"yield_stress": 0.03, "hardening": 0.0} | BACK
    law = law_of("bilinear_plasticity+kinematic_hardening").coefficients(values)
    weights, state, past, back = step_weights(law[None], 1.0)[0], np.zeros(state_size(law, 6)), np.empty(6), np.empty(6)
    shear, stress = np.concatenate([np.linspace(0.0, 0.1, 101), np.linspace(0.1, -0.1, 201)[1:]]), []
    for strain in shear:
        alpha = history(state, weights, law, past, back)
        trial = residual(np.array([0.0, 0.0, 0.0, strain, 0.0, 0.0]), past, weights)
        q, _, _ = solve(length(trial, 6), 0.0, alpha, 0.0, weights, law)
        commit(state, trial, back, alpha, q, 0.0, weights, law)
        stress.append(state[3])
    limit, stiff, slack = 0.03 / np.sqrt(3.0), 2.0 * law[SHEAR], 2.0 / 3.0 * 0.4
    tangent = stiff * slack / (stiff + slack)
    largest = limit + tangent * (0.1 - limit / stiff)
    again = 0.1 - 2.0 * limit / stiff
    assert stress[100] == pytest.approx(largest)
    assert stress[-1] == pytest.approx(largest - 2.0 * limit - tangent * (again + 0.1))


def test_under_a_cone_it_acts_late_in_unloading():
    flow = {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1}
    model = "eyring+kinematic_hardening"
    none, plain = (specification(model, flow | {"kinematic_modulus": c}) for c in (0.0, 0.3))
    without, zero, backed = depths(specification("eyring", flow))[0], *depths(none, plain)
    assert zero == pytest.approx(without, rel=1e-9)
    shallower = zero - backed
    assert np.all(shallower[1:] > 0.0) and shallower[-1] > 1.5 * shallower[5]


@pytest.mark.parametrize("model", ["kinematic_hardening", "kinematic_hardening+retardation_spectrum"])
def test_without_flow_it_is_refused(model):
    with pytest.raises(InputError, match="no flow that a back stress acts against") as caught:
        law_of(model)
    assert caught.value.place == "model" and "\n" not in str(caught.value)
