"""Eight-node hexahedra in one sixth of the half-space: shells about the tip whose radii grow geometrically.

The radii are those of the axisymmetric mesh (`palpate.solver.axisymmetric.mesh.ring_radii`) and serve the same end: a
sharp tip has no length, so every contact of a loading history should meet the same mesh but for its scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.mesh import Numbered
from palpate.solver.pyramid.shell import WEDGE, Shell

FACES = ((0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7))  # of a hexahedron
SAMPLES = 6  # along each edge of an element that an interface may cut
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])


@dataclass(frozen=True, eq=False)
class Mesh3D(Numbered):
    """Hexahedra with everything that does not change during a simulation.

    A node has three displacements: along two horizontal axes of its own and along z. Its own axes are turned from x and
    y where the mirror plane through an edge of the pyramid asks for it.

    Attributes
    ----------
    nodes : ndarray, shape (n, 3)
        Reference coordinates (x, y, z), z <= 0; the tip touches the first one.
    elements : ndarray of int, shape (m, 8)
    equations : ndarray of int, shape (n, 3)
        Equation of each displacement, -1 where it is held at zero.
    turn : ndarray, shape (n, 2)
        Cosine and sine of the angle by which a node's axes are turned about z.
    surface : ndarray of int, shape (k,)
        Nodes of the free surface less the outermost, the tip first.
    gradients : ndarray, shape (m, 8, 8, 3)
        Gradients of the eight shape functions at each Gauss point.
    weights : ndarray, shape (m, 8)
        Volume of each Gauss point.
    bandwidth : int
        Half bandwidth of the stiffness matrix.
    """

    nodes: np.ndarray
    elements: np.ndarray
    equations: np.ndarray
    turn: np.ndarray
    surface: np.ndarray
    gradients: np.ndarray
    weights: np.ndarray
    bandwidth: int

    def share_above(self, height: float) -> np.ndarray:
        """Return the share (m,) of each element's volume above z = `height` [um], by `SAMPLES`^3 samples.

        Each sample represents a cell whose height counts, so that the share varies continuously.
        """
        ticks, corners = 2.0 * (np.arange(SAMPLES) + 0.5) / SAMPLES - 1.0, self.nodes[self.elements]
        places = np.stack(np.meshgrid(ticks, ticks, ticks), axis=-1).reshape(-1, 3)
        above, whole = np.zeros((2, len(corners)))
        for place in places:
            volume = np.linalg.det(np.einsum("ai,eaj->eij", _slopes(place), corners))
            shape = 0.125 * np.prod(1.0 + CORNERS * place, axis=1)
            tall = 2.0 / SAMPLES * np.abs(corners[:, :, 2] @ _slopes(place)).sum(axis=1)
            above += volume * np.clip(0.5 + (corners[:, :, 2] @ shape - height) / tall, 0.0, 1.0)
            whole += volume
        return above / whole


def wedge_mesh(radii: np.ndarray, shell: Shell) -> Mesh3D:
    """Mesh the wedge with copies of `shell` at `radii` [um] about the tip; the outermost nodes are held.

    The innermost hexahedra collapse to pyramids whose apex is the tip.
    """
    count = len(shell.directions)
    nodes = np.concatenate([np.zeros((1, 3)), (radii[:, None, None] * shell.directions).reshape(-1, 3)])
    number = 1 + np.arange(len(radii) * count).reshape(len(radii), count)
    inner = np.vstack([np.zeros((1, count), dtype=np.int64), number[:-1]])
    elements = np.concatenate([inner[:, shell.quads], number[:, shell.quads]], axis=2).reshape(-1, 8)
    free = np.ones((len(radii), count, 3), dtype=bool)
    free[:, shell.face_plane | shell.edge_plane, 1] = False
    free[:, shell.axis, 0] = False
    free[-1] = False
    free = np.concatenate([[[False, False, True]], free.reshape(-1, 3)])
    equations = np.where(free, np.cumsum(free.ravel()).reshape(free.shape) - 1, -1)
    angle = np.append(0.0, np.tile(np.where(shell.edge_plane & ~shell.axis, WEDGE, 0.0), len(radii)))
    gradients, weights = integration(nodes[elements])
    return Mesh3D(
        nodes,
        elements,
        equations,
        np.stack([np.cos(angle), np.sin(angle)], axis=1),
        np.append(0, number[:-1, shell.surface].ravel()),
        gradients,
        weights,
        _half_bandwidth(equations[elements].reshape(len(elements), -1)),
    )


def _half_bandwidth(equations: np.ndarray) -> int:
    lowest = np.where(equations < 0, np.iinfo(equations.dtype).max, equations).min(axis=1)
    return int((equations.max(axis=1) - lowest).max())


def integration(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return gradients (m, 8, 8, 3) and volumes (m, 8) at the 2 x 2 x 2 Gauss points of hexahedra (m, 8, 3)."""
    gradients = np.empty((len(corners), 8, 8, 3))
    weights = np.empty((len(corners), 8))
    for point, place in enumerate(CORNERS / np.sqrt(3.0)):
        local = _slopes(place)
        jacobian = np.einsum("ai,eaj->eij", local, corners)
        weights[:, point] = np.linalg.det(jacobian)
        gradients[:, point] = np.einsum("eij,aj->eai", np.linalg.inv(jacobian), local)
    return gradients, weights


def _slopes(place: np.ndarray) -> np.ndarray:
    """Return the derivatives (8, 3) of the shape functions at a `place` (3,) in the cube from -1 to 1."""
    x, y, z = (1.0 + CORNERS * place).T
    return 0.125 * CORNERS * np.stack([y * z, x * z, x * y], axis=1)
