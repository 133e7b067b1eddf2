"""Coulomb friction against exact laws, its own law at every node, and an independent code."""

from itertools import pairwise

import numpy as np
import pytest

from palpate.fem import banded
from palpate.fem.contact_size import contact_range
from palpate.fem.discretisation import RESOLUTIONS, step_times
from palpate.fem.friction import Friction
from palpate.fem.indent import indent, march
from palpate.fem.mesh import Resolution, polar_mesh, ring_radii
from palpate.fem.newton import Problem, State, Workspace
from palpate.fem.profile import Profile
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.protocol import Protocol, trapezoid
from palpate.specimen import Specimen
from palpate.verification.materials import BURGERS as EPOXY

BURGERS = LAWS["nonlinear_burgers"].coefficients(EPOXY)
METAL = LAWS["bilinear_plasticity"].coefficients(
    {"youngs_modulus": 70.0, "poisson_ratio": 0.345, "yield_stress": 0.1, "hardening": 0.5}
)
STANDARD = RESOLUTIONS["standard"]


def depth(friction, coefficients=BURGERS, protocol=None, shape=("cone", 70.3), large=False, resolution=STANDARD):
    protocol = protocol or trapezoid(1.0, 30.0, 0.0, 30.0)
    outcome = indent(Specimen(coefficients), Indenter(*shape, friction=friction), protocol, resolution, large)
    assert not outcome.reason
    return outcome.depth


def history(indenter, coefficients, protocol, resolution=STANDARD, large=False):
    """Return the problem and all states on the way."""
    specimen = Specimen(coefficients)
    mesh = polar_mesh(ring_radii(*contact_range(specimen, indenter, protocol), resolution), resolution.sectors)
    region = np.zeros(len(mesh.elements), dtype=np.int64)
    problem = Problem(
        mesh, Profile.of(indenter), specimen, coefficients[None], region, large, friction=indenter.friction
    )
    work, states, before = Workspace.of(problem), [State.initial(problem)], None
    for time in step_times(protocol, STANDARD):
        state, before, _ = march(problem, protocol, states[-1], before, time, work)
        states.append(state)
    return problem, states


def contact_forces(problem, state):
    """Return nodes in contact off the axis, their R, and sqrt(1 + f'^2) times their normal and tangential forces."""
    nodes = problem.mesh.surface[state.contact[problem.mesh.surface]][1:]
    r, moved = problem.mesh.nodes[nodes, 0], state.displacement[nodes, 0]
    slope = problem.profile.beneath(r, moved, problem.large)[1]
    radial, vertical = state.force[nodes].T
    return nodes, r + moved, slope * radial - vertical, radial + slope * vertical


@pytest.mark.parametrize("large", [False, True])
def test_load_scaling(large):
    """h(t; kP) = sqrt(k) h(t; P): friction has no length."""
    one = depth(0.25, protocol=trapezoid(1.0, 30.0, 5.0, 30.0), large=large)
    other = depth(0.25, protocol=trapezoid(2.7, 30.0, 5.0, 30.0), large=large)
    assert other == pytest.approx(np.sqrt(2.7) * one, rel=1e-3)


@pytest.mark.parametrize("large", [False, True])
def test_little_friction_does_little(large):
    """The effect vanishes with the coefficient, in proportion to it where all nodes slip."""
    none, little, twice = (depth(mu, large=large) for mu in (0.0, 2e-4, 4e-4))
    assert little == pytest.approx(none, rel=1e-4)
    assert (twice - none)[48] == pytest.approx(2 * (little - none)[48], rel=0.1)


@pytest.mark.parametrize(
    ("large", "peak", "end"), [(False, 490.9 / 499.3, 428.1 / 440.3), (True, 491.3 / 491.7, 426.4 / 429.2)]
)
def test_effect_on_creep_agrees_with_calculix(large, peak, end):
    """Friction 0.25 against none, at peak and late in unloading; CalculiX' curves themselves are good to 0.4 %."""
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0, points=50)
    ratio = depth(0.25, protocol=protocol, large=large) / depth(0.0, protocol=protocol, large=large)
    assert ratio[24] == pytest.approx(peak, abs=0.002)
    assert ratio[47] == pytest.approx(end, abs=0.004)


def test_effect_on_plastic_flow_agrees_with_calculix():
    """Over the whole loading, where the depth scatters about sqrt(P) from node to node; 643 against 675 nm at peak."""
    protocol = trapezoid(4.9, 15.0, 0.0, 15.0, points=50)
    ratio = depth(0.25, METAL, protocol) / depth(0.0, METAL, protocol)
    assert ratio[8:25].mean() == pytest.approx(643 / 675, abs=0.01)


