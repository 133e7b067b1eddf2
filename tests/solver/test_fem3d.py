"""The solver in three dimensions: exact states, the tangent, and the axisymmetric solver on the same indenters."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kernels import hexahedron_at_large_strains, linear_hexahedron
from scipy.linalg import logm, polar

from palpate.analytic import sneddon
from palpate.materials import LAWS
from palpate.materials.flow.point import commit, history, state_size
from palpate.materials.flow.row import BULK, SHEAR, step_weights
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS as AXISYMMETRIC
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.coupled import Coupling3D
from palpate.solver.pyramid.element_3d import Hexahedra, Laws3D, System3D, Touching, assemble
from palpate.solver.pyramid.indent_3d import indent_3d
from palpate.solver.pyramid.linear_3d import Points3D
from palpate.solver.pyramid.mesh_3d import CORNERS, integration, wedge_mesh
from palpate.solver.pyramid.problem_3d import Problem3D, State, Workspace
from palpate.solver.pyramid.shell import WEDGE, shell
from palpate.solver.pyramid.tip_3d import tip_of
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specimen import Specimen, elastic_substrate
from studies.verification.cases.calculix_pyramid import depth_at_one
from studies.verification.cases.pyramid_checks import contact_area
from studies.verification.reference_materials import BURGERS, HOOKE

COARSE = Resolution(growth=1.2, sectors=6)
PYRAMID, CONE = Indenter("berkovich", face_angle=65.27), Indenter("cone", 70.3)
ROUNDED = replace(PYRAMID, radius=2e3)
FACE = tip_of(PYRAMID)
LOADING = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.linspace(0.1, 1.0, 19))


def elastic(ratio):
    return LAWS["elastic"].coefficients({"youngs_modulus": 3.28, "poisson_ratio": ratio})


def posed(mesh, law, tip=FACE, friction=0.0, touching=(), large=False):
    """Return a problem and its unloaded state, with nodes that touch all the same."""
    problem = Problem3D.of(mesh, tip, Specimen(law), friction, large)
    return problem, replace(State.initial(problem), contact=np.isin(np.arange(len(mesh.nodes)), touching))


def assembled(problem, state, displacement, depth=0.0, step=0.3, curved=False):
    """Return residual, the lower half of the tangent as a full matrix, border, corner, force, and what friction adds.

    That is a matrix too, one row and column longer, or none. `curved` takes the tip as large strains do.
    """
    mesh, laws = problem.mesh, problem.coefficients
    work, contact = Workspace.of(problem), Contact3D.resume(problem, state, state)
    contact.large = curved
    contact.follow(displacement, depth)
    work.past[:], work.back[:], work.alpha[:] = 0.0, 0.0, 0.0
    force, guesses = np.empty((len(mesh.nodes), 3)), np.zeros((len(mesh.elements), 8))
    points = Points3D(work.past, work.back, work.alpha, guesses, work.local)
    system = System3D(work.band, work.residual, work.border, force, work.pressing, work.pressure)
    corner = assemble(
        displacement, Hexahedra.of(mesh), Laws3D(problem.region, laws, step_weights(laws, step)), points,
        Touching(contact.touching, contact.rule, work.slot), system, problem.large, True,
    )  # fmt: skip
    coupled = None
    if problem.friction > 0.0:
        assert contact.pressure(force)[contact.touching[mesh.surface]].min() > 0.0
        coupling = Coupling3D.add(contact, force, work.pressing, work.band, work.residual)
        coupled = np.stack([coupling.forces(coupling.pressed(unit)) for unit in np.eye(mesh.size + 1)], axis=1)
    full = np.zeros((mesh.size, mesh.size))
    for j in range(mesh.size):
        rows = work.band[j, : mesh.size - j]
        full[j : j + len(rows), j] = rows
    tangent = np.tril(full) + np.tril(full, -1).T
    return work.residual.copy(), tangent, work.border.copy(), corner, force, coupled


def along_axes(mesh, field):
    """Return displacements (n, 3) in x, y, z along the axes of each node."""
    cos, sin = mesh.turn.T
    x, y, z = field.T
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=1)


@pytest.mark.parametrize("sectors", [3, 6, 9])
def test_the_wedge_fills_a_sixth_of_the_half_ball(sectors):
    shells = shell(sectors)
    mesh = wedge_mesh(1.3 ** np.arange(8), shells)
    assert mesh.weights.min() > 0
    assert mesh.weights.sum() == pytest.approx(np.pi / 9 * 1.3**21, rel=1.1 / sectors**2)
    assert mesh.nodes[:, 1].min() == pytest.approx(0.0, abs=1e-12)
    assert np.max(mesh.nodes[:, :2] @ [-np.sin(WEDGE), np.cos(WEDGE)]) == pytest.approx(0.0, abs=1e-12)
    assert all(len(set(quad)) == 4 for quad in shells.quads)


@pytest.mark.parametrize("ratio", [0.0, 0.34, 0.4999])
def test_uniform_compression_is_exact(ratio):
    """The patch test: inside, and along the mirror planes, all forces vanish; the tip carries a third of its facets."""
    mesh, strain = wedge_mesh(1.3 ** np.arange(6), shell(6)), -0.01
    field = mesh.nodes * [-ratio * strain, -ratio * strain, strain]
    forces, free = np.zeros((len(mesh.nodes), 3)), mesh.equations >= 0
    forces[free] = assembled(*posed(mesh, elastic(ratio)), along_axes(mesh, field))[0]
    inside = np.ones(len(mesh.nodes), dtype=bool)
    inside[mesh.surface] = False
    assert np.abs(forces[inside]).max() < 1e-12
    assert np.abs(forces[:, :2]).max() < 1e-12
    x, y, _ = mesh.nodes[mesh.surface[1:6]].T
    facets = 0.5 * np.sin(np.diff(np.sort(np.arctan2(y, x)))).sum()
    assert forces[0, 2] == pytest.approx(3.28 * strain * facets / 3)


def test_one_constraint_an_element_at_incompressibility():
    """Mean dilatation leaves the hexahedron one volumetric mode; full integration would leave several."""
    rng = np.random.default_rng(3)
    corners = (CORNERS + 0.2 * rng.uniform(-1, 1, CORNERS.shape))[None]
    gradients, volumes = integration(corners)
    stiffness = []
    for bulk in (1e4, 2e4):
        row = elastic(0.3)
        row[1] = bulk
        ke, fe = np.zeros((25, 25)), np.zeros(25)
        points = Points3D(*np.zeros((2, 8, 6)), np.zeros(8), np.zeros(8), np.zeros((8, 6)))
        linear_hexahedron(
            gradients[0], volumes[0], np.zeros((8, 3)), points, (step_weights(row[None], 1.0)[0], row), ke, fe
        )
        stiffness.append(np.linalg.eigvalsh(ke[:24, :24]))
    assert np.sum(stiffness[1] > 1.5 * stiffness[0].clip(1e-6)) == 1
    assert np.sum(np.abs(stiffness[0]) < 1e-9) == 6


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("indenter", [PYRAMID, ROUNDED, CONE, Indenter("sphere", 0.0, 5e3)])
def test_the_tangent_is_the_derivative_of_the_residual(indenter, curved):
    mesh = wedge_mesh(1.6 ** np.arange(4), shell(3))
    law, tip = LAWS["nonlinear_burgers"].coefficients(BURGERS), tip_of(indenter)
    rng = np.random.default_rng(7)
    free = mesh.equations >= 0
    base, depth = np.zeros(free.shape), 0.3
    base[free] = 0.02 * rng.standard_normal(mesh.size)
    touching = mesh.surface[:4]
    base[mesh.surface[4:], 2] = -5.0
    direction = rng.standard_normal(mesh.size)
    check_tangent(*posed(mesh, law, tip, touching=touching), base, depth, direction, curved=curved)


def test_the_tangent_with_friction_is_the_derivative_of_the_residual():
    """Nodes stick and slip, inside, under the middle of the face and under the edge, where the mesh is turned."""
    mesh, rng, depth = wedge_mesh(1.6 ** np.arange(4), shell(3)), np.random.default_rng(11), 1.0
    surface, free = mesh.surface, mesh.equations >= 0
    base = np.zeros(free.shape)
    base[free] = 0.002 * rng.standard_normal(mesh.size)
    base[surface, 2] = np.minimum(0.0, FACE(*mesh.nodes[surface, :2].T)[0] - depth) - 0.01
    problem, state = posed(mesh, LAWS["nonlinear_burgers"].coefficients(BURGERS), FACE, 0.3, surface[:7])
    contact = Contact3D.resume(problem, state, state)
    way = contact.friction.reach[:, None] * rng.uniform(-1, 1, (len(surface), 2)) * (free[surface, :2])
    way[1::2] *= 4.0
    place = contact.place + base[surface, :2]
    state = replace(state, anchor=place - way)
    sizes = contact.friction.size(way / contact.friction.reach[:, None], FACE(*place.T)[1])[1:7]
    assert sizes.min() < 0.9 and sizes.max() > 1.1
    check_tangent(problem, state, base, depth, rng.standard_normal(mesh.size), part=1e-7)


def check_tangent(problem, state, base, depth, direction, change=0.7, part=1e-6, curved=False):
    """Compare the tangent with differences along a direction; nodes that do not touch stay at their height."""
    mesh = problem.mesh
    free, touching = mesh.equations >= 0, np.flatnonzero(state.contact)
    apart = np.setdiff1d(mesh.surface, touching)
    _, tangent, border, corner, _, coupled = assembled(problem, state, base.copy(), depth, curved=curved)
    direction[mesh.equations[mesh.surface, 2]] = 0.0
    moved = []
    for sign in (1, -1):
        there = base.copy()
        there[free] += sign * part * direction
        there[apart, 2] = base[apart, 2]
        found = assembled(problem, state, there, depth + sign * part * change, curved=curved)
        moved.append(np.append(found[0], -found[4][:, 2].sum()))
    expected = (moved[0] - moved[1]) / (2 * part)
    stiffness = np.append(tangent @ direction + border * change, border @ direction + corner * change)
    if coupled is not None:
        stiffness += coupled @ np.append(direction, change)
    assert stiffness == pytest.approx(expected, rel=1e-5, abs=1e-5 * np.abs(expected).max())


@pytest.fixture
def hexahedron():
    """Gradients, volumes and nodes of a skew hexahedron."""
    corners = 0.5 * CORNERS + 0.1 * np.random.default_rng(2).uniform(-1, 1, CORNERS.shape)
    gradients, volumes = integration(corners[None])
    return gradients[0], volumes[0], corners


def at_large_strains(hexahedron, u, law, past):
    """Return force and stiffness of one element, and the tensors R."""
    ke, fe, local = np.zeros((25, 25)), np.zeros(25), np.empty((8, 6))
    points, law = (
        Points3D(past, np.zeros((8, 6)), np.zeros(8), np.zeros(8), local),
        (step_weights(law[None], 1.0)[0], law),
    )
    assert np.isfinite(hexahedron_at_large_strains(*hexahedron[:2], u, points, law, ke, fe, True))
    return fe[:24], ke[:24, :24], local


@pytest.mark.parametrize("seed", range(4))
def test_true_stress_is_hookes_law_in_logarithmic_strain(hexahedron, seed):
    """Of a homogeneous F = R U with E = ln U, by matrix functions: what the forces do is the power J T : dE."""
    rng, law = np.random.default_rng(seed), elastic(0.34)
    deformation, change = np.eye(3) + 0.25 * rng.standard_normal((3, 3)), 1e-6 * rng.standard_normal((3, 3))
    strain, jacobian = logm(polar(deformation)[1]).real, np.linalg.det(deformation)
    deviator = strain - np.trace(strain) / 3 * np.eye(3)
    stress = law[BULK] * np.trace(strain) * np.eye(3) + 2 * law[SHEAR] * deviator
    _, volumes, nodes = hexahedron
    force, _, local = at_large_strains(hexahedron, nodes @ (deformation - np.eye(3)).T, law, np.zeros((8, 6)))
    rate = logm(polar(deformation + change)[1]).real - logm(polar(deformation - change)[1]).real
    assert 2 * force @ (nodes @ change.T).ravel() == pytest.approx(
        volumes.sum() * jacobian * np.sum(stress * rate), 1e-6
    )
    assert local[0, :3] == pytest.approx(np.diag(deviator), abs=1e-12)
    assert local[0, 3:] == pytest.approx([deviator[0, 1], deviator[1, 2], deviator[2, 0]], abs=1e-12)


@pytest.mark.parametrize("size", [0.2, 0.02, 1e-4])
def test_the_stiffness_at_large_strains_is_the_symmetric_part_of_the_derivative(hexahedron, size):
    """From stretches far apart to ones so close that their divided differences are series; with a past."""
    rng, law = np.random.default_rng(9), LAWS["nonlinear_burgers"].coefficients(BURGERS)
    u, past = size * rng.standard_normal((8, 3)), 0.1 * size * rng.standard_normal((8, 6))
    past[:, 2] = -past[:, 0] - past[:, 1]
    _, stiffness, _ = at_large_strains(hexahedron, u, law, past)
    step, columns = 1e-6 * size, []
    for unit in step * np.eye(24).reshape(24, 8, 3):
        ahead, behind = (at_large_strains(hexahedron, u + sign * unit, law, past)[0] for sign in (1, -1))
        columns.append((ahead - behind) / (2 * step))
    derivative = np.stack(columns, axis=1)
    expected = 0.5 * (derivative + derivative.T)
    assert stiffness == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def test_an_element_inside_out_is_noticed(hexahedron):
    law = elastic(0.3)
    points = Points3D(*np.zeros((2, 8, 6)), np.zeros(8), np.zeros(8), np.empty((8, 6)))
    law = step_weights(law[None], 1.0)[0], law
    mirrored = -2.0 * hexahedron[2] * [0.0, 0.0, 1.0]
    assert np.isnan(
        hexahedron_at_large_strains(*hexahedron[:2], mirrored, points, law, np.zeros((25, 25)), np.zeros(25), True)
    )


def test_the_law_does_not_see_the_axes():
    """A history of tensors with six components is that of their rotated copies, rotated."""
    law, rng = LAWS["nonlinear_burgers"].coefficients(BURGERS), np.random.default_rng(5)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))

    def packed(tensor):
        return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[1, 2], tensor[2, 0]])

    states = [np.zeros(state_size(law, 6)) for _ in range(2)]
    for _ in range(3):
        tensor = rng.standard_normal((3, 3))
        tensor = tensor + tensor.T - 2 * np.trace(tensor) / 3 * np.eye(3)
        rho = np.sqrt(0.5 * np.sum(tensor * tensor))
        for state, strain in zip(states, (tensor, turn @ tensor @ turn.T), strict=True):
            weights = step_weights(law[None], 0.2)[0]
            commit(state, packed(strain), np.zeros(6), 0.0, 0.8 * rho, 0.0, weights, law)
    past = np.empty((2, 6))
    for state, out in zip(states, past, strict=True):
        history(state, step_weights(law[None], 0.2)[0], law, out, np.empty(6))
    xx, yy, zz, xy, yz, zx = past[0]
    rotated = turn @ np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) @ turn.T
    assert past[1] == pytest.approx(packed(rotated))


@pytest.mark.parametrize("ratio", [0.2, 0.4999])
def test_a_shallow_cone_is_sneddons(ratio):
    """Within what so coarse a mesh costs, incompressible or not: nothing locks."""
    found = indent_3d(Specimen(elastic(ratio)), Indenter("cone", 89.0), LOADING, COARSE)
    exact = sneddon.depth(LOADING.sample_load, 3.28, ratio, 89.0)
    assert found.reason == ""
    assert found.depth == pytest.approx(exact, rel=0.02)


def test_a_cone_creeps_as_in_the_axisymmetric_solver():
    protocol = trapezoid(1.0, 30.0, 10.0, 30.0, points=30)
    specimen = Specimen(LAWS["nonlinear_burgers"].coefficients(BURGERS))
    found = indent_3d(specimen, CONE, protocol, COARSE)
    (expected,) = indent_batch([Case(specimen, CONE, protocol, AXISYMMETRIC["fine"])])
    loaded = protocol.sample_load > 0.1
    assert found.depth[loaded] == pytest.approx(expected.depth[loaded], rel=0.012)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_large_strains_change_what_they_change_in_the_axisymmetric_solver(friction):
    """Ratios to small strains, 0.977 at peak and 0.990 with friction, but for the ripple of the coarse mesh."""
    protocol = trapezoid(1.0, 30.0, 10.0, 30.0, points=12)
    specimen = Specimen(LAWS["nonlinear_burgers"].coefficients(BURGERS))
    cone, loaded = replace(CONE, friction=friction), protocol.sample_load > 0.1
    small, large = (indent_3d(specimen, cone, protocol, COARSE, large).depth[loaded] for large in (False, True))
    cases = [Case(specimen, cone, protocol, AXISYMMETRIC["standard"], large) for large in (False, True)]
    flat, curved = (history.depth[loaded] for history in indent_batch(cases))
    assert large / small == pytest.approx(curved / flat, abs=0.005)


def test_a_film_is_pressed_as_in_the_axisymmetric_solver():
    """On a stiff substrate, under the same cone: depths over those without, in which most of the mesh's error drops."""
    film = elastic(0.34)
    specimen = Specimen(film, 2000.0, elastic_substrate(film, 70.0))
    alone, found = (indent_3d(body, CONE, LOADING, COARSE) for body in (Specimen(film), specimen))
    cases = [Case(body, CONE, LOADING, AXISYMMETRIC["fine"]) for body in (Specimen(film), specimen)]
    bare, pressed = (history.depth for history in indent_batch(cases))
    assert found.depth / alone.depth == pytest.approx(pressed / bare, abs=0.01)
    assert found.depth[-1] < 0.95 * alone.depth[-1]


