"""Elements and the contact in SIMD lanes against closed forms of a homogeneous body and finite differences."""

import numpy as np
import pytest
from bodies import beneath, square
from kernels import contact_forces, fit, from_python, no_coupling

from palpate.materials import LAWS, law_of
from palpate.materials.flow.row import BACK_STRESS, BULK, SHEAR, step_weights
from palpate.solver.axisymmetric import element, hencky
from palpate.solver.axisymmetric.bordered import System
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.law_lanes import Points
from palpate.solver.axisymmetric.march_cases import begun, padded
from palpate.solver.axisymmetric.mesh import Resolution, polar_mesh
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS, HOOKE

ELASTIC = LAWS["elastic"].coefficients(HOOKE)
COARSE = Resolution(growth=1.5, sectors=3)
CREEP = LAWS["nonlinear_burgers"].coefficients(BURGERS)
PLASTIC = {"yield_stress": 0.05, "hardening": 0.3}
YIELDING = LAWS["burgers_plasticity"].coefficients(BURGERS | PLASTIC)
BACKED = law_of("burgers_plasticity+kinematic_hardening").coefficients(BURGERS | PLASTIC | {"kinematic_modulus": 0.8})


def laws_and_weights(coefficients, dt=0.7):
    rows = np.repeat(coefficients[None, :, None], LANES, axis=2)
    return rows, step_weights(rows, dt, np.ones(LANES))


def forces_of(kernel, body, points, coefficients, displacement):
    """Return the internal forces (size, LANES)."""
    laws, weights = laws_and_weights(coefficients)
    forces = np.zeros_like(displacement)
    from_python(kernel.internal_forces)(body, points, laws, weights, displacement, forces)
    return forces[:-1]


def corner_forces(moved, coefficients=ELASTIC, radius=1e6):
    """Return the forces (4, 2) at the corners of a block that have moved (4, 2)."""
    body = Body.of(square(radius))
    points = Points.unloaded(4, 2)
    displacement = np.repeat(np.append(moved.ravel(), 0.0)[:, None], LANES, axis=1)
    return forces_of(hencky, body, points, coefficients, displacement)[:, 0].reshape(4, 2)


@pytest.mark.parametrize(("wide", "high"), [(1.0, 0.7), (1.2, 0.8), (0.9, 1.3), (0.8, 0.8)])
def test_true_stress_is_hookes_law_in_logarithmic_strain(wide, high):
    """F = diag(wide, high, 1): the force on a face is its present area times K ln J + 2 G (ln stretch - ln J / 3)."""
    nodes = square().nodes
    force = corner_forces((nodes - nodes[0]) * [wide - 1.0, high - 1.0])
    swelling = np.log(wide * high)
    around = 2 * np.pi * nodes[:, 0].mean()
    for stretch, face, found in ((high, wide, force[2:, 1].sum()), (wide, high, force[1:3, 0].sum())):
        stress = ELASTIC[BULK] * swelling + 2 * ELASTIC[SHEAR] * (np.log(stretch) - swelling / 3)
        assert found == pytest.approx(stress * face * around, rel=1e-5)


def test_large_strain_does_not_feel_a_rigid_rotation():
    """F = R U: the force of the rotated element is the rotated force, here for an element far from the axis."""
    nodes = square().nodes
    stretched = nodes + np.random.default_rng(1).normal(scale=0.05, size=(4, 2))
    turn = np.array([[np.cos(0.8), -np.sin(0.8)], [np.sin(0.8), np.cos(0.8)]])
    centre = nodes.mean(axis=0)
    force = corner_forces(stretched - nodes, CREEP)
    rotated = corner_forces(centre + (stretched - centre) @ turn.T - nodes, CREEP)
    assert rotated == pytest.approx(force @ turn.T, abs=1e-5 * np.abs(force).max())


@pytest.mark.parametrize("excess", [7.3e-9, 8.9e-9, 9.1e-9])
@pytest.mark.parametrize("angle", [0.1, 0.5, 1.2])
def test_an_element_that_shrinks_to_a_point_is_inside_out(angle, excess):
    """F = -excess Q with a rotation Q: its determinant is above zero, but all digits of its stretches are lost."""
    nodes = square(1.0).nodes
    turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = (nodes - nodes[0]) @ (-excess * turned - np.eye(2)).T + [1.0, 0.0]
    assert not np.any(np.isfinite(corner_forces(moved, radius=1.0)))


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("coefficients", [CREEP, YIELDING, BACKED], ids=["creep", "yield", "back stress"])
def test_stiffness_is_the_symmetric_part_of_the_derivative(large, coefficients):
    """By finite differences, at random displacements and histories; at small strains the derivative is symmetric."""
    rng = np.random.default_rng(3)
    body, kernel = Body.of(polar_mesh(np.array([0.5, 1.0, 1.6]), 3)), hencky if large else element
    points = Points.unloaded(len(body.volumes) * 4, 2, bool(coefficients[BACK_STRESS]))
    past = rng.normal(scale=0.01, size=points.past.shape[:2])
    past[:, 2] = -past[:, 0] - past[:, 1]
    points.past[:], points.alpha[:], points.back[:] = past[:, :, None], 0.01, 3.0 * past[: len(points.back), :, None]
    u, step = np.append(rng.normal(scale=0.03, size=body.size), 0.0), 1e-6

    def forces(at):
        return forces_of(kernel, body, points, coefficients, np.repeat(at[:, None], LANES, axis=1))[:, 0]

    units = step * np.eye(body.size + 1)[:-1]
    derivative = np.stack([(forces(u + unit) - forces(u - unit)) / (2 * step) for unit in units], axis=1)
    forces(u)
    band, laws = np.zeros((body.size * body.width + 1, LANES)), laws_and_weights(coefficients)
    if large:
        from_python(kernel.stiffness)(body, points, *laws, np.repeat(u[:, None], LANES, axis=1), np.ones(LANES), band)
    else:
        from_python(kernel.stiffness)(body, points, *laws, band)
    columns = band[:-1, 0].reshape(body.size, body.width)
    expected = 0.5 * (derivative + derivative.T)
    for i in range(body.size):
        for k in range(min(body.width, body.size - i)):
            assert columns[i, k] == pytest.approx(expected[i + k, i], abs=1e-5 * np.abs(expected).max())
    if not large:
        assert np.abs(derivative - derivative.T).max() < 1e-6 * np.abs(derivative).max()


