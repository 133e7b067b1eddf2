"""Adhesion against Johnson, Kendall & Roberts, Maugis & Barquins, and exact laws."""

import jkr
import numpy as np
import pytest
from bodies import beneath, on_surface
from kernels import penetration, width_of

from palpate.analytic import hertz
from palpate.materials import LAWS
from palpate.solver.axisymmetric import adhesive_traction, march_cases
from palpate.solver.axisymmetric.adhesive_traction import attraction, nodal_areas
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specimen import Specimen

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
PULL = 0.27  # of the mean pressure, which a node that does not touch may be pulled with: C max(-x Phi(x) - b phi(x))
DEEPEST = 0.6  # of the width over which a gap closes, that a node lies inside the tip at most


def depth(work, indenter=SPHERE, accuracy="fine", coefficients=ELASTIC, protocol=TEST, **options):
    case = Case(Specimen(coefficients, adhesion=work), indenter, protocol, RESOLUTIONS[accuracy], **options)
    (outcome,) = indent_batch([case])
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
    exact = jkr.AdhesiveContact.sphere(E, NU, SPHERE.radius, work).depth(load)
    found = depth(work)[loaded]
    assert found == pytest.approx(exact, rel=0.02)
    gain = exact - hertz.depth(load, E, NU, SPHERE.radius)
    assert np.linalg.norm(found - plain[loaded] - gain) < 0.15 * np.linalg.norm(gain)


def test_sphere_clings_at_zero_load_as_jkr_say():
    """Where the base model has come out altogether; the finite range still counts there."""
    exact = jkr.AdhesiveContact.sphere(E, NU, SPHERE.radius, 200.0).depth(0.0)
    assert depth(200.0)[-1] == pytest.approx(float(exact), rel=0.07)


@pytest.mark.parametrize("accuracy", ["standard", "fine"])
@pytest.mark.parametrize(("radius", "work", "load"), [(5e4, 300.0, 1e-3), (5e3, 500.0, 1e-3), (5e3, 100.0, 1e-4)])
def test_a_contact_that_adhesion_makes_is_resolved(radius, work, load, accuracy):
    """The load alone would make a contact a sixth as wide; a mesh for that sinks in by up to 84 % too far."""
    protocol = trapezoid(load, 30.0, 0.0, 30.0, points=10)
    exact = jkr.AdhesiveContact.sphere(E, NU, radius, work).depth(protocol.sample_load)
    assert depth(work, Indenter("sphere", radius=radius), accuracy, protocol=protocol) == pytest.approx(exact, rel=0.1)


def test_cone_sinks_in_as_maugis_and_barquins_say():
    exact = jkr.AdhesiveContact.cone(E, NU, FLAT_CONE.half_angle, 200.0).depth(TEST.sample_load[:-1])
    assert depth(200.0, FLAT_CONE)[:-1] == pytest.approx(exact, rel=0.02)


