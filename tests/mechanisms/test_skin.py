"""A modulus that changes towards the surface: its limits, and to first order a mixture of films (superposition)."""

import numpy as np
import pytest
from closed_forms import TRUTH, cone
from diagnosis_problem import RECORD_ONLY, problem, recordings, search_of

from palpate.diagnosis.diagnose import diagnose
from palpate.solver.simulation import simulate_batch, specification_from

KEY = "skin"
MODULUS, CONTRAST, PEAK = 3.0, 0.02, 11
BASE = {
    "material": {"model": "elastic", "youngs_modulus": MODULUS, "poisson_ratio": 0.3},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 28},
    "kinematics": "small",
}


def depths(*bodies):
    """Return the curves of bodies (modulus, mechanisms)."""
    specifications = [
        specification_from(
            BASE | {"material": BASE["material"] | {"youngs_modulus": modulus}, "mechanisms": mechanisms}
        )
        for modulus, mechanisms in bodies
    ]
    simulations = simulate_batch(specifications)
    assert [each.status for each in simulations] == ["ok"] * len(bodies)
    return [each.depth for each in simulations]


def skin(contrast, depth):
    return {KEY: {"contrast": contrast, "depth": depth}}


@pytest.mark.parametrize("contrast", [0.5, -0.3])
def test_a_deep_skin_is_another_body_and_a_thin_one_is_none(contrast):
    plain, other = depths((MODULUS, {}), (MODULUS * (1.0 + contrast), {}))
    (deep,), (thin,) = depths((MODULUS, skin(contrast, 1e8))), depths((MODULUS, skin(contrast, 1.0)))
    assert deep[PEAK] == pytest.approx(other[PEAK], rel=1e-3)
    assert thin[PEAK] == pytest.approx(plain[PEAK], rel=3e-3)


def test_a_skin_without_contrast_is_the_body():
    plain, none = depths((MODULUS, {}), (MODULUS, skin(0.0, 300.0)))
    assert none == pytest.approx(plain, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("depth", [100.0, 400.0])
def test_a_weak_skin_is_a_mixture_of_films(depth):
    """To first order exp(-z / d) is a mixture of layers whose thicknesses have the density exp(-t / d) / d."""
    nodes, weights = np.polynomial.laguerre.laggauss(8)
    held = np.maximum(nodes * depth, 80.0)  # no element holds thinner ones, which act in proportion to their thickness
    films = [
        (MODULUS * (1.0 + CONTRAST), {"film_on_substrate": {"thickness": float(t), "substrate_modulus": MODULUS}})
        for t in held
    ]
    plain, found, *layered = depths((MODULUS, {}), (MODULUS, skin(CONTRAST, depth)), *films)
    expected = (weights * nodes * depth / held) @ (np.array(layered) - plain)
    assert (found - plain)[PEAK] == pytest.approx(expected[PEAK], rel=0.08)


def stiffened(protocol, values):
    """Return the depth (n,) that a skin adds about to the cone's, whose contact feels it to a depth of its own."""
    depth = cone(protocol, **TRUTH)
    return depth * ((1.0 + values["contrast"] / (1.0 + depth / values["depth"])) ** -0.5 - 1.0)


def test_it_is_named():
    planted = {"contrast": 0.6, "depth": 200.0}
    observed = recordings(np.random.default_rng(4), lambda c, _: stiffened(c.protocol, planted))
    task = problem(observed, **{KEY: stiffened})
    found = diagnose(search_of(task, [*RECORD_ONLY, KEY]), lambda said: None)
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(KEY,)])
