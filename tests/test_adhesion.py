"""Adhesion against Johnson, Kendall & Roberts, Maugis & Barquins, exact laws, and its own tangent."""

import numpy as np
import pytest

from palpate.analytic import hertz, jkr
from palpate.fem import adhesion, banded
from palpate.fem.adhesion import Adhesion, nodal_areas
from palpate.fem.contact import Contact
from palpate.fem.discretisation import RESOLUTIONS
from palpate.fem.indent import indent
from palpate.fem.mesh import polar_mesh
from palpate.fem.newton import Problem, State, Workspace
from palpate.fem.profile import Profile
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.protocol import Protocol, trapezoid
from palpate.specimen import Specimen

E, NU = 3.28, 0.34
ELASTIC = LAWS["elastic"].coefficients({"youngs_modulus": E, "poisson_ratio": NU})
LAW = {
    "youngs_modulus": E,
    "poisson_ratio": NU,
    "steady_coefficient": 0.09,
    "steady_exponent": 0.20,
    "transient_coefficient": 0.24,
    "transient_exponent": 0.47,
    "retardation_time": 0.25,
}
BURGERS = LAWS["nonlinear_burgers"].coefficients(LAW)
SPHERE, FLAT_CONE = Indenter("sphere", radius=1e5), Indenter("cone", 85.0)
TEST = trapezoid(1.0, 1.0, 0.0, 1.0, points=40)


def depth(work, indenter=SPHERE, accuracy="fine", coefficients=ELASTIC, protocol=TEST, **options):
    outcome = indent(Specimen(coefficients, adhesion=work), indenter, protocol, RESOLUTIONS[accuracy], **options)
    assert not outcome.reason
    return outcome.depth


@pytest.fixture(scope="module")
def plain():
    return depth(0.0)


@pytest.mark.parametrize("work", [50.0, 200.0])
def test_sphere_sinks_in_as_jkr_say(work, plain):
    """Depth to 2 % above a tenth of the load; what adhesion adds, a small difference of depths, to 15 %."""
    loaded = TEST.sample_load > 0.1
    load = TEST.sample_load[loaded]
    exact = jkr.Contact.sphere(E, NU, SPHERE.radius, work).depth(load)
    found = depth(work)[loaded]
    assert found == pytest.approx(exact, rel=0.02)
    gain = exact - hertz.depth(load, E, NU, SPHERE.radius)
    assert np.linalg.norm(found - plain[loaded] - gain) < 0.15 * np.linalg.norm(gain)


def test_sphere_clings_at_zero_load_as_jkr_say():
    """Where the base model has come out altogether; the finite range still counts there."""
    exact = jkr.Contact.sphere(E, NU, SPHERE.radius, 200.0).depth(0.0)
    assert depth(200.0)[-1] == pytest.approx(float(exact), rel=0.07)


@pytest.mark.parametrize("accuracy", ["standard", "fine"])
@pytest.mark.parametrize(("radius", "work", "load"), [(5e4, 300.0, 1e-3), (5e3, 500.0, 1e-3), (5e3, 100.0, 1e-4)])
def test_a_contact_that_adhesion_makes_is_resolved(radius, work, load, accuracy):
    """The load alone would make a contact a sixth as wide; a mesh for that sinks in by up to 84 % too far."""
    protocol = trapezoid(load, 30.0, 0.0, 30.0, points=10)
    exact = jkr.Contact.sphere(E, NU, radius, work).depth(protocol.sample_load)
    assert depth(work, Indenter("sphere", radius=radius), accuracy, protocol=protocol) == pytest.approx(exact, rel=0.1)


def test_cone_sinks_in_as_maugis_and_barquins_say():
    exact = jkr.Contact.cone(E, NU, FLAT_CONE.half_angle, 200.0).depth(TEST.sample_load[:-1])
    assert depth(200.0, FLAT_CONE)[:-1] == pytest.approx(exact, rel=0.02)


def test_only_the_work_counts(monkeypatch, plain):
    """A range of attraction sqrt(2) times shorter, over half the zone, gives the same curve."""
    long = depth(200.0)
    monkeypatch.setattr(adhesion, "ZONE", 0.5 * adhesion.ZONE)
    loaded = TEST.sample_load > 0.1
    short = depth(200.0)
    assert np.linalg.norm((short - long)[loaded]) < 0.05 * np.linalg.norm((long - plain)[loaded])