def test_a_sphere_presses_as_in_the_axisymmetric_solver():
    specimen, sphere = Specimen(elastic(0.34)), Indenter("sphere", 0.0, 5e3)
    found = indent_3d(specimen, sphere, LOADING, COARSE)
    (expected,) = indent_batch([Case(specimen, sphere, LOADING, AXISYMMETRIC["fine"])])
    assert found.depth == pytest.approx(expected.depth, rel=0.015)


def test_a_rounded_pyramid_is_what_a_ball_reaches():
    """Its height is the lowest that a ball gets to, with its centre anywhere within the sharp pyramid."""
    radius, rng = 0.2, np.random.default_rng(6)
    slope, sharp = PYRAMID.face_slope, [np.array([np.cos(a), np.sin(a)]) for a in (0.0, 2 * WEDGE, -2 * WEDGE)]
    distance, angle = 0.5 * np.sqrt(rng.random(60)), WEDGE * rng.random(60)
    place = np.stack([distance * np.cos(angle), distance * np.sin(angle)], axis=-1)
    centres = np.stack(np.meshgrid(*[np.linspace(-0.7, 0.7, 561)] * 2), axis=-1).reshape(-1, 2)
    bottoms = slope * np.max([centres @ normal for normal in sharp], axis=0) + radius
    found, gradient, _ = tip_of(replace(PYRAMID, radius=1e3 * radius))(*place.T)
    for i, point in enumerate(place):
        within = radius**2 - np.sum((centres - point) ** 2, axis=1)
        expected = (bottoms - np.sqrt(np.maximum(within, 0.0)))[within > 0].min()
        assert found[i] == pytest.approx(expected, abs=2e-4)
    moved = tip_of(replace(PYRAMID, radius=1e3 * radius))(*(place + 1e-6).T)[0]
    assert moved - found == pytest.approx(1e-6 * gradient.sum(axis=1), abs=1e-11)


