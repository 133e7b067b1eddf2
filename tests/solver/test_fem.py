"""The solver against exact laws, exact solutions and finite differences."""

from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
import pytest
from bodies import CONE, STANDARD, depth, internal_forces, stiffness
from kernels import from_python, no_coupling, reverse_slip

from palpate.materials import LAWS
from palpate.materials.flow.row import step_weights, voigt_elements
from palpate.solver.axisymmetric import march, newton
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.law_lanes import Points
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.mesh import Mesh, _integration, polar_mesh
from palpate.solver.axisymmetric.trial_state import Material, Setup
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS


def law(key="nonlinear_burgers", **values):
    return LAWS[key].coefficients(BURGERS | values if key == "nonlinear_burgers" else values)


@dataclass
class Lanes:
    """One body in all lanes, with its forces and its stiffness at given displacements (size + 1, LANES)."""

    mesh: Mesh
    coefficients: np.ndarray
    large: bool | None

    def __post_init__(self):
        self.body = Body.of(self.mesh)
        self.points = Points.unloaded(4 * len(self.mesh.elements), voigt_elements(self.coefficients))
        self.laws = np.repeat(self.coefficients[None, :, None], LANES, axis=2)
        self.weights = step_weights(self.laws, np.full(LANES, 0.7))
        self.setup, self.material = Setup(self.large, self.body, None), Material(self.points, self.laws, self.weights)

    def forces(self, displacement):
        forces = np.zeros_like(displacement)
        internal_forces(self.setup, self.material, displacement, forces)
        return forces

    def stiffness(self, displacement):
        """Return the matrix (size, size) of the first lane, after `forces`; its upper half is its lower half."""
        size, width = self.body.size, self.body.width
        band = np.zeros((size * width + 1, LANES))
        stiffness(self.setup, self.material, displacement, np.ones(LANES), band)
        matrix = np.zeros((size, size))
        for k in range(width):
            below = band[k : size * width : width, 0][: max(size - k, 0)]
            matrix += np.diag(below, -k) + (np.diag(below, k) if k else 0.0)
        return matrix


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("key", ["nonlinear_burgers", "burgers_plasticity"])
def test_tangent_is_the_derivative_of_the_force(large, key):
    """At large strains its symmetric part: true stress has no potential, see `palpate.solver.axisymmetric.hencky`."""
    rng = np.random.default_rng(3)
    coefficients = LAWS[key].coefficients(
        BURGERS | ({"yield_stress": 0.05, "hardening": 0.3} if key == "burgers_plasticity" else {})
    )
    lanes = Lanes(polar_mesh(np.array([0.5, 1.0, 1.6, 2.5]), 3), coefficients, large or None)
    past = rng.normal(scale=0.01, size=lanes.points.past.shape[:2])
    past[:, 2] = -past[:, 0] - past[:, 1]
    lanes.points.past[:] = past[:, :, None]
    lanes.points.alpha[:] = 0.01
    size, step = lanes.body.size, 1e-6
    displacement = np.repeat(rng.normal(scale=0.05, size=(size + 1, 1)), LANES, axis=1)
    displacement[-1] = 0.0
    numeric = np.empty((size, size))
    for i in range(size):
        moved = displacement.copy()
        moved[i, :2] += [step, -step]
        forces = lanes.forces(moved)
        numeric[:, i] = (forces[:-1, 0] - forces[:-1, 1]) / (2 * step)
    lanes.forces(displacement)
    tangent = lanes.stiffness(displacement)
    assert np.abs(tangent - 0.5 * (numeric + numeric.T)).max() < 1e-6 * np.abs(tangent).max()
    if not large:
        assert np.abs(numeric - numeric.T).max() < 1e-6 * np.abs(tangent).max()


def element_away_from_the_axis(nodes):
    """Return the mesh of one element, none of whose nodes is held."""
    gradients, weights = _integration(nodes[None])
    return Mesh(nodes, np.arange(4)[None], np.arange(8).reshape(4, 2), np.array([0]), gradients, weights)


