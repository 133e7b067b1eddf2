"""The radial equation against its own limits, an independent integrator, and finite differences."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from palpate.errors import InputError
from palpate.materials import LAWS
from palpate.materials.radial import commit, history, invariant, solve_radial, state_size, step_weights
from palpate.verification.materials import BURGERS

PLASTIC = {"youngs_modulus": 70.0, "poisson_ratio": 0.345, "yield_stress": 0.1, "hardening": 0.5}
LAW_CASES = [
    ("elastic", {"youngs_modulus": 3.0, "poisson_ratio": 0.3}),
    ("nonlinear_burgers", BURGERS),
    ("bilinear_plasticity", PLASTIC),
    ("burgers_plasticity", BURGERS | {"yield_stress": 0.1, "hardening": 0.5}),
    (
        "nonlinear_burgers",
        BURGERS | {"transient_coefficient_2": 0.1, "transient_exponent_2": 0.3, "retardation_time_2": 20.0},
    ),
]


def strain_path(coefficients, strains, dt):
    """Drive one material point through given strain deviators; return the stress deviators."""
    state = np.zeros(state_size(coefficients))
    weights = step_weights(coefficients, dt)
    past = np.empty(4)
    stresses = []
    for strain in strains:
        history(state, weights, coefficients, past)
        residual = strain - past
        rho = invariant(*residual)
        q, _ = solve_radial(rho, 0.0, state[8], weights, coefficients)
        commit(state, residual, q, rho, weights, coefficients)
        stresses.append(state[:4].copy())
    return np.array(stresses)


@pytest.mark.parametrize(("key", "values"), LAW_CASES)
def test_slope_is_the_derivative(key, values):
    coefficients = LAWS[key].coefficients(values)
    weights = step_weights(coefficients, 0.6)
    for rho in np.geomspace(1e-6, 0.3, 9):
        _, slope = solve_radial(rho, 0.0, 0.01, weights, coefficients)
        step = 1e-5 * rho
        up, down = (solve_radial(rho + s, 0.0, 0.01, weights, coefficients)[0] for s in (step, -step))
        assert slope == pytest.approx((up - down) / (2 * step), rel=1e-5)


@pytest.mark.parametrize("guess", [1e-12, 1e-3, 10.0])
def test_solution_does_not_depend_on_the_guess(guess):
    coefficients = LAWS["nonlinear_burgers"].coefficients(BURGERS)
    weights = step_weights(coefficients, 0.6)
    assert solve_radial(0.05, guess, 0.0, weights, coefficients)[0] == pytest.approx(
        solve_radial(0.05, 0.0, 0.0, weights, coefficients)[0], rel=1e-12
    )


def burgers_shear_rate(time, y, rate):
    """d(s, e_t)/dt of the Burgers solid in pure shear at a constant strain rate, straight from the law."""
    g = BURGERS["youngs_modulus"] / (2 * 1.34)
    s, transient = y
    q = abs(s)
    transient_rate = (
        BURGERS["transient_coefficient"] * q ** (2 * BURGERS["transient_exponent"]) * s - transient
    ) / BURGERS["retardation_time"]
    steady_rate = BURGERS["steady_coefficient"] * q ** (2 * BURGERS["steady_exponent"]) * s
    return [2 * g * (rate - steady_rate - transient_rate), transient_rate]


def test_burgers_converges_to_the_differential_equation_with_second_order():
    rate, duration = 0.004, 8.0
    exact = solve_ivp(burgers_shear_rate, (0, duration), [0.0, 0.0], args=(rate,), rtol=1e-10, atol=1e-14).y[0, -1]
    coefficients = LAWS["nonlinear_burgers"].coefficients(BURGERS)
    errors = []
    for steps in (80, 160, 320):
        ramp = rate * duration * np.arange(1, steps + 1) / steps
        strains = np.outer(ramp, [0.0, 0.0, 0.0, 1.0])
        errors.append(strain_path(coefficients, strains, duration / steps)[-1, 3] / exact - 1)
    orders = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert abs(errors[-1]) < 1e-4
    assert np.all(orders > 1.8)


def test_long_steps_stay_stable_and_end_in_full_retardation():
    values = BURGERS | {"steady_coefficient": 0.0}
    coefficients = LAWS["nonlinear_burgers"].coefficients(values)
    strain = np.array([0.0, 0.0, 0.0, 0.02])
    s = strain_path(coefficients, [strain] * 40, dt=100.0)[-1, 3]
    g = 3.28 / (2 * 1.34)
    assert s / (2 * g) + 0.24 * s ** (2 * 0.47 + 1) == pytest.approx(0.02, rel=1e-9)


def test_yielding_follows_the_hardening_line():
    coefficients = LAWS["bilinear_plasticity"].coefficients(PLASTIC)
    g = PLASTIC["youngs_modulus"] / (2 * 1.345)
    ramp = np.linspace(0.0, 0.01, 6)[1:]
    shear = strain_path(coefficients, np.outer(ramp, [0.0, 0.0, 0.0, 1.0]), 1.0)[:, 3]
    plastic_shear = ramp - shear / (2 * g)
    alpha = 2 / np.sqrt(3) * plastic_shear
    assert np.sqrt(3) * shear == pytest.approx(PLASTIC["yield_stress"] + PLASTIC["hardening"] * alpha, rel=1e-10)


@pytest.mark.parametrize(("key", "values"), LAW_CASES)
def test_stress_scaling_law(key, values):
    """Stresses times c with C_s by c^-(2 m_s + 1) and C_t by c^-(2 m_t + 1) leave the strains unchanged."""
    c = 7.3
    coefficients = LAWS[key].coefficients(values)
    scaled = coefficients.copy()
    scaled[[0, 1, 4, 5]] *= c
    scaled[2] *= c ** -(2 * scaled[3] + 1)
    for k in range(6, len(scaled), 3):
        scaled[k] *= c ** -(2 * scaled[k + 1] + 1)
    strains = np.outer(np.linspace(0.001, 0.05, 12), [0.6, 0.4, -1.0, 0.3])
    assert strain_path(scaled, strains, 0.5) == pytest.approx(c * strain_path(coefficients, strains, 0.5), rel=1e-9)


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"youngs_modulus": -1.0}, "youngs_modulus"),
        ({"poisson_ratio": 0.5}, "poisson_ratio"),
        ({"youngs_modulu": 3.0}, "youngs_modulu"),
        ({"steady_exponent": float("nan")}, "steady_exponent"),
        ({"steady_exponent": "0.2"}, "steady_exponent"),
    ],
)
def test_bad_parameters_are_refused_by_name(change, place):
    with pytest.raises(InputError) as caught:
        LAWS["nonlinear_burgers"].check(BURGERS | change)
    assert caught.value.place == place
    assert "\n" not in str(caught.value)
