"""Classical analyses: exact limits, the materials they were made for, and finite elements as an independent code."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from palpate.analytic import hertz, sneddon
from palpate.classical import (
    AreaFunction,
    TipConstants,
    corrected_stiffness,
    depth_while_growing,
    fit_unloading,
    fit_viscoelastic,
    oliver_pharr,
    ting,
)
from palpate.classical.creep import creep_rate
from palpate.classical.viscoelastic_depth import Compliance, hereditary
from palpate.errors import InputError
from palpate.solver.simulation import simulate, specification_from
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid

CONE = Indenter("cone", half_angle=70.3)
SPHERE = Indenter("sphere", radius=1000.0)
BURGERS = {"youngs_modulus": 3.0, "steady_coefficient": 0.02, "transient_coefficient": 0.3, "retardation_time": 4.0}


@pytest.mark.parametrize(("indenter", "form", "length"), [(CONE, sneddon, 70.3), (SPHERE, hertz, 1000.0)])
def test_elastic_limit_is_sneddon_and_hertz(indenter, form, length):
    protocol = trapezoid(2.0, 1.0, 0.0, 1.0, points=20)
    depth = depth_while_growing(Compliance.of({"youngs_modulus": 70.0}, 0.3), indenter, protocol)
    assert depth == pytest.approx(form.depth(protocol.sample_load, 70.0, 0.3, length), rel=1e-12)


def test_hereditary_integral_agrees_with_quadrature():
    compliance = Compliance.of(BURGERS, 0.3)
    protocol = trapezoid(1.5, 3.0, 2.0, 4.0, points=18)
    rate = np.diff(protocol.knot_load) / np.diff(protocol.knot_time)

    def integral(t):
        pieces = zip(protocol.knot_time[:-1], protocol.knot_time[1:], rate, strict=True)
        return sum(r * quad(lambda x: compliance.at(t - x), a, min(b, t))[0] for a, b, r in pieces if a < t)

    expected = [integral(t) for t in protocol.sample_time]
    assert hereditary(compliance, protocol, protocol.sample_time) == pytest.approx(expected, rel=1e-9)


def test_instant_loading_and_hold_give_the_compliance_itself():
    compliance = Compliance.of(BURGERS, 0.3)
    protocol = Protocol([0.0, 1e-6, 30.0], [0.0, 1.0, 1.0], np.linspace(0.5, 30.0, 40))
    expected = compliance.at(protocol.sample_time)
    assert hereditary(compliance, protocol, protocol.sample_time) == pytest.approx(expected, rel=1e-5)


def test_relaxation_is_the_inverse_of_the_compliance():
    """A Maxwell body relaxes as exp(-t/tau)/M_0 with tau = M_0/rate."""
    compliance = Compliance(0.5, 0.1, ())
    psi = ting.relaxation(compliance, 0.01, 500)
    middle = 0.01 * (np.arange(500) + 0.5)
    assert psi == pytest.approx(np.exp(-middle / 5.0) / 0.5, rel=5e-3)


@pytest.mark.parametrize("indenter", [CONE, SPHERE])
def test_elastic_unloading_retraces_loading(indenter):
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=40)
    compliance = Compliance.of({"youngs_modulus": 3.0}, 0.34)
    assert ting.depth(compliance, indenter, protocol, 2000) == pytest.approx(
        depth_while_growing(compliance, indenter, protocol), rel=0.02, abs=3.0
    )


def test_ting_converges_with_the_grid():
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=40)
    compliance = Compliance.of(BURGERS, 0.5)
    coarse, middle, fine = (ting.depth(compliance, CONE, protocol, steps) for steps in (200, 400, 1600))
    assert np.abs(middle - fine).max() < 0.6 * np.abs(coarse - fine).max()
    assert np.abs(middle - fine).max() < 0.005 * fine.max()


def test_ting_knows_no_reloading():
    once, twice = (
        Protocol(np.arange(5.0), np.array([0.0, 1.0, 1.0, again, 0.0]), np.linspace(0.1, 4.0, 40))
        for again in (0.5, 1.2)
    )
    assert np.all(np.isfinite(ting.depth(Compliance.of(BURGERS, 0.3), CONE, once, steps=50)))
    assert np.all(np.isfinite(ting.depth(Compliance.of(BURGERS, 0.3), CONE, twice, steps=50))), (
        "a second step of loading"
    )
    cycles = Protocol(np.arange(5.0), np.array([0.0, 1.0, 0.4, 0.8, 0.0]), np.linspace(0.1, 4.0, 40))
    with pytest.raises(InputError, match="rises again at 2 s"):
        ting.depth(Compliance.of(BURGERS, 0.3), CONE, cycles)


def test_ting_agrees_with_finite_elements_in_unloading():
    """The closed form neglects the true contact normal and radial displacement (2 to 3 % of the depth)."""
    material = {
        "model": "nonlinear_burgers",
        "poisson_ratio": 0.499,
        **BURGERS,
        "steady_exponent": 0.0,
        "transient_exponent": 0.0,
    }
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=40)
    found = simulate(
        specification_from(
            {
                "material": material,
                "indenter": {"shape": "cone", "half_angle": 70.3},
                "protocol": protocol,
                "kinematics": "small",
            }
        )
    ).depth
    closed = ting.depth(Compliance.of(BURGERS, 0.499), CONE, protocol)
    shape = found / found[19] - closed / closed[19]
    assert found[:20] == pytest.approx(closed[:20], rel=0.04)
    assert np.abs(shape[:38]).max() < 0.02


def test_fit_recovers_what_made_the_curve():
    protocol = trapezoid(1.0, 10.0, 10.0, 10.0, points=60)
    depth = ting.depth(Compliance.of(BURGERS, 0.34), CONE, protocol)
    found = fit_viscoelastic("burgers", CONE, protocol, depth, 0.34, unloading=True)
    assert {name: found.values[name] for name in BURGERS} == pytest.approx(BURGERS, rel=0.01)
    loading = depth_while_growing(Compliance.of(BURGERS, 0.34), CONE, protocol)
    found = fit_viscoelastic("burgers", CONE, protocol, loading, 0.34, unloading=False)
    assert {name: found.values[name] for name in BURGERS} == pytest.approx(BURGERS, rel=0.01)


def test_oliver_pharr_is_exact_for_its_own_model():
    """Elastic unloading of a cone from Sneddon's solution: h_c = 2 h / pi, epsilon = 2 (pi - 2) / pi, beta 1."""
    modulus, nu, tan = 70.0, 0.3, math.tan(math.radians(70.3))
    load = np.concatenate([np.linspace(0.1, 5, 50), np.linspace(5, 0, 51)[1:]])
    depth = 1e3 * np.sqrt(load * math.pi * (1 - nu**2) / (2 * modulus * tan))
    tip = TipConstants(AreaFunction((math.pi * tan**2,)), beta=1.0, epsilon=2 * (math.pi - 2) / math.pi, elastic=None)
    found = oliver_pharr(load, depth, nu, tip=tip)
    assert found.exponent == pytest.approx(2.0, rel=1e-4)
    assert found.contact_depth == pytest.approx(2 / math.pi * depth.max(), rel=1e-4)
    assert found.modulus == pytest.approx(modulus, rel=1e-3)


