"""Adhesion in three dimensions: its own tangent, exact laws, and the axisymmetric solver on the same sphere."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.materials import LAWS
from palpate.solver.axisymmetric.adhesive_traction import Adhesion
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.drive import NO_LOAD
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.adhesion_3d import attract, nodal_areas
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.indent_3d import indent_3d
from palpate.solver.pyramid.mesh_3d import wedge_mesh
from palpate.solver.pyramid.problem_3d import Problem3D, State, Workspace
from palpate.solver.pyramid.shell import shell
from palpate.solver.pyramid.tip_3d import tip_of
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS, HOOKE

pytestmark = pytest.mark.slow

COARSE, FINER = Resolution(growth=1.2, sectors=6), Resolution(growth=1.12, sectors=6)
ELASTIC, EPOXY = LAWS["elastic"].coefficients(HOOKE), LAWS["nonlinear_burgers"].coefficients(BURGERS)
TEST = trapezoid(1.0, 10.0, 2.0, 10.0, points=20)


def test_areas_add_up_to_the_free_surface():
    """A sixth of a disc, but for its straight edges and the nodes that the mesh holds."""
    radii, sectors = 1.1 ** np.arange(30), 9
    chords = np.sinc(1 / (2 * sectors) / 1.5)
    inside = nodal_areas(wedge_mesh(radii, shell(sectors))).sum()
    assert np.pi / 6 * radii[-2] ** 2 * chords < inside < np.pi / 6 * radii[-1] ** 2


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("indenter", [Indenter("berkovich", face_angle=65.27), Indenter("sphere", radius=5e3)])
def test_stiffness_is_the_derivative_of_the_force(indenter, curved):
    mesh, rng = wedge_mesh(1.6 ** np.arange(4), shell(3)), np.random.default_rng(4)
    attraction = Adhesion(0.5, 0.2, nodal_areas(mesh))
    problem = Problem3D.of(mesh, tip_of(indenter), Specimen(ELASTIC), adhesion=attraction)
    state, work, free = State.initial(problem), Workspace.of(problem), mesh.equations >= 0

    def evaluate(x):
        displacement = np.zeros((len(mesh.nodes), 3))
        displacement[free] = x[:-1]
        contact = Contact3D.resume(problem, state, state)
        contact.large = curved
        contact.follow(displacement, x[-1])
        for array in (work.band, work.residual, work.border):
            array[:] = 0.0
        force = np.zeros((len(mesh.nodes), 3))
        corner = attract(attraction, contact, work, force, True)
        return np.append(work.residual, -force[:, 2].sum()), work.band.copy(), work.border.copy(), corner

    x = np.append(0.01 * rng.standard_normal(mesh.size), -0.05)
    direction = rng.standard_normal(len(x))
    _, band, border, corner = evaluate(x)
    matrix = np.zeros((len(x), len(x)))
    for j in range(mesh.size):
        rows = band[j, : mesh.size - j]
        matrix[j : j + len(rows), j] = rows
    matrix = np.tril(matrix) + np.tril(matrix, -1).T
    matrix[-1, :-1] = matrix[:-1, -1] = border
    matrix[-1, -1] = corner
    slope = (evaluate(x + 1e-6 * direction)[0] - evaluate(x - 1e-6 * direction)[0]) / 2e-6
    assert matrix @ direction == pytest.approx(slope, rel=1e-5, abs=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("large", [False, True])
def test_a_sphere_clings_as_in_the_axisymmetric_solver(friction, large):
    """What adhesion adds to the depth at the end of unloading, to 15 %.

    In three dimensions it falls with the size of the elements, from 5.1 to 4.7 nm on these two meshes: what counts is
    their linear extrapolation to none. The load ends at what stands for none in the axisymmetric solver.
    """
    sphere = Indenter("sphere", radius=5e3, friction=friction)
    bodies = [Specimen(EPOXY, adhesion=work) for work in (0.0, 100.0)]
    protocol = replace(TEST, knot_drive=np.append(TEST.knot_drive[:-1], NO_LOAD * TEST.max_load))
    coarse, finer = (
        clinging([indent_3d(body, sphere, protocol, mesh, large) for body in bodies]) for mesh in (COARSE, FINER)
    )
    cases = [Case(body, sphere, protocol, RESOLUTIONS["standard"], large) for body in bodies]
    sizes = (COARSE.growth - 1.0, FINER.growth - 1.0)
    limit = (sizes[0] * finer - sizes[1] * coarse) / (sizes[0] - sizes[1])
    assert limit == pytest.approx(clinging(indent_batch(cases)), rel=0.15)


def clinging(histories):
    """Return how much deeper the second of two ends [nm]."""
    dry, sticky = histories
    assert not dry.reason
    assert not sticky.reason
    return sticky.depth[-1] - dry.depth[-1]


@pytest.mark.parametrize("friction", [0.0, 0.25])
def test_work_scales_with_the_depth_of_a_pyramid(friction):
    """With the load fourfold and the work of adhesion doubled, depths double: the exact law of an energy per area."""
    pyramid = Indenter("berkovich", face_angle=65.27, friction=friction)
    one, other = (
        indent_3d(Specimen(EPOXY, adhesion=work), pyramid, trapezoid(load, 30.0, 5.0, 30.0, points=20), COARSE).depth
        for work, load in ((100.0, 1.0), (200.0, 4.0))
    )
    assert other == pytest.approx(2 * one, rel=1e-4)
