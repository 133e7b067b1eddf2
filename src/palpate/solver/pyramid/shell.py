"""One shell of the mesh: a spherical triangle of quadrilaterals, between two mirror planes and the free surface.

Three mirror planes of a three-sided pyramid cut the half-space into six equal wedges. On the unit sphere a wedge is a
triangle whose corners lie on the axis, on the surface under the middle of a face, and on the surface under an edge.
Three blocks of quadrilaterals meet at its centre, so that no element degenerates on the axis: one at each corner, with
`near` elements on each side of the axis and `far` ones on each side of the two others, towards the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

WEDGE = np.pi / 3.0  # angle of a wedge
AXIS, FACE = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
EDGE = np.array([np.cos(WEDGE), np.sin(WEDGE), 0.0])
SAME = 1e-9  # of the unit sphere, within which two nodes are one


@dataclass(frozen=True, eq=False)
class Shell:
    """Nodes and quadrilaterals on the unit sphere.

    Attributes
    ----------
    directions : ndarray, shape (n, 3)
        Unit vectors from the tip, numbered so that neighbours have close numbers.
    quads : ndarray of int, shape (m, 4)
        Corners, counterclockwise as seen from outside.
    """

    directions: np.ndarray
    quads: np.ndarray

    @property
    def axis(self) -> np.ndarray:
        """Which nodes (n,) lie on the axis."""
        return np.hypot(self.directions[:, 0], self.directions[:, 1]) < SAME

    @property
    def face_plane(self) -> np.ndarray:
        """Which nodes (n,) lie on the mirror plane through the middle of a face, y = 0."""
        return np.abs(self.directions[:, 1]) < SAME

    @property
    def edge_plane(self) -> np.ndarray:
        """Which nodes (n,) lie on the mirror plane through an edge of the pyramid."""
        return np.abs(self.directions[:, :2] @ [-np.sin(WEDGE), np.cos(WEDGE)]) < SAME

    @property
    def surface(self) -> np.ndarray:
        """Which nodes (n,) lie on the free surface."""
        return np.abs(self.directions[:, 2]) < SAME


def shell(sectors: int) -> Shell:
    """Return a shell with `sectors` elements between surface and axis, a multiple of three; square ones."""
    near = sectors // 3
    far = sectors - near
    to_face, to_edge = _between(AXIS, FACE, near / sectors), _between(AXIS, EDGE, near / sectors)
    rim = _between(FACE, EDGE, 0.5)
    centre = _unit(to_face + to_edge + rim)
    blocks = (
        _block(AXIS, to_face, centre, to_edge, near, near),
        _block(to_face, FACE, rim, centre, far, near),
        _block(to_edge, centre, rim, EDGE, near, far),
    )
    points = np.concatenate([block.reshape(-1, 3) for block in blocks])
    _, first, number = np.unique(np.round(points / SAME), axis=0, return_index=True, return_inverse=True)
    quads, offset = [], 0
    for block in blocks:
        rows, columns = block.shape[:2]
        numbers = number.ravel()[offset : offset + rows * columns].reshape(rows, columns)
        corners = (numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1])
        quads.append(np.stack(corners, axis=-1).reshape(-1, 4))
        offset += rows * columns
    return _renumbered(points[first], np.concatenate(quads))


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def _between(one: np.ndarray, other: np.ndarray, fraction: float) -> np.ndarray:
    """Return the direction (3,) at a `fraction` of the angle from one direction to another."""
    angle = np.arccos(np.clip(one @ other, -1.0, 1.0))
    return (np.sin((1 - fraction) * angle) * one + np.sin(fraction * angle) * other) / np.sin(angle)


def _block(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, along: int, across: int) -> np.ndarray:
    """Return directions (along + 1, across + 1, 3) between four corners, with `along` elements from a to b."""
    s, t = np.linspace(0, 1, along + 1)[:, None, None], np.linspace(0, 1, across + 1)[None, :, None]
    return _unit((1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d)


def _renumbered(directions: np.ndarray, quads: np.ndarray) -> Shell:
    """Return the shell with close numbers for the nodes of one element (reverse Cuthill-McKee)."""
    rows, columns = np.repeat(quads, 4, axis=1).ravel(), np.tile(quads, (1, 4)).ravel()
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(directions),) * 2).tocsr()
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    return Shell(directions[order], number[quads])