def test_an_elastic_tip_makes_the_sample_stiffer_than_its_contact():
    load = np.concatenate([np.linspace(0.1, 5, 50), np.linspace(5, 0, 51)[1:]])
    depth = 500 + 100 * np.sqrt(load)
    rigid, diamond = (oliver_pharr(load, depth, 0.2, tip=TipConstants(elastic=e)) for e in (None, (1141.0, 0.07)))
    assert 1 / diamond.reduced_modulus == pytest.approx((1 - 0.04) / diamond.modulus + (1 - 0.0049) / 1141.0)
    assert diamond.modulus > rigid.modulus


def unloaded(modulus):
    """A cone's elastic recovery on a rigid tip, from a depth that a first loading left."""
    load = np.concatenate([np.linspace(0.1, 5, 50), np.linspace(5, 0, 51)[1:]])
    recovered = 1e3 * math.sqrt(math.pi / 24.5 * 5.0 / modulus)
    return load, 2000 - recovered * (1.0 - np.sqrt(load / 5.0))


@pytest.mark.parametrize("begin", [0.0, -1995.0], ids=["all depths negative", "more recovered than there was"])
def test_an_unloading_that_cannot_be_one_is_told(begin):
    load, depth = unloaded(70.0)
    frame = 0.0 if begin else 2000.0
    with pytest.raises(InputError, match="cannot recover"):
        fit_unloading(load, depth + begin - frame * load)


def test_a_contact_stiffer_than_its_tip_is_told():
    load, depth = unloaded(1e7)
    assert oliver_pharr(load, depth, 0.3, tip=TipConstants(elastic=None)).reduced_modulus > 1141.0 / (1 - 0.07**2)
    with pytest.raises(InputError, match="which the tip allows on no sample"):
        oliver_pharr(load, depth, 0.3)


def test_a_contact_above_the_surface_is_told():
    load, depth = unloaded(70.0)
    with pytest.raises(InputError, match="contact depth is -"):
        oliver_pharr(load, depth - 1970.0, 0.3)


def test_creep_correction_removes_exactly_the_creep_that_was_added():
    elastic, rate, unloading = 0.02, 0.8, 0.5
    apparent = 1 / (1 / elastic - rate / unloading)
    assert corrected_stiffness(apparent, rate, unloading) == pytest.approx(elastic)
    assert corrected_stiffness(apparent, 0.0, unloading) == pytest.approx(apparent)


def test_creep_rate_of_a_parabola():
    time = np.linspace(0, 20, 201)
    load = np.clip(time, 0, 10) / 10
    depth = np.where(time < 10, 10 * time, 100 + 3 * (time - 10) - 0.1 * (time - 10) ** 2)
    assert creep_rate(time, load, depth) == pytest.approx(1.0, rel=1e-6)
    with pytest.raises(InputError, match="no hold"):
        creep_rate(time, time / 20, depth)


def test_creep_rate_does_not_count_the_beginning_of_unloading():
    rise, hold, down = np.arange(-10.0, 0.0, 0.1), np.linspace(0.0, 10.0, 101), np.linspace(10.03, 40.0, 1000)
    load = np.concatenate([1 + rise / 10, np.ones(101), 1 - (down - 10) / 30])
    depth = np.concatenate([300 + 30 * rise, 300 + 3 * hold - 0.1 * hold**2, 320 - 100 * (down - 10) / 30])
    assert creep_rate(np.concatenate([rise, hold, down]), load, depth) == pytest.approx(1.0, rel=0.06)
