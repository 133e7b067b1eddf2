"""Every law, at a point and in SIMD lanes: derivatives, guesses, scaling, joining, and what is refused."""

import numpy as np
import pytest
from homogeneous import error, updated
from law_examples import ALONE, BACKED, HOOKE, values
from numba import njit
from scipy.optimize import brentq

from palpate.analytic.scaling import with_stresses_scaled
from palpate.errors import InputError
from palpate.materials import LAWS, law_of
from palpate.materials.first_guess import Glimpse
from palpate.materials.flow.point import solve
from palpate.materials.flow.radial import NOTHING, TOLERANCE, compliance, solve_radial, threshold
from palpate.materials.flow.row import SHARE, SHEAR, SPLIT, STIFFENING, in_series, step_weights
from palpate.solver.axisymmetric.lanes import LANES, load, splat, store

JOINED = [f"{key}+nonlinear_burgers" for key in LAWS if "burgers" not in key and key != "elastic"]
MODELS = [*ALONE, *JOINED, *BACKED, "eyring+retardation_spectrum+voce_plasticity"]
PRESSED = [model for model in MODELS if "eyring" in model or "drucker" in model]


def row_and_weights(model, dt=0.6, resistance=1.0):
    row = law_of(model).coefficients(values(model))
    return row, step_weights(row[None], dt, resistance)[0]


@njit
def in_lanes(rho, alpha, pressure, law, step, out):
    for i in range(len(rho)):
        start = splat(NOTHING), splat(-1000.0), splat(0.0)
        q, _, order, push = solve_radial(load(rho, i), *start, splat(alpha), splat(pressure), law, step)
        store(out, 3 * i, q)
        store(out, 3 * i + 1, order * q / load(rho, i))
        store(out, 3 * i + 2, push)


@pytest.mark.parametrize("key", LAWS)
def test_every_law_has_an_example_and_guesses_of_what_it_requires(key):
    law = LAWS[key]
    assert law.check(HOOKE | law.example).keys() == {p.name for p in law.declared({})}
    required = {p.name for p in law.flow if p.default is None}
    for soft in (False, True):
        guessed = law.guess(Glimpse(3.0, 0.2, 20.0, soft))
        assert required <= guessed.keys()
        for name, (guess, why) in guessed.items():
            assert guess == tuple(sorted(guess)) and why, name


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("model", MODELS)
def test_a_step_of_no_length_is_the_limit_of_short_ones(model):
    _, none = row_and_weights(model, 0.0)
    for dt in (1e-6, 1e-8):
        np.testing.assert_allclose(none, row_and_weights(model, dt)[1], rtol=1e3 * dt, atol=1e3 * dt)


@pytest.mark.parametrize("model", MODELS)
def test_slopes_are_the_derivatives(model):
    row, weights = row_and_weights(model)
    for rho in np.geomspace(1e-6, 0.3, 9):
        q, slope, push = solve(rho, 0.0, 0.01, 0.02, weights, row)
        step = 1e-5 * rho
        up, down = (solve(rho + s, q, 0.01, 0.02, weights, row)[0] for s in (step, -step))
        assert slope == pytest.approx((up - down) / (2 * step), rel=2e-4, abs=1e-8)
        up, down = (solve(rho, q, 0.01, 0.02 + s, weights, row)[0] for s in (1e-6, -1e-6))
        assert push == pytest.approx((up - down) / 2e-6, rel=2e-4, abs=1e-7)
        assert (push != 0.0) == (model in PRESSED) or push == 0.0


@pytest.mark.parametrize("guess", [1e-60, 1e-19, 1e-12, 1e-3, 10.0])
@pytest.mark.parametrize("model", MODELS)
def test_solution_does_not_depend_on_the_guess(model, guess):
    row, weights = row_and_weights(model)
    found, expected = (solve(0.05, start, 0.0, 0.02, weights, row)[0] for start in (guess, 0.0))
    assert found == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("exponent", [0.05, 0.1, 0.3, 1.0])
def test_a_yield_stress_is_found_where_creep_grows_exponentially_with_it(exponent):
    """By bisection over plastic strains down to e^-500, of which a small exponent makes a stress that counts."""
    law = HOOKE | LAWS["eyring"].example | {"eyring_stress": 0.005, "pressure_coefficient": 0.0}
    law |= {"yield_stress": 0.02, "strength": 1.0, "hardening_exponent": exponent}
    row = law_of("eyring+ludwik_plasticity").coefficients(law)
    weights = step_weights(row[None], 1.0)[0]

    def strain(log_slip):
        q = threshold.py_func(np.exp(log_slip), 0.0, row, weights)[0]
        return compliance.py_func(q, np.log(q), 0.0, 0.0, row, weights)[0] * q + 0.5 * np.sqrt(3.0) * np.exp(log_slip)

    for rho in (0.01, 0.05, 0.2, 1.0):
        log_slip = brentq(lambda y, rho=rho: strain(y) / rho - 1.0, -500.0, np.log(2.0 * rho))
        found, _, _ = solve(rho, 0.0, 0.0, 0.0, weights, row)
        assert found == pytest.approx(threshold.py_func(np.exp(log_slip), 0.0, row, weights)[0], rel=1e-6)


