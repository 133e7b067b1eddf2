"""Attraction between the surface of the wedge and the indenter, by the law of the axisymmetric `adhesive_traction`.

A free node feels the potential  -A sigma_0 d exp(-g / d)  with its gap g = f(x + u_x, y + u_y) - depth - u_z and its
area A. Where the surface touches, the gap stays zero, so that the attraction does no work: there it only lets the
contact carry tension, and raises its friction (`palpate.solver.pyramid.contact_3d.Contact3D.pressure`).
"""

from __future__ import annotations

import numpy as np

from palpate.solver.axisymmetric.adhesive_traction import Adhesion
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.mesh_3d import FACES, Mesh3D
from palpate.solver.pyramid.problem_3d import Workspace

TRIANGLES = ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))  # of a facet, divided along one diagonal or the other


def attract(adhesion: Adhesion, contact: Contact3D, work: Workspace, force: np.ndarray, softening: bool) -> float:
    """Add the attraction of free nodes to the assembled system and to the `force` (n, 3) of the indenter on them.

    Parameters
    ----------
    adhesion
        Law of the attraction.
    contact
        Where the indenter touches.
    work
        The linear system; in and out.
    softening
        Keep the stiffness that decaying attraction takes away; without it the matrix stays positive definite.

    Returns
    -------
    float
        What it adds to the diagonal entry of the depth.
    """
    surface = contact.mesh.surface
    free = np.flatnonzero(~contact.touching[surface])
    nodes, equations = surface[free], contact.mesh.equations[surface[free]]
    pull = (adhesion.area * adhesion.traction(contact.gap))[free]
    stiffness = -pull / adhesion.reach * softening
    along = np.column_stack([contact.slope[free], np.full(len(free), -1.0)])
    first, mixed, second = contact.curvature[free].T
    bent = np.zeros((len(free), 3, 3))
    bent[:, :2, :2] = np.stack([np.stack([first, mixed], axis=-1), np.stack([mixed, second], axis=-1)], axis=1)
    tangent = stiffness[:, None, None] * along[:, :, None] * along[:, None, :] + pull[:, None, None] * bent
    force[nodes] = -pull[:, None] * along
    for i in range(3):
        moves = equations[:, i] >= 0
        at = equations[moves, i]
        work.residual[at] += (pull * along[:, i])[moves]
        work.border[at] -= (stiffness * along[:, i])[moves]
        for j in range(i + 1):
            both = moves & (equations[:, j] >= 0)
            work.band[equations[both, j], (equations[:, i] - equations[:, j])[both]] += tangent[both, i, j]
    return float(stiffness.sum())


def nodal_areas(mesh: Mesh3D) -> np.ndarray:
    """Return the undeformed area (k,) that belongs to each surface node of the wedge [um^2].

    Each corner of a triangle gets a third of it; a facet is the mean of its two divisions into triangles.
    """
    flat = mesh.nodes[:, 2] > -1e-9 * np.abs(mesh.nodes).max()
    areas = np.zeros(len(mesh.nodes))
    for face in FACES:
        facets = mesh.elements[:, face]
        facets = facets[flat[facets].all(axis=1)]
        for corners in TRIANGLES:
            triangles = facets[:, corners]
            one, other, third = mesh.nodes[triangles, :2].transpose(1, 0, 2)
            (a, b), (c, d) = (other - one).T, (third - one).T
            twice = np.abs(a * d - b * c)
            np.add.at(areas, triangles, 0.5 * twice[:, None] / 6.0)
    return areas[mesh.surface]
