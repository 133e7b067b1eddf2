"""The solver against exact laws, exact solutions and finite differences."""

import numpy as np
import pytest
from bodies import internal_force, moments

from palpate.fem import batch
from palpate.fem.batch import Case, indent_batch, run_lanes
from palpate.fem.batch_march import March
from palpate.fem.discretisation import RESOLUTIONS, mesh_radii, step_times
from palpate.fem.mesh import Resolution
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.model import simulate
from palpate.protocol import Protocol, trapezoid
from palpate.specification import Specification
from palpate.specimen import Specimen
from palpate.verification.materials import BURGERS

CONE = Indenter("cone", 70.3)
STANDARD = RESOLUTIONS["standard"]


def law(key="nonlinear_burgers", **values):
    return LAWS[key].coefficients(BURGERS | values if key == "nonlinear_burgers" else values)


def depth(coefficients, protocol, resolution=STANDARD, indenter=CONE, large=False):
    (outcome,) = indent_batch([Case(Specimen(coefficients), indenter, protocol, resolution, large)])
    assert not outcome.reason
    return outcome.depth


def test_newton_converges_quadratically(monkeypatch):
    """Six digits more of the unbalanced forces cost one or two iterations; at large strains the tangent is not exact."""
    whole = Case(Specimen(law()), CONE, trapezoid(1.0, 30.0, 0.0, 30.0), STANDARD)
    iterations = []
    for tolerance in (1e-5, 1e-11):
        monkeypatch.setattr(batch, "TOLERANCE", tolerance)
        (history,) = run_lanes([whole])
        iterations.append(history.iterations / history.steps)
    assert iterations[1] < iterations[0] + 2.0


@pytest.mark.parametrize("large", [False, True])
def test_load_scaling_on_one_fixed_mesh(large):
    """h(t; kP) = sqrt(k) h(t; P) for a sharp cone; within one elastic curve the mesh is the same for all loads."""
    protocol = trapezoid(1.0, 1.0, 0.0, 1.0, points=40)
    loading = slice(0, 20)
    h = depth(law("elastic", youngs_modulus=3.28, poisson_ratio=0.34), protocol, RESOLUTIONS["fine"], large=large)[
        loading
    ]
    ratio = h / np.sqrt(protocol.sample_load[loading])
    assert np.ptp(ratio) / ratio.mean() < 1e-3


@pytest.mark.parametrize("large", [False, True])
def test_load_scaling_between_simulations(large):
    one = depth(law(), trapezoid(1.0, 30.0, 5.0, 30.0), large=large)
    other = depth(law(), trapezoid(2.7, 30.0, 5.0, 30.0), large=large)
    assert other == pytest.approx(np.sqrt(2.7) * one, rel=1e-3)


@pytest.mark.parametrize("large", [False, True])
def test_stress_scaling(large):
    c = 5.0
    scaled = law(
        youngs_modulus=3.28 * c, steady_coefficient=0.09 * c**-1.4, transient_coefficient=0.24 * c ** -(2 * 0.47 + 1)
    )
    one = depth(law(), trapezoid(1.0, 30.0, 0.0, 30.0), large=large)
    assert depth(scaled, trapezoid(c, 30.0, 0.0, 30.0), large=large) == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize("large", [False, True])
def test_time_scaling(large):
    b = 3.0
    scaled = law(steady_coefficient=0.09 / b, retardation_time=0.25 * b)
    one = depth(law(), trapezoid(1.0, 30.0, 0.0, 30.0), large=large)
    assert depth(scaled, trapezoid(1.0, 30.0 * b, 0.0, 30.0 * b), large=large) == pytest.approx(one, rel=1e-6)


def sneddon_ratio(resolution, half_angle=89.0):
    """Depth over Sneddon's for a shallow cone, where his small-slope solution is exact."""
    modulus, ratio, load = 3.28, 0.34, 1e-3
    h = depth(
        law("elastic", youngs_modulus=modulus, poisson_ratio=ratio),
        trapezoid(load, 1.0, 0.0, 1.0, points=20),
        resolution,
        Indenter("cone", half_angle),
    )[9]
    exact = 1e3 * np.sqrt(np.pi / 2 * load * (1 - ratio**2) / modulus / np.tan(np.radians(half_angle)))
    return h / exact


def test_sneddon_within_one_per_cent_and_approached():
    errors = [abs(sneddon_ratio(Resolution(growth=g, sectors=s)) - 1) for g, s in ((1.2, 5), (1.1, 9), (1.05, 18))]
    assert errors[1] < 0.01
    assert errors[2] < 0.005
    assert errors[0] > errors[1] > errors[2]