@pytest.mark.parametrize("model", MODELS)
def test_lanes_have_the_solution_of_single_points(model):
    rng = np.random.default_rng(1)
    row, _ = row_and_weights(model)
    rows, resistance = np.repeat(row[None, :, None], LANES, axis=2), rng.uniform(1.0, 2.0, LANES)
    rows[:, SHEAR] *= rng.uniform(0.3, 3.0, LANES)
    rows[:, SHARE] = rng.uniform(0.0, 1.0, LANES)
    rows[:, SHARE, :2] = 0.0, 1.0
    weights, rho = step_weights(rows, 0.7, resistance), 10.0 ** rng.uniform(-9, 0, (50, LANES))
    out = np.empty((50, 3, LANES))
    in_lanes(rho, 0.02, 0.03, rows[0], weights[0], out)
    for i, lane in np.ndindex(rho.shape):
        own = np.ascontiguousarray(weights[0, :, lane]), np.ascontiguousarray(rows[0, :, lane])
        q, slope, push = solve(rho[i, lane], 0.0, 0.02, 0.03, *own)
        assert out[i, 0, lane] == pytest.approx(q, rel=1e-10)
        assert out[i, 1, lane] == pytest.approx(slope, rel=100 * TOLERANCE)
        assert out[i, 2, lane] == pytest.approx(push, rel=100 * TOLERANCE, abs=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_scaling_all_stresses_leaves_the_strains_unchanged(model):
    c, given = 7.3, values(model)
    scaled = with_stresses_scaled(model, given, c)
    expected = updated(model, given, 20, 0.05, 0.03)
    assert error(updated(model, scaled, 20, 0.05, 0.03) / c, expected) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_resistance_scales_the_stress_that_flow_needs(model):
    """Moduli and stresses r times as high are the same material with moduli as they were, and a resistance of r."""
    r, given = 1.7, values(model)
    scaled = {name: value / r if name == "youngs_modulus" else value for name, value in given.items()}
    resisting, plain = updated(model, given, 20, 0.05, 0.03, resistance=r), updated(model, scaled, 20, 0.05, 0.03)
    assert error(resisting / r, plain) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_film_and_substrate_in_series_strain_as_their_shares_say(model):
    """Under one stress the strain is the mean of the film's and the substrate's, elastic and flowing strains alike."""
    film, weights = row_and_weights(model)
    substrate = film.copy()
    substrate[[0, 1]] *= 5.0
    substrate[SHARE] = 0.0
    for share in (0.0, 0.3, 1.0):
        row = in_series(film, substrate, np.array([share]))
        for rho in (0.002, 0.05):
            own = step_weights(row, 0.6)[0]
            q, _, _ = solve(weights[SPLIT] * rho, 0.0, 0.0, 0.02, weights, film)
            stress = weights[SPLIT] * (q + weights[STIFFENING] * rho)
            mixed = share * rho + (1.0 - share) * stress / (2.0 * substrate[SHEAR])
            found, _, _ = solve(own[SPLIT] * mixed, 0.0, 0.0, 0.02, own, row[0])
            assert own[SPLIT] * (found + own[STIFFENING] * mixed) == pytest.approx(stress, rel=1e-9)


def test_joined_laws_are_known_by_one_name_in_any_order():
    assert law_of("nonlinear_burgers+bilinear_plasticity").key == "burgers_plasticity"
    assert law_of("ludwik_plasticity + nonlinear_burgers").key == law_of("nonlinear_burgers+ludwik_plasticity").key
    assert law_of("eyring+burgers_plasticity").parts == ("bilinear_plasticity", "eyring", "nonlinear_burgers")
    assert law_of("elastic+eyring").key == "eyring"


def test_joined_strains_add():
    """Two laws under one stress: the strain that solves for q is the sum, less Hooke's part counted twice."""
    both, apart = "eyring+retardation_spectrum", ("eyring", "retardation_spectrum")
    q, elastic = 0.03, 0.03 / (2.0 * law_of(both).coefficients(values(both))[SHEAR])
    strains = []
    for model in (both, *apart):
        row, weights = row_and_weights(model)
        low, high = 1e-6, 10.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if solve(middle, 0.0, 0.0, 0.0, weights, row)[0] < q else (low, middle)
        strains.append(low)
    assert strains[0] + elastic == pytest.approx(strains[1] + strains[2], rel=1e-9)


@pytest.mark.parametrize(
    ("model", "word"),
    [
        ("ludwik_plasticity+voce_plasticity", "yield_stress"),
        ("eyring+drucker_prager", "pressure_coefficient"),
        ("eyring+eyring", "twice"),
        ("eyring+hardening_eyring", "reference_rate"),
        ("burgers_plasticity+nonlinear_burgers", "twice"),
        ("eyring+rubber", "'rubber' is not known"),
        ("", "is not known"),
        (7, "is not known"),
    ],
)
def test_laws_that_do_not_join_are_refused_in_one_line(model, word):
    with pytest.raises(InputError, match=word) as caught:
        law_of(model)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("key", "change", "place"),
    [
        ("nonlinear_burgers", {"youngs_modulus": -1.0}, "youngs_modulus"),
        ("nonlinear_burgers", {"poisson_ratio": 0.5}, "poisson_ratio"),
        ("nonlinear_burgers", {"youngs_modulu": 3.0}, "youngs_modulu"),
        ("nonlinear_burgers", {"steady_exponent": float("nan")}, "steady_exponent"),
        ("nonlinear_burgers", {"steady_exponent": "0.2"}, "steady_exponent"),
        ("ludwik_plasticity", {"hardening_exponent": 1.5}, "hardening_exponent"),
        ("voce_plasticity", {"saturation_stress": 0.02}, "saturation_stress"),
        ("eyring", {"eyring_stress": 0.0}, "eyring_stress"),
        ("drucker_prager", {"pressure_coefficient": -0.1}, "pressure_coefficient"),
        ("retardation_spectrum", {"elements": 2.5}, "elements"),
        ("retardation_spectrum", {"longest_time": 0.01}, "longest_time"),
    ],
)
def test_bad_parameters_are_refused_by_name(key, change, place):
    with pytest.raises(InputError) as caught:
        LAWS[key].coefficients(values(key) | change)
    assert caught.value.place == place
    assert "\n" not in str(caught.value)