def test_only_the_work_counts(monkeypatch, plain):
    """A range of attraction sqrt(2) times shorter, over half the zone, gives the same curve."""
    long = depth(200.0)
    monkeypatch.setattr(adhesive_traction, "ZONE", 0.5 * adhesive_traction.ZONE)
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
@pytest.mark.parametrize("large", [False, True])
def test_law_holds_at_every_node(friction, large, monkeypatch):
    """No pull beyond sigma_0, no gap closed through, sigma(g) across those that are open; and balance with the load.

    The forces are those of the stress in the body. A gap closes over a width, see
    `palpate.solver.axisymmetric.contact`: beyond eight of them, as the step leaves it, the law holds as written, and
    nearer a node may be pulled by a little of what one in contact bears.
    """
    begun, kept, times, close = march_cases.begun, [], [], 2e-6
    specimen, tip = Specimen(BURGERS, adhesion=100.0), Indenter("sphere", radius=5e3, friction=friction)
    protocol = trapezoid(1.0, 10.0, 2.0, 10.0, points=24)
    case = Case(specimen, tip, protocol, RESOLUTIONS["standard"], large)

    def keeping(*arguments):
        kept[:] = begun(*arguments)
        return tuple(kept)

    def observe(moment):
        march, states = kept
        body, contact, state = march.setup.body, march.setup.contact, states.contact
        x = np.array([penetration(march.setup, states.trial, k, 0)[0] for k in range(1, len(body.radial))])
        width = np.array([width_of(contact, state, k, 0) for k in range(1, len(body.radial))])
        assert np.all(x < DEEPEST)
        nodes, gap, normal, tangential = on_surface(moment, tip)
        law = attraction(specimen, case.resolution, case.contacts[1], march.units[0] ** 2 * contact.area[1:])
        steep = (
            1.0 + beneath(Profile.of(tip), moment.mesh.nodes[nodes, 0], moment.displacement[nodes, 0], large)[1] ** 2
        )
        assert gap == pytest.approx(-march.units[0] * x * width, abs=1e-9)
        assert np.all(normal >= -steep * (law.hold + PULL * state.pressure[0] * law.area) - close)
        pressing = np.maximum(normal / steep + law.hold, 0.0)
        touching = x > 0.0
        assert np.all(np.abs(tangential / steep)[touching] <= friction * pressing[touching] + close)
        apart = x < -8.0
        pull = steep * law.area * law.traction(gap)
        assert normal[apart] == pytest.approx(-pull[apart], abs=close)
        assert tangential[apart] == pytest.approx(np.zeros(apart.sum()), abs=close)
        assert moment.load == pytest.approx(float(protocol.load_at(np.array(moment.time))), abs=close)
        times.append(moment.time)

    monkeypatch.setattr(march_cases, "begun", keeping)
    (history,) = march_cases.run_lanes([case], observe=observe)
    assert history.reason == ""
    assert times[-1] == 22.0


@pytest.mark.parametrize("key", ["nonlinear_burgers", "burgers_plasticity"])
def test_a_surface_that_jumps_into_contact_is_followed(key):
    """A small tip under a large work: contact spreads at no load, to a radius of many elements at once."""
    law = LAWS[key].coefficients(
        LAW | ({"yield_stress": 0.15, "hardening": 0.3} if key == "burgers_plasticity" else {})
    )
    tip, protocol = Indenter("sphere", radius=2e4), trapezoid(1.0, 30.0, 10.0, 30.0, points=28)
    sticky, dry = (depth(work, tip, "standard", law, protocol) for work in (500.0, 0.0))
    assert np.all(sticky[:12] > dry[:12])


def test_a_rest_before_the_load_changes_nothing():
    """Adhesion alone makes a contact that is finer than the mesh for the load under the lesser work."""
    works, later = (7.0, 50.0), 0.03
    rested = Protocol(np.array([0.0, later, 1.0 + later, 2.0 + later]), [0.0, 0.0, 1.0, 0.0], TEST.sample_time + later)
    cone = Indenter("cone", 70.3)
    for work in works:
        found, exact = (depth(work, cone, protocol=protocol) for protocol in (rested, TEST))
        assert found[:-1] == pytest.approx(exact[:-1], rel=2e-3), work


def test_areas_add_up_to_the_surface():
    r = np.array([0.0, 0.1, 0.3, 0.7])
    assert nodal_areas(r).sum() == pytest.approx(np.pi * r[-1] ** 2)


def test_pull_off_is_that_of_jkr():
    """The lowest point of the load over the contact radius is -(3/2) pi w R."""
    radii = np.linspace(0.01, 5.0, 20001)
    lowest = min(jkr.AdhesiveContact.sphere(E, NU, 1e5, 100.0).load(a) for a in radii)
    assert lowest == pytest.approx(-1.5 * np.pi * 1e-4 * 100.0, rel=1e-4)


def test_reloading_follows_the_first_loading():
    """Contact that grows, shrinks, and grows again ends on the curve of growth alone: the law has no memory."""
    protocol = Protocol(np.arange(4.0), np.array([0.0, 1.0, 0.2, 1.0]), np.array([1.0, 2.0, 3.0]))
    first, _, last = depth(100.0, accuracy="standard", protocol=protocol)
    assert last == pytest.approx(first, rel=1e-6)