@pytest.mark.parametrize("shape", [("cone", 70.3), ("sphere", 0.0, 2000.0), ("sphero_cone", 70.3, 200.0)])
@pytest.mark.parametrize("large", [False, True])
def test_law_holds_at_every_node_and_dissipates(shape, large):
    """|T| <= mu N, T against the slip, no pull, forces in balance with the load; with hold, unloading, reloading."""
    mu = 0.2
    protocol = Protocol(
        np.array([0.0, 10.0, 20.0, 30.0, 40.0, 50.0]), np.array([0.0, 0.6, 0.6, 0.1, 1.0, 0.01]), np.arange(1.0, 51.0)
    )
    problem, states = history(Indenter(*shape, friction=mu), BURGERS, protocol, large=large)
    total = 0.0
    for before, after in pairwise(states):
        nodes, _, normal, tangential = contact_forces(problem, after)
        assert np.all(normal > -2e-7)
        assert np.all(np.abs(tangential) <= mu * normal + 2e-7)
        load = protocol.load_at(np.array(after.time))
        assert -after.force[:, 1].sum() == pytest.approx(float(load), abs=2e-7)
        held = before.contact[nodes]
        slip = (after.displacement - before.displacement)[nodes, 0]
        work = -(tangential * slip)[held]
        far = np.abs(slip[held]) > 2 * Friction.of(mu, problem.profile(problem.mesh.nodes[nodes, 0])[0]).reach[held]
        assert np.all(work[far] >= 0.0)
        total += work.sum()
    assert total > 0.0


def stick_ratios(indenter, load, power):
    """Stick radius over contact radius of an elastic body while the contact radius grows in proportion to time."""
    time = np.linspace(0.0, 1.0, 51)
    protocol = Protocol(time, load * time**power, time[1:])
    law = LAWS["elastic"].coefficients({"youngs_modulus": 3.28, "poisson_ratio": 0.3})
    problem, states = history(indenter, law, protocol, Resolution(growth=1.05, sectors=12, inner=0.02))
    ratios = []
    for state in states[-25::6]:
        _, distance, normal, tangential = contact_forces(problem, state)
        radius = (
            np.sqrt(state.depth * problem.profile.radius)
            if problem.profile.radius
            else 2 / np.pi * state.depth / problem.profile.slope
        )
        slips = distance[tangential > indenter.friction * normal * (1 - 1e-6)]
        ratios.append(slips.min() / radius)
    return np.array(ratios)


def test_stick_radius_is_a_constant_part_of_the_contact_radius():
    """The same for every power-law profile of small slope (Spence, J. Elasticity 5 (1975) 297-319); mesh width 5 %."""
    mu = 0.2
    cone = stick_ratios(Indenter("cone", 89.9, friction=mu), 5e-5, 2)
    sphere = stick_ratios(Indenter("sphere", radius=1e6, friction=mu), 0.05, 3)
    assert np.ptp(cone) < 0.06 * cone.mean()
    assert cone.mean() == pytest.approx(sphere.mean(), rel=0.06)
    assert 0.5 < cone.mean() < 0.9


@pytest.mark.parametrize("symmetric", [False, True])
def test_banded_solution_is_that_of_the_dense_system(symmetric):
    rng = np.random.default_rng(5)
    size, bandwidth = 12, 3
    near = np.abs(np.subtract.outer(np.arange(size), np.arange(size))) <= bandwidth
    matrix = np.where(near, rng.normal(size=(size, size)), 0.0) + 10.0 * np.eye(size)
    matrix = matrix + matrix.T if symmetric else matrix
    band = banded.allocate(size, bandwidth, symmetric)
    band[:] = 0.0
    diagonal = banded.diagonal(band, bandwidth)
    for i, j in zip(*np.nonzero(near), strict=True):
        if j <= i or not symmetric:
            band[j, diagonal + i - j] = matrix[i, j]
    right = rng.normal(size=(size, 2))
    assert banded.solve(band.copy(), bandwidth, right, True) == pytest.approx(np.linalg.solve(matrix, right))
    assert banded.solve(-band, bandwidth, right, True) is None


def test_a_body_that_hardly_changes_volume_slides_along_the_tip():
    """The depth is continuous in Poisson's ratio: towards 1/2 it goes on as it did before, the shear modulus kept.

    The pressure in such a body may be many times what shears it, and takes away much of the stiffness where an
    iteration is far from equilibrium.
    """
    up_and_down = trapezoid(1.0, 1.0, 0.0, 1.0, 8)
    low, middle, high = (
        depth(0.3, LAWS["elastic"].coefficients({"youngs_modulus": 2.0 * (1.0 + nu), "poisson_ratio": nu}),
              up_and_down, large=True)
        for nu in (0.48, 0.49, 0.4999)
    )  # fmt: skip
    assert high == pytest.approx(middle + 0.99 * (middle - low), abs=1e-3 * middle.max())