@pytest.mark.parametrize("friction", [0.0, 0.25])
@pytest.mark.parametrize("large", [False, True])
def test_work_scales_with_the_depth(friction, large):
    """With the load fourfold and the work of adhesion doubled, depths double: the exact law of an energy per area."""
    cone = Indenter("cone", 70.3, friction=friction)
    one, other = (
        depth(work, cone, "standard", BURGERS, trapezoid(load, 30.0, 5.0, 30.0, points=20), large=large)
        for work, load in ((100.0, 1.0), (200.0, 4.0))
    )
    assert other == pytest.approx(2 * one, rel=1e-4)


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("indenter", [Indenter("cone", 70.3), Indenter("sphere", radius=2000.0)])
def test_stiffness_is_the_derivative_of_the_force(friction, indenter):
    """By finite differences, at random displacements, with nodes in contact that stick or slip, and with others."""
    rng = np.random.default_rng(2)
    mesh = polar_mesh(np.array([0.05, 0.1, 0.2, 0.4, 0.6]), 3)
    profile = Profile.of(indenter)
    law = np.zeros(len(mesh.elements), dtype=np.int64)
    attraction = Adhesion.of(100.0, 4.0, 0.02, nodal_areas(mesh.nodes[mesh.surface, 0]))
    problem = Problem(mesh, profile, Specimen(ELASTIC), ELASTIC[None], law, False, friction, attraction)
    state, work = State.initial(problem), Workspace.of(problem)
    diagonal = banded.diagonal(work.band, mesh.bandwidth)
    touching = np.zeros(len(mesh.nodes), dtype=bool)
    touching[mesh.surface[:3]] = True
    free = mesh.equations >= 0

    def evaluate(x):
        displacement = np.zeros((len(mesh.nodes), 2))
        displacement[free] = x[:-1]
        contact = Contact.resume(mesh, profile, friction, problem.hold, problem.large, state, state)
        contact.touching[:] = touching
        contact.anchor[:] = contact.r
        contact.anchor[1:3] += 1e-6, -1e-2
        contact.follow(displacement.copy(), x[-1])
        for array in (work.band, work.residual, work.border):
            array[:] = 0.0
        force = np.zeros((len(mesh.nodes), 2))
        corner = attraction.add(contact, mesh, displacement, x[-1], work, diagonal, force, True)
        return np.append(work.residual, -force[:, 1].sum()), work.band.copy(), work.border.copy(), corner

    x = np.append(rng.normal(scale=1e-6, size=mesh.size), 0.0)
    _, band, border, corner = evaluate(x)
    numerical = np.array([(evaluate(x + e)[0] - evaluate(x - e)[0]) / 2e-8 for e in 1e-8 * np.eye(len(x))]).T
    stiffness = np.zeros_like(numerical)
    for j in range(mesh.size):
        for i in range(mesh.size):
            if abs(i - j) <= 1:
                lower = diagonal == 0 and i < j
                stiffness[i, j] = band[i, j - i] if lower else band[j, diagonal + i - j]
    stiffness[:-1, -1], stiffness[-1, :-1], stiffness[-1, -1] = border[:, 0], border[:, 1], corner
    assert numerical == pytest.approx(stiffness, abs=1e-6 * np.abs(stiffness).max())


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("large", [False, True])
def test_law_holds_at_every_node(friction, large):
    """No pull beyond sigma_0, no gap closed through, sigma(g) across those that are open; and balance with the load."""
    states = []
    specimen, indenter = Specimen(BURGERS, adhesion=100.0), Indenter("sphere", radius=5e3, friction=friction)
    protocol = trapezoid(1.0, 10.0, 2.0, 10.0, points=24)
    indent(specimen, indenter, protocol, RESOLUTIONS["standard"], large, observe=lambda *found: states.append(found))
    assert states[-1][1].time == 22.0
    for problem, state in states:
        surface, attraction = problem.mesh.surface[:-1], problem.adhesion
        height, slope, _ = problem.profile.beneath(
            problem.mesh.nodes[surface, 0], state.displacement[surface, 0], large
        )
        gap = height - state.depth - state.displacement[surface, 1]
        radial, vertical = state.force[surface].T
        touching = state.contact[surface]
        pressure = slope * radial - vertical + (1 + slope**2) * attraction.hold[:-1]
        assert np.all(pressure[1:][touching[1:]] > -2e-7)
        assert np.all(gap > -1e-8 * state.depth)
        open_ = ~touching
        assert vertical[open_] == pytest.approx((attraction.area[:-1] * attraction.traction(gap))[open_], rel=1e-9)
        assert radial[open_] == pytest.approx(-(slope * vertical)[open_], rel=1e-9)
        assert -state.force[:, 1].sum() == pytest.approx(float(protocol.load_at(np.array(state.time))), abs=2e-7)


@pytest.mark.parametrize("key", ["nonlinear_burgers", "burgers_plasticity"])
def test_a_surface_that_jumps_into_contact_is_followed(key):
    """A small tip under a large work: contact spreads at no load, to a radius of many elements at once."""
    law = LAWS[key].coefficients(
        LAW | ({"yield_stress": 0.15, "hardening": 0.3} if key == "burgers_plasticity" else {})
    )
    tip, protocol = Indenter("sphere", radius=2e4), trapezoid(1.0, 30.0, 10.0, 30.0, points=28)
    sticky, dry = (depth(work, tip, "standard", law, protocol) for work in (500.0, 0.0))
    assert np.all(sticky[:12] > dry[:12])


def test_areas_add_up_to_the_surface():
    r = np.array([0.0, 0.1, 0.3, 0.7])
    assert nodal_areas(r).sum() == pytest.approx(np.pi * r[-1] ** 2)


def test_pull_off_is_that_of_jkr():
    """The lowest point of the load over the contact radius is -(3/2) pi w R."""
    radii = np.linspace(0.01, 5.0, 20001)
    lowest = min(jkr.Contact.sphere(E, NU, 1e5, 100.0).load(a) for a in radii)
    assert lowest == pytest.approx(-1.5 * np.pi * 1e-4 * 100.0, rel=1e-4)


def test_reloading_follows_the_first_loading():
    """Contact that grows, shrinks, and grows again ends on the curve of growth alone: the law has no memory."""
    protocol = Protocol(np.arange(4.0), np.array([0.0, 1.0, 0.2, 1.0]), np.array([1.0, 2.0, 3.0]))
    first, _, last = depth(100.0, accuracy="standard", protocol=protocol)
    assert last == pytest.approx(first, rel=1e-6)