def test_a_pyramid_rounded_beyond_the_contact_is_a_sphere():
    ball = indent_3d(Specimen(elastic(0.34)), replace(PYRAMID, radius=2e4), LOADING, COARSE)
    sphere = indent_3d(Specimen(elastic(0.34)), Indenter("sphere", radius=2e4), LOADING, COARSE)
    assert ball.depth == pytest.approx(sphere.depth, rel=1e-3)


def test_a_pyramid_has_no_length():
    """Depth grows as the root of the load, though the contact grows from node to node."""
    found = indent_3d(Specimen(elastic(0.34)), PYRAMID, LOADING, COARSE)
    ratio = found.depth / np.sqrt(LOADING.sample_load)
    assert ratio == pytest.approx(np.full(len(ratio), ratio.mean()), rel=0.004)


def test_the_contact_area_of_whole_shells_is_a_disc():
    radii = 1.3 ** np.arange(6)
    mesh = wedge_mesh(radii, shell(6))
    inside = np.linalg.norm(mesh.nodes, axis=1) < 1.3**2.5
    area = contact_area(mesh, np.zeros_like(mesh.nodes), inside & np.isin(np.arange(len(mesh.nodes)), mesh.surface))
    assert area == pytest.approx(np.pi * radii[2] * radii[3])


@pytest.mark.skipif(not shutil.which("ccx"), reason="CalculiX (ccx) is not installed")
def test_calculix_agrees_on_the_pyramid():
    """Both on coarse meshes, which cost two or three per cent of the depth."""
    mesh = Resolution(growth=1.35, sectors=3, far=100.0)
    theirs, scatter = depth_at_one(Path(shutil.which("ccx")), PYRAMID, HOOKE, 370.0, mesh)
    ours = indent_3d(Specimen(elastic(0.34)), PYRAMID, LOADING, COARSE).depth[-1]
    assert scatter < 0.01
    assert ours == pytest.approx(theirs, rel=0.025)