def test_hertz_within_one_per_cent():
    modulus, ratio, load, radius = 3.28, 0.34, 0.5, 1e5
    h = depth(
        law("elastic", youngs_modulus=modulus, poisson_ratio=ratio),
        trapezoid(load, 1.0, 0.0, 1.0, points=40),
        indenter=Indenter("sphere", radius=radius),
    )[:20]
    loads = trapezoid(load, 1.0, 0.0, 1.0, points=40).sample_load[:20]
    exact = 1e3 * (9 / 16 * (loads * (1 - ratio**2) / modulus) ** 2 / (radius * 1e-3)) ** (1 / 3)
    assert h[2:] == pytest.approx(exact[2:], rel=0.01)


def test_linear_viscoelastic_closed_form_while_contact_grows():
    """h^2 = (pi / (4 tan alpha)) int J(t - t') dP at nu = 0.5; shallow, so that the small-slope solution holds."""
    values = {"poisson_ratio": 0.499, "steady_exponent": 0.0, "transient_exponent": 0.0, "retardation_time": 5.0}
    alpha, load, duration = 88.0, 1e-3, 30.0
    protocol = trapezoid(load, duration, 0.0, duration)
    h = depth(law(**values), protocol, indenter=Indenter("cone", alpha))[:50]
    t = protocol.sample_time[:50]
    g, tau = 3.28 / (2 * 1.499), 5.0
    integral = t / (2 * g) + 0.09 * t**2 / 2 + 0.24 * (t - tau * (1 - np.exp(-t / tau)))
    exact = 1e3 * np.sqrt(np.pi / (4 * np.tan(np.radians(alpha))) * load / duration * integral)
    assert h[2:] == pytest.approx(exact[2:], rel=0.01)


def test_sphero_cone_lies_between_sphere_and_cone():
    coefficients = law("elastic", youngs_modulus=3.28, poisson_ratio=0.34)
    protocol = trapezoid(1.0, 1.0, 0.0, 1.0, points=20)
    sharp = depth(coefficients, protocol)
    tiny = depth(coefficients, protocol, indenter=Indenter("sphero_cone", 70.3, 1.0))
    blunt = depth(coefficients, protocol, indenter=Indenter("sphero_cone", 70.3, 300.0))
    assert tiny[:19] == pytest.approx(sharp[:19], rel=3e-3)
    assert np.all(blunt[:19] < sharp[:19])


def test_standard_is_within_half_a_per_cent_of_fine():
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0)
    standard, fine = (depth(law(), protocol, RESOLUTIONS[name]) for name in ("standard", "fine"))
    assert np.abs(standard / fine - 1).max() < 0.005


@pytest.mark.parametrize("parameters", [{}, {"steady_exponent": 1.5, "steady_coefficient": 5.0}])
def test_load_history_of_any_shape(parameters):
    """Reloading, holds and a return to zero: the curve is complete, and depth never falls while load is held."""
    protocol = Protocol(
        np.array([0.0, 10.0, 20.0, 25.0, 35.0, 45.0, 50.0]),
        np.array([0.0, 0.6, 0.6, 0.1, 1.0, 1.0, 0.0]),
        np.arange(0.5, 50.5, 0.5),
    )
    h = depth(law(**parameters), protocol)
    hold = (protocol.sample_time >= 10) & (protocol.sample_time <= 20)
    assert np.all(np.diff(h[hold]) > 0)
    assert np.all(np.isfinite(h))


def test_a_failure_is_told_and_the_curve_ends_there(monkeypatch):
    """What was found before it stays, and the reason names the time; another lane goes on."""
    step = March.step

    def without_the_first(self, states, begin, end, *rest):
        found = step(self, states, begin, end, *rest)
        found[0] &= end[0] <= 36.0
        return found

    one = Case(Specimen(law()), CONE, trapezoid(1.0, 30.0, 0.0, 30.0, points=20), STANDARD)
    other = Case(Specimen(law()), Indenter("cone", 68.0), one.protocol, STANDARD)
    whole = indent_batch([one, other])
    monkeypatch.setattr(March, "step", without_the_first)
    failed, unharmed = indent_batch([one, other])
    known = one.protocol.sample_time <= 36.0
    assert "no equilibrium beyond 36 s" in failed.reason
    for found, expected in ((failed.depth, whole[0].depth), (failed.load, whole[0].load)):
        assert np.array_equal(np.isfinite(found), known)
        assert found[known] == pytest.approx(expected[known], rel=1e-12)
    assert unharmed.reason == ""
    assert unharmed.depth == pytest.approx(whole[1].depth, rel=1e-12)


