"""The solver against exact laws, exact solutions and finite differences."""

import numpy as np
import pytest
from palpate.materials.radial import step_weights

from palpate.fem import hencky, linear
from palpate.fem.discretisation import RESOLUTIONS, mesh_radii, step_times
from palpate.fem.indent import indent, march
from palpate.fem.mesh import Resolution, polar_mesh, ring_radii
from palpate.fem.newton import Problem, State, Workspace, advance
from palpate.fem.profile import Profile
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
    outcome = indent(Specimen(coefficients), indenter, protocol, resolution, large)
    assert not outcome.reason
    return outcome.depth


def random_element(rng):
    mesh = polar_mesh(np.array([0.5, 1.0, 1.6]), 3)
    return mesh.gradients[4], mesh.weights[4], rng.normal(scale=0.05, size=8)


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("key", ["nonlinear_burgers", "burgers_plasticity"])
def test_tangent_is_the_derivative_of_the_force(large, key):
    rng = np.random.default_rng(3)
    gradients, volumes, u = random_element(rng)
    coefficients = LAWS[key].coefficients(
        BURGERS | ({"yield_stress": 0.05, "hardening": 0.3} if key == "burgers_plasticity" else {})
    )
    weights = step_weights(coefficients, 0.7)
    past = rng.normal(scale=0.01, size=(4, 4))
    past[:, 2] = -past[:, 0] - past[:, 1]
    alpha = np.full(4, 0.01)
    deviatoric, dilatation = linear.fixed_matrices(gradients[None], volumes[None])

    def evaluate(displacement):
        ke, fe = np.zeros((9, 9)), np.zeros(9)
        work = (past, alpha, np.zeros(4), weights, coefficients, np.empty((4, 4)), ke, fe)
        if large:
            assert hencky.element(gradients, volumes, displacement, *work)
        else:
            linear.element(gradients, volumes, deviatoric[0], dilatation[0], displacement, *work)
        return ke[:8, :8], fe[:8]

    tangent, _ = evaluate(u)
    step = 1e-6
    numeric = np.stack(
        [(evaluate(u + step * e)[1] - evaluate(u - step * e)[1]) / (2 * step) for e in np.eye(8)], axis=1
    )
    assert np.abs(tangent - numeric).max() < 1e-6 * np.abs(tangent).max()
    if not large:
        assert np.abs(tangent - tangent.T).max() < 1e-10 * np.abs(tangent).max()


def test_large_strain_does_not_feel_a_rigid_rotation():
    """F = R U: the force of the rotated element is the rotated force, here for an element far from the axis."""
    mesh = polar_mesh(np.array([1.0, 1.2]), 8)
    nodes = mesh.nodes[mesh.elements[8]] + np.array([1e6, 0.0])
    from palpate.fem.mesh import _integration

    gradients, volumes = (part[0] for part in _integration(nodes[None]))
    coefficients = law()
    rng = np.random.default_rng(1)
    stretch = rng.normal(scale=0.05, size=(4, 2))
    angle = 0.8
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre = nodes.mean(axis=0)

    def force(positions):
        ke, fe = np.zeros((9, 9)), np.zeros(9)
        u = (positions - nodes).ravel()
        args = (np.zeros((4, 4)), np.zeros(4), np.zeros(4), step_weights(coefficients, 1.0), coefficients)
        assert hencky.element(gradients, volumes, u, *args, np.empty((4, 4)), ke, fe)
        return fe[:8].reshape(4, 2)

    deformed = nodes + stretch * 0.02
    rotated = centre + (deformed - centre) @ turn.T
    assert force(rotated) == pytest.approx(force(deformed) @ turn.T, abs=1e-5 * np.abs(force(deformed)).max())


@pytest.mark.parametrize("large", [False, True])
def test_newton_converges_quadratically(large):
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0)
    mesh = polar_mesh(ring_radii(0.1, 0.8, STANDARD), STANDARD.sectors)
    region = np.zeros(len(mesh.elements), dtype=np.int64)
    problem = Problem(mesh, Profile.of(CONE), Specimen(law()), law()[None], region, large)
    work, state, before = Workspace.of(problem), State.initial(problem), None
    for time in step_times(protocol, STANDARD)[:12]:
        state, before, _ = march(problem, protocol, state, before, time, work)
    advance(problem, state, 1.2 * time, float(protocol.load_at(1.2 * time)), 1.0, state, work)
    norms = np.array(work.norms)
    tail = norms[norms < 1e-2]
    assert tail[-1] < 1e-7
    assert np.all(tail[1:] < 30 * tail[:-1] ** 2 + 1e-13)


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


def test_a_step_that_cannot_converge_is_reported(monkeypatch):
    for limit in ("ITERATIONS", "CAREFUL_ITERATIONS"):
        monkeypatch.setattr(f"palpate.fem.newton.{limit}", 1)
    outcome = indent(Specimen(law()), CONE, trapezoid(1.0, 30.0, 0.0, 30.0), STANDARD)
    assert "no equilibrium" in outcome.reason
    assert np.isnan(outcome.depth).all()


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
    depths = [indent(Specimen(plastic), CONE, protocol, STANDARD, large, rings).depth for rings in shifted]
    constant = np.mean(depths, axis=0)[:20] / np.sqrt(protocol.sample_load[:20])
    assert np.abs(constant / constant[-1] - 1.0).max() < 0.006


@pytest.mark.parametrize(
    ("modulus", "yield_stress", "hardening", "large"), [(72.0, 3.0, 0.0, False), (70.0, 0.3, 0.07, True)]
)
def test_a_plastic_cone_that_hardly_hardens_keeps_to_its_law(modulus, yield_stress, hardening, large):
    """Under the first node much flows at once; whole iterations run away there."""
    constants = {"youngs_modulus": modulus, "poisson_ratio": 0.3, "yield_stress": yield_stress, "hardening": hardening}
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=60)
    outcome = indent(Specimen(law("bilinear_plasticity", **constants)), CONE, protocol, STANDARD, large)
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
    hardness, stretches = [], []

    def observe(problem, state):
        surface = problem.mesh.surface
        r, moved = problem.mesh.nodes[surface, 0], state.displacement[surface, 0]
        stretches.append(1.0 + (np.diff(moved) / np.diff(r)).min())
        edge = np.flatnonzero(state.contact[surface])[-1]
        if 2.0 < state.time <= 10.0:
            radius = (r + large * moved)[edge : edge + 2].mean()  # at small strains forces count per undeformed area
            hardness.append(-state.force[:, 1].sum() / (np.pi * radius**2 * 0.3))

    plastic, protocol = law("bilinear_plasticity", **constants), trapezoid(load, 10.0, 0.0, 10.0, points=40)
    outcome = indent(Specimen(plastic), tip, protocol, STANDARD, large, observe=observe)
    assert outcome.reason == ""
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