def test_large_strain_does_not_feel_a_rigid_rotation():
    """F = R U: the force of the rotated element is the rotated force, here for an element far from the axis."""
    mesh = polar_mesh(np.array([1.0, 1.2]), 8)
    nodes = mesh.nodes[mesh.elements[8]] + np.array([1e6, 0.0])
    lanes = Lanes(element_away_from_the_axis(nodes), law(), large=True)
    stretch = np.random.default_rng(1).normal(scale=0.05, size=(4, 2))
    angle = 0.8
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre = nodes.mean(axis=0)

    def force(positions):
        displacement = np.append((positions - nodes).ravel(), 0.0)
        return lanes.forces(np.repeat(displacement[:, None], LANES, axis=1))[:8, 0].reshape(4, 2)

    deformed = nodes + stretch * 0.02
    rotated = centre + (deformed - centre) @ turn.T
    assert force(rotated) == pytest.approx(force(deformed) @ turn.T, abs=1e-5 * np.abs(force(deformed)).max())


def opened_step(monkeypatch, number, case):
    """Return the arguments of `palpate.solver.axisymmetric.newton.advance` at the start of one step of a simulation."""
    kept = []

    def advance(*arguments):
        kept.append(deepcopy(arguments) if len(kept) == number else None)
        newton.advance(*arguments)

    monkeypatch.setattr(march, "advance", advance)
    indent_batch([case])
    return kept[number]


def newton_norms(opened, iterations):
    """Return the largest unbalanced force over the load, before each of some whole iterations of Newton's method."""
    setup, material, trial, prescribed, system, *_ = opened
    size, count = setup.body.size, len(setup.body.radial)
    residual, direction = from_python(newton.no_residual)(size), from_python(newton.no_direction)(size)
    forward, coupling = np.zeros((size + 1, LANES)), no_coupling(count)
    slips, changed = np.zeros((count, LANES)), np.zeros(LANES, dtype=bool)
    none, norms = np.zeros(LANES, dtype=bool), []
    for _ in range(iterations):
        reverse_slip(setup, trial, from_python(newton.shares_of)(setup, trial), slips, changed, none)
        from_python(newton.unbalance)(setup, material, trial, prescribed, residual, coupling, none)
        norms.append(max(np.abs(residual.forces[:-1, 0]).max(), abs(residual.excess[0])) / prescribed.scale[0])
        from_python(newton.factor)(setup, material, trial, system, coupling, np.ones(LANES), residual.forces, forward)
        residual.limit[:] = trial.contact.area
        from_python(newton.direct)(system, prescribed, residual, forward, ~none, direction)
        trial.displacement[:] += direction.displacement
        trial.depth[:] += direction.depth
        trial.contact.area[:] += direction.area
    return np.array(norms)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("large", [False, True])
def test_newton_converges_quadratically(large, friction, monkeypatch):
    """At large strains, where half of the tangent's unsymmetric part is left out, by a constant factor."""
    cone, protocol = replace(CONE, friction=friction), trapezoid(1.0, 30.0, 0.0, 30.0)
    norms = newton_norms(opened_step(monkeypatch, 12, Case(Specimen(law()), cone, protocol, STANDARD, large)), 12)
    tail = norms[norms < 1e-3]
    assert tail[-1] < 1e-12
    if large:
        assert np.all(tail[1:] < 0.2 * tail[:-1] + 1e-13)
    else:
        curvature = 1000 if friction else 100  # friction bends over a little slip, contact over its width
        assert np.all(tail[1:] < curvature * tail[:-1] ** 2 + 1e-13)


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


def sneddon_ratio(resolution, half_angle=89.99):
    """Depth over Sneddon's for a shallow cone, where his small-slope solution is exact.

    At 89 degrees what the surface moves inwards along the cone, which he leaves out, is 0.15 % of the depth.
    """
    modulus, ratio, load = 3.28, 0.34, 1e-3
    h = depth(
        law("elastic", youngs_modulus=modulus, poisson_ratio=ratio),
        trapezoid(load, 1.0, 0.0, 1.0, points=20),
        resolution,
        Indenter("cone", half_angle),
    )[9]
    exact = 1e3 * np.sqrt(np.pi / 2 * load * (1 - ratio**2) / modulus / np.tan(np.radians(half_angle)))
    return h / exact


def test_sneddon_within_a_thousandth_on_all_meshes_in_use():
    standard, medium, fine = [abs(sneddon_ratio(RESOLUTIONS[name]) - 1) for name in ("standard", "medium", "fine")]
    assert max(medium, fine) < 0.0003
    assert max(medium, fine) < standard < 0.001


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
    def advance(*arguments):
        arguments[-1][:] = False

    monkeypatch.setattr(march, "advance", advance)
    (outcome,) = indent_batch([Case(Specimen(law()), CONE, trapezoid(1.0, 30.0, 0.0, 30.0), STANDARD)])
    assert outcome.reason == "no equilibrium beyond 0 s"
    assert np.isnan(outcome.depth).all()
