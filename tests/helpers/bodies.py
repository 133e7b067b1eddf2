"""Bodies of revolution as the solver passes through them, and the forces that their stresses bear."""

import numpy as np
from numba import njit

from palpate.solver.axisymmetric import assembly
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.fields import cauchy_stress, displacement_gradient
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch, run_lanes
from palpate.solver.axisymmetric.mesh import Mesh, _integration
from palpate.solver.axisymmetric.profile import Profile
from palpate.solver.variation import applied_to_body
from palpate.study.indenter import Indenter
from palpate.study.specimen import Specimen

CONE = Indenter("cone", 70.3)
STANDARD = RESOLUTIONS["standard"]


@njit
def internal_forces(setup, material, displacement, forces):
    """Write the internal forces, see `palpate.solver.axisymmetric.assembly`."""
    assembly.internal_forces(setup, material, displacement, forces)


@njit
def stiffness(setup, material, displacement, geometric, band):
    """Write the tangent, likewise."""
    assembly.stiffness(setup, material, displacement, geometric, band)


def depth(coefficients, protocol, resolution=STANDARD, indenter=CONE, large=False):
    """Return the simulated depths (n,) [nm] at the samples of a protocol."""
    (outcome,) = indent_batch([Case(Specimen(coefficients), indenter, protocol, resolution, large)])
    assert not outcome.reason
    return outcome.depth


def square(radius=1e6):
    """Return the mesh of a unit square far from the axis, none of whose nodes is held."""
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) + np.array([radius, 0.0])
    gradients, volumes = _integration(nodes[None])
    return Mesh(nodes, np.arange(4)[None], np.arange(8).reshape(4, 2), np.array([3, 2]), gradients, volumes)


def case_of(specification):
    """Return the indentation that a specification asks for."""
    solid = applied_to_body(specification)
    resolution, large = RESOLUTIONS[solid.accuracy], solid.kinematics == "large"
    return Case(solid.specimen, solid.indenter, solid.protocol, resolution, large)


def moments(case):
    """Return the body at the end of each time step."""
    found = []
    (history,) = run_lanes([case], observe=found.append)
    assert history.reason == ""
    return found


def internal_force(mesh, stress, displacement, large):
    """Return the force (n, 2) [mN] that the stresses ask for at the nodes, by the principle of virtual work.

    The displacements (n, 2) are in um; at large strains the body is the deformed one.
    """
    gradient, hoop = displacement_gradient(mesh, displacement)
    if not large:
        gradient, hoop = 0 * gradient, 0 * hoop
    deformation = np.eye(2) + gradient
    shape = np.einsum("egja,egji->egia", mesh.gradients[:, :, :2], np.linalg.inv(deformation))
    around = mesh.gradients[:, :, 2] / (1.0 + hoop)[..., None]
    weights = mesh.weights * np.linalg.det(deformation) * (1.0 + hoop)
    rr, zz, tt, rz = np.moveaxis(stress, -1, 0)[..., None]
    along_r = np.einsum("eg,ega->ea", weights, rr * shape[:, :, 0] + rz * shape[:, :, 1] + tt * around)
    along_z = np.einsum("eg,ega->ea", weights, rz * shape[:, :, 0] + zz * shape[:, :, 1])
    force = np.zeros((len(mesh.nodes), 2))
    np.add.at(force, mesh.elements, np.stack([along_r, along_z], axis=-1))
    return force


def beneath(profile, r, moved, large):
    """Return f and df/dr over nodes that `moved` outwards from `r`; at small strains f(r + u) = f(r) + f'(r) u."""
    height, slope, _ = profile(r + moved if large else r)
    return height if large else height + slope * moved, slope


def on_surface(moment, indenter):
    """Return what the tip does to the nodes of the surface off the axis.

    Returns
    -------
    nodes : ndarray of int, shape (k,)
    gap : ndarray, shape (k,)
        Along z, negative inside the tip [um].
    normal, tangential : ndarray, shape (k,)
        sqrt(1 + f'^2) times the pressing force, and the force along the generator, outwards [mN].
    """
    nodes = moment.mesh.surface[1:]
    r, moved = moment.mesh.nodes[nodes, 0], moment.displacement[nodes, 0]
    height, slope = beneath(Profile.of(indenter), r, moved, moment.large)
    force = internal_force(moment.mesh, cauchy_stress(moment), moment.displacement, moment.large)
    radial, vertical = force[nodes].T
    gap = height - moment.depth - moment.displacement[nodes, 1]
    return nodes, gap, slope * radial - vertical, radial + slope * vertical
