"""Friction under a pyramid: its own law at every node, exact laws, bounds, and independent solutions."""

import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from palpate.materials import LAWS
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS as AXISYMMETRIC
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.friction_3d import Friction
from palpate.solver.pyramid.indent_3d import indent_3d
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specimen import Specimen
from studies.verification.cases.calculix_pyramid import depth_at_one
from studies.verification.reference_materials import BURGERS as EPOXY

pytestmark = pytest.mark.slow

COARSE = Resolution(growth=1.3, sectors=6, far=300.0)
COARSER = Resolution(growth=1.35, sectors=3, far=100.0)
CYCLE = Protocol(np.array([0.0, 10, 20, 30, 40]), np.array([0.0, 0.6, 0.1, 1.0, 0.01]), np.arange(2.0, 41.0, 2.0))
LOADING = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.linspace(0.2, 1.0, 9))
BURGERS = Specimen(LAWS["nonlinear_burgers"].coefficients(EPOXY))


def elastic(ratio):
    return Specimen(LAWS["elastic"].coefficients({"youngs_modulus": 3.28, "poisson_ratio": ratio}))


def pyramid(friction, face_angle=65.27):
    return Indenter("berkovich", face_angle=face_angle, friction=friction)


def depth(specimen, indenter, protocol=LOADING, resolution=COARSE):
    found = indent_3d(specimen, indenter, protocol, resolution)
    assert found.reason == ""
    return found.depth


def test_law_holds_at_every_node_and_dissipates():
    """|T| <= mu N, T against the slip, no pull, forces in balance with the load; loading, unloading, reloading."""
    mu, states, problems = 0.3, [], []

    def observe(problem, state):
        problems.append(problem)
        states.append(state)

    assert indent_3d(BURGERS, pyramid(mu), CYCLE, COARSE, observe=observe).reason == ""
    problem, total, slipped = problems[0], 0.0, 0
    mesh = problem.mesh
    slope = problem.tip(np.ones(1), np.zeros(1))[1][0, 0]
    for before, after in pairwise(states):
        contact = Contact3D.resume(problem, before, after)
        contact.follow(after.displacement.copy(), after.depth)
        along = contact.friction.along(contact.slope)
        pressing, force = contact.pressure(after.force), after.force[mesh.surface]
        touches = after.contact[mesh.surface] & (np.arange(len(mesh.surface)) > 0)
        normal = pressing * np.sqrt(1 + slope**2) / (1 + np.sum(along**2, axis=1))
        tangential = contact.friction.along(force[:, :2] + contact.slope * force[:, 2:])
        metric = np.eye(2) + along[:, :, None] * along[:, None, :]
        size = np.sqrt(np.einsum("ki,kij,kj->k", tangential, np.linalg.inv(metric), tangential))
        assert normal[touches].min() > -1e-7
        assert np.all(size[touches] <= mu * normal[touches] + 1e-6)
        load = float(CYCLE.load_at(np.array(after.time)))
        assert -6 * after.force[:, 2].sum() == pytest.approx(load, abs=1e-6)
        slip = (after.displacement - before.displacement)[mesh.surface, :2]
        work = -np.einsum("ki,ki->k", tangential, slip)
        held = touches & before.contact[mesh.surface]
        far = held & (contact.friction.size(slip / contact.friction.reach[:, None], contact.slope) > 2.0)
        assert np.all(work[far] >= -1e-12)
        total += work[held].sum()
        slipped += far.sum()
    assert total > 0.0
    assert slipped > 100


def test_the_apex_is_pressed_along_z_alone():
    """Both mirror planes hold it: what they bear is no pull of the indenter, however steep its faces are."""
    friction = Friction(0.0, np.ones(1), np.array([[False, False]]))
    np.testing.assert_array_equal(friction.along(np.array([[0.46, 0.2]])), 0.0)


def test_two_faces_hold_back_more_than_one_along_the_edge():
    """Two mirrored faces press with N each along their own normals and resist with mu N each along the edge."""
    slope, mu = np.array([[0.4, 0.0], [0.2, -0.3]]), 0.25
    friction = Friction(mu, np.ones(2), np.array([[True, True], [True, False]]))
    ratio, _ = friction.ratio(np.array([[5.0, 0.0], [5.0, 0.0]]), slope)
    edge = np.array([1.0, 0.0, slope[1, 0]]) / np.hypot(1.0, slope[1, 0])
    steep = np.sqrt(1 + slope[1] @ slope[1])
    normals = [np.array([slope[1, 0], sign * slope[1, 1], -1.0]) / steep for sign in (1, -1)]
    force = sum(normals) - 2 * mu * edge
    pressing = slope[1, 0] * force[0] - force[2]
    assert force[0] + slope[1, 0] * force[2] + ratio[1, 0] * pressing == pytest.approx(0.0)


def test_load_scaling():
    """h(t; kP) = sqrt(k) h(t; P): friction has no length."""
    one, other = (
        depth(BURGERS, pyramid(0.25), trapezoid(load, 30.0, 5.0, 30.0, points=16), COARSER) for load in (1.0, 2.7)
    )
    assert other == pytest.approx(np.sqrt(2.7) * one, rel=1e-3)


@pytest.mark.skipif(not shutil.which("ccx"), reason="CalculiX (ccx) is not installed")
def test_calculix_agrees_on_what_friction_does():
    """On meshes so coarse that they move the effect itself, 0.8 % of the depth, by a fifth of it."""
    program, law = Path(shutil.which("ccx")), {"youngs_modulus": 3.28, "poisson_ratio": 0.34}
    smooth, rough = (depth_at_one(program, pyramid(mu), law, 370.0, COARSER)[0] for mu in (0.0, 0.25))
    curves = [depth(elastic(0.34), pyramid(mu), resolution=COARSER) for mu in (0.0, 0.25)]
    assert np.mean(curves[1] / curves[0]) == pytest.approx(rough / smooth, abs=0.003)


def test_a_cone_is_held_back_as_in_the_axisymmetric_solver():
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0, points=30)
    cones = [Indenter("cone", 70.3, friction=mu) for mu in (0.0, 0.25)]
    loaded = protocol.sample_load > 0.1
    slick, rough = (depth(BURGERS, cone, protocol)[loaded] for cone in cones)
    histories = indent_batch([Case(BURGERS, cone, protocol, AXISYMMETRIC["standard"]) for cone in cones])
    other, expected = (history.depth[loaded] for history in histories)
    assert rough / slick == pytest.approx(expected / other, abs=0.004)


@pytest.mark.parametrize("ratio", [0.0, 0.34])
def test_a_shallow_pyramid_stays_below_full_stick(ratio):
    """Contact without slip is stiffer by (1 - nu) ln(3 - 4 nu) / (1 - 2 nu) (Mossakovskii, PMM 18 (1954) 187-196)."""
    bound = (1 - ratio) * np.log(3 - 4 * ratio) / (1 - 2 * ratio)
    gains = [
        float(np.mean((depth(elastic(ratio), pyramid(0.0, 88.0)) / depth(elastic(ratio), pyramid(mu, 88.0))) ** 2))
        for mu in (0.1, 0.5)
    ]
    assert 1.0 < gains[0] < gains[1] < bound
