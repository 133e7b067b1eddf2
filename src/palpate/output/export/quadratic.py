"""An axisymmetric mesh of quadratic elements for other programs: triangles at the tip, then rings of quadrilaterals.

Apart from the idea of rings that grow from the tip it shares nothing with `palpate.solver.axisymmetric`: other
elements, other integration, and a body of which the far boundary moves as one and is pressed against an indenter that
does not move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.contact_size import contact_range
from palpate.solver.axisymmetric.mesh import Resolution, ring_radii
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.specification import Specification

RESOLUTIONS = {
    "standard": Resolution(growth=1.3, sectors=5, inner=0.1, far=500.0),
    "medium": Resolution(growth=1.2, sectors=6, inner=0.1, far=500.0),
    "fine": Resolution(growth=1.15, sectors=8, inner=0.1, far=500.0),
    "finest": Resolution(growth=1.12, sectors=10, inner=0.1, far=500.0),
}
REACH = 6.0  # contact radii, to which the surface may touch


@dataclass(frozen=True, eq=False)
class QuadraticMesh:
    """Body and indenter, in um; the tip lies `overlap` below the surface, for contact to be there from the start.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2)
        (r, z) of the body's nodes, then the indenter's.
    triangles : ndarray of int, shape (s, 6)
    quads : ndarray of int, shape (q, 8)
        Counter-clockwise, corners first; where an element touches the free surface its first edge lies on it. The
        first triangle does.
    axis, far : ndarray of int
        Nodes of the body on the axis and on its outer boundary.
    top_quads : ndarray of int
        Quads at the free surface.
    indenter : ndarray of int, shape (p, 8)
        Elements behind the indenter's face, which is their first edge.
    overlap, contact_radius : float
        The latter is the estimated largest one.
    """

    nodes: np.ndarray
    triangles: np.ndarray
    quads: np.ndarray
    axis: np.ndarray
    far: np.ndarray
    top_quads: np.ndarray
    indenter: np.ndarray
    overlap: float
    contact_radius: float


def quadratic_mesh(specification: Specification, resolution: Resolution) -> QuadraticMesh:
    """Mesh the body and the indenter of a specification; contact radii are estimated as by the solver."""
    smallest, largest = contact_range(specification.specimen, specification.indenter, specification.protocol)
    radii = ring_radii(smallest, largest, resolution)
    profile = Profile.of(specification.indenter)
    overlap = profile.depth_for(max(0.3 * smallest, 2.5 * radii[0]))  # over more than one element
    body, triangles, quads, number = _body(radii, resolution.sectors)
    face = _indenter(profile, radii[radii < REACH * largest], overlap)
    pieces = len(face) // 5
    lower, upper = len(body) + np.arange(2 * (2 * pieces + 1)).reshape(2, -1)
    sides = upper[-1] + 1 + np.arange(pieces + 1)
    k = 2 * np.arange(pieces)
    indenter = np.stack(
        [lower[k], lower[k + 2], upper[k + 2], upper[k], lower[k + 1], sides[1:], upper[k + 1], sides[:-1]], axis=1
    )
    return QuadraticMesh(
        nodes=np.vstack([body, face]),
        triangles=triangles,
        quads=quads,
        axis=np.concatenate([[0], number[1:, -1]]),
        far=number[-1],
        top_quads=np.arange(0, len(quads), resolution.sectors),
        indenter=indenter,
        overlap=overlap,
        contact_radius=largest,
    )


def _body(radii: np.ndarray, sectors: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes, triangles, quads, and the number of each node of the polar grid (its row 0 is the tip)."""
    half = _with_midpoints(np.concatenate([[0.0], radii]))
    angles = 0.5 * np.pi * np.arange(2 * sectors + 1) / (2 * sectors)
    exists = np.ones((len(half), len(angles)), dtype=bool)
    exists[0, 1:] = False
    exists[1::2, 1::2] = False
    number = np.where(exists, np.cumsum(exists.ravel()).reshape(exists.shape) - 1, -1)
    number[0] = 0
    r, z = np.outer(half, np.cos(angles)), -np.outer(half, np.sin(angles))
    r[:, -1] = 0.0
    nodes = np.stack([r[exists], z[exists]], axis=1)
    j = 2 * np.arange(sectors)
    triangles = np.stack(
        [number[2, j], number[0, j], number[2, j + 2], number[1, j], number[1, j + 2], number[2, j + 1]], axis=1
    )
    i, j = (part.ravel() for part in np.meshgrid(2 * np.arange(1, len(radii)), j, indexing="ij"))
    steps = ((2, 0), (0, 0), (0, 2), (2, 2), (1, 0), (0, 1), (1, 2), (2, 1))
    quads = np.stack([number[i + di, j + dj] for di, dj in steps], axis=1)
    return nodes, triangles, quads, number


def _indenter(profile: Profile, radii: np.ndarray, overlap: float) -> np.ndarray:
    """Return the nodes of one layer of elements behind the face: of the face, of the back, and between them."""
    r = _with_midpoints(np.concatenate([[0.0], radii]))
    height = profile(r)[0] - overlap
    thickness = 0.2 * radii[-1]
    rows = ((r, height), (r, height + thickness), (r[::2], height[::2] + 0.5 * thickness))
    return np.concatenate([np.stack(row, axis=1) for row in rows])


def _with_midpoints(x: np.ndarray) -> np.ndarray:
    both = np.empty(2 * len(x) - 1)
    both[::2], both[1::2] = x, 0.5 * (x[1:] + x[:-1])
    return both
