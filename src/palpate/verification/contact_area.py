"""The area of a contact whose edge runs between the nodes of a wedge's surface."""

from __future__ import annotations

import numpy as np

from palpate.solver.pyramid.mesh_3d import Mesh3D


def contact_area(mesh: Mesh3D, displacement: np.ndarray, touching: np.ndarray) -> float:
    """Return the projected area [um^2] of the whole contact, all six wedges, whose nodes are `touching` (n,).

    On each ray of surface nodes the contact ends halfway, in the logarithm of the distance from the axis, between the
    last node that touches and the next one, both where `displacement` (n, 3) has put them. Between rays at the angles
    p and q it ends on a curve that encloses r(p) r(q) (q - p)/2: a circle exactly, a straight line nearly.
    """
    nodes = mesh.surface[1:]
    (x, y, _), (one, two, _) = mesh.nodes[nodes].T, displacement[nodes].T
    angle, distance = np.round(np.arctan2(y, x), 6), np.hypot(x, y)
    cos, sin = mesh.turn[nodes].T
    moved = np.hypot(x + cos * one - sin * two, y + sin * one + cos * two)
    rays = np.lexsort((distance, angle)).reshape(len(np.unique(angle)), -1)
    ray, last = np.arange(len(rays)), touching[nodes[rays]].sum(axis=1)
    edge = np.sqrt(moved[rays[ray, last - 1]] * moved[rays[ray, last]])
    return float(3.0 * np.sum(edge[1:] * edge[:-1] * np.diff(angle[rays[:, 0]])))