@pytest.mark.parametrize("work", [0.0, 100.0])
@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("indenter", [Indenter("cone", 70.3), Indenter("sphere", radius=2000.0)])
def test_tangent_of_the_contact_is_its_derivative(indenter, friction, work):
    """By finite differences, at gaps of about the width of the contact, with nodes that stick and others that slip."""
    tip = Indenter(indenter.shape, indenter.half_angle, indenter.radius, friction=friction)
    specimen = Specimen(ELASTIC, adhesion=work)
    lanes = padded([Case(specimen, tip, trapezoid(1.0, 1.0, 0.0, 1.0), COARSE)])
    units = np.array([case.radii[0] for case in lanes])
    mesh = polar_mesh(lanes[0].radii / units[0], COARSE.sectors)
    body = Body.of(mesh)
    march, states = begun(lanes, lanes, mesh, body, units, System.of(body, friction == 0.0), 1e-9)
    contact, state, count = march.setup.contact, states.contact, len(body.distance)
    rng, depth = np.random.default_rng(2), np.full(LANES, 0.3)
    held = body.radial[1:]
    u = np.zeros((body.size + 1, LANES))
    u[held] = 1e-3 * rng.normal(size=(count - 1, 1))
    near = 16  # nodes; those farther out do not touch
    x = np.where(np.arange(count) < near, rng.uniform(-1.2, 1.2, count), -30.0)
    moved = np.append(0.0, u[held, 0])
    height = beneath(Profile.of(tip).in_units_of(units[0]), body.distance, moved, False)[0]
    fit(contact, state, np.full(LANES, 0.1), np.zeros(LANES, dtype=bool))
    width = contact.width[:, 0] * state.rise[0]
    u[body.vertical] = (x * width - depth[0] + height)[:, None]
    state.share[:], state.place[:] = 0.0, body.distance[:, None]
    slips = rng.uniform(-1.5, 1.5, (count, 1)) * contact.slip
    state.anchor[:] = body.distance[:, None] + moved[:, None] - slips
    state.share[::2] = 1.0

    bears, none = np.full(LANES, 0.1), np.zeros(LANES, dtype=bool)
    fit(contact, state, bears, none)

    def evaluate(displacement):
        forces, coupling = np.zeros((body.size + 1, LANES)), no_coupling(count)
        trial = states.trial._replace(displacement=displacement, depth=depth)
        contact_forces(march.setup, trial, forces, coupling)
        return forces[:, 0], coupling

    coupling = evaluate(u)[1]
    tangent = coupling.tangent[:, 0, :, 0]
    for k in range(1, near):
        r, z, scale = body.radial[k], body.vertical[k], np.abs(tangent[k]).max()
        for first, rows in ((0, r), (1, z)):
            step = 1e-5 * min(contact.slip[k, 0], width[k])
            up, down = u.copy(), u.copy()
            up[rows] += step
            down[rows] -= step
            change = (evaluate(up)[0] - evaluate(down)[0]) / (2 * step)
            assert change[[r, z]] == pytest.approx(tangent[k, [first, 2 + first]], abs=1e-5 * scale)
            step = 1e-3 * width[k]
            up[rows], down[rows] = u[rows] + step, u[rows] - step
            spread = (evaluate(up)[1].area - evaluate(down)[1].area)[0] / (2 * step)
            assert coupling.touching[k, first, 0] == pytest.approx(spread, abs=1e-4 * contact.area[k] / width[k])
    area = state.area.copy()
    by_area, step = coupling.by_area[:, :, 0].copy(), 1e-4 * area
    feedback = coupling.feedback[0]

    def at_area(changed):
        state.area[:] = changed
        fit(contact, state, bears, none)
        return evaluate(u)

    (higher, with_more), (lower, with_less) = at_area(area + step), at_area(area - step)
    change = (higher - lower) / (2 * step[0])
    expected = (with_more.area - with_less.area)[0] / (2 * step[0])
    assert feedback == pytest.approx(expected, rel=1e-3, abs=1e-4)
    assert by_area[:, 1] == pytest.approx(change[body.vertical], abs=1e-4 * np.abs(change).max())
    assert by_area[1:, 0] == pytest.approx(change[held], abs=1e-4 * np.abs(change).max())