def test_where_a_body_yields_the_load_grows_little_within_a_step():
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=20)
    times, usual = step_times(protocol, STANDARD, yields=True), step_times(protocol, STANDARD)
    load = protocol.load_at(times)
    assert np.isin(usual, times).all()
    assert (load[1:] / np.maximum(load[:-1], 1e-12)).max() < 1.1251


@pytest.mark.parametrize("large", [False, True])
def test_a_plastic_cone_keeps_to_its_law_from_the_first_sample(large):
    """Without creep depth / sqrt(load) is constant; with a step from one sample to the next it departs by 3 %."""
    plastic = law("bilinear_plasticity", youngs_modulus=3.0, poisson_ratio=0.34, yield_stress=0.1, hardening=0.3)
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=40)
    radii = mesh_radii(Specimen(plastic), CONE, protocol, STANDARD)
    shifted = [radii * STANDARD.growth ** (part / 4) for part in range(4)]
    cases = [Case(Specimen(plastic), CONE, protocol, STANDARD, large, rings=rings) for rings in shifted]
    depths = [history.depth for history in indent_batch(cases)]
    constant = np.mean(depths, axis=0)[:20] / np.sqrt(protocol.sample_load[:20])
    assert np.abs(constant / constant[-1] - 1.0).max() < 0.006


@pytest.mark.parametrize(
    ("modulus", "yield_stress", "hardening", "large"), [(72.0, 3.0, 0.0, False), (70.0, 0.3, 0.07, True)]
)
def test_a_plastic_cone_that_hardly_hardens_keeps_to_its_law(modulus, yield_stress, hardening, large):
    """Under the first node much flows at once; whole iterations run away there."""
    constants = {"youngs_modulus": modulus, "poisson_ratio": 0.3, "yield_stress": yield_stress, "hardening": hardening}
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=60)
    body = Specimen(law("bilinear_plasticity", **constants))
    (outcome,) = indent_batch([Case(body, CONE, protocol, STANDARD, large)])
    assert outcome.reason == ""
    constant = outcome.depth[2:30] / np.sqrt(protocol.sample_load[2:30])
    assert constant == pytest.approx(constant.mean(), rel=0.03)


@pytest.mark.parametrize(
    ("tip", "load", "large"),
    [(Indenter("sphere", radius=1000.0), 0.3, False), (Indenter("sphero_cone", 70.3, 500.0), 3.0, True)],
)
def test_a_solid_that_never_hardens_bears_a_rounded_tip(tip, load, large):
    """Its hardness is two to three times its yield stress, as slip lines have it, and its surface never folds."""
    constants = {"youngs_modulus": 70.0, "poisson_ratio": 0.3, "yield_stress": 0.3, "hardening": 0.0}
    plastic, protocol = law("bilinear_plasticity", **constants), trapezoid(load, 10.0, 0.0, 10.0, points=40)
    hardness, stretches = [], []
    for moment in moments(Case(Specimen(plastic), tip, protocol, STANDARD, large)):
        surface = moment.mesh.surface
        r, moved = moment.mesh.nodes[surface, 0], moment.displacement[surface, 0]
        stretches.append(1.0 + (np.diff(moved) / np.diff(r)).min())
        pressing = -internal_force(moment)[surface, 1]
        edge = np.flatnonzero(pressing > 0.05 * pressing.max())[-1]
        if 2.0 < moment.time <= 10.0:
            radius = (r + large * moved)[edge : edge + 2].mean()  # at small strains forces count per undeformed area
            hardness.append(moment.load / (np.pi * radius**2 * 0.3))
    assert 1.6 < min(hardness) < max(hardness) < 3.0
    assert min(stretches) > 0.0


def test_a_sphere_that_sinks_in_beyond_its_radius_is_a_failure():
    """At small strains nothing stops it: 20 radii deep, a curve would look whole."""
    constants = {"youngs_modulus": 10.0, "poisson_ratio": 0.3, "yield_stress": 0.1, "hardening": 0.0}
    tip, protocol = Indenter("sphere", radius=1000.0), trapezoid(1.0, 10.0, 0.0, 10.0, points=20)
    outcome = simulate(Specification("bilinear_plasticity", constants, tip, protocol))
    assert outcome.status == "failed"
    assert "beyond its radius" in outcome.reason
    assert np.isnan(outcome.depth[-1])
    assert np.nanmax(outcome.depth) <= 1000.0
