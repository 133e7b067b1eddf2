"""A polar mesh of the half-space under an axisymmetric indenter.

Rings of nodes grow geometrically from the tip, because a sharp indenter has no length of its own: the mesh then
resolves every contact radius of a loading history equally well, the first point of a curve like the last.
A rounded tip has a length, and a flat bottom: under it the rings within the smallest contact lie evenly. In a geometric
series the innermost is many times wider than its neighbours; the pressure on it pushes its one node down the convex
tip, and in a body that hardly hardens too little holds it back: it slides out over the nodes that follow.
Beyond twice the largest contact radius the growth speeds up, slowly: the field there decays like 1/r, and elements that
grow faster than 1.4 make the whole body visibly too stiff. Sectors are a little narrower near the surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

SECTOR_GRADING = 1.2  # exponent of the part of a quarter circle; chosen
LEAST_LOAD = 0.005  # of the largest; smaller ones count as that where they are on the way to it, else not at all


@dataclass(frozen=True)
class Resolution:
    """How fine a mesh and its time steps are.

    Parameters
    ----------
    growth
        Ratio of neighbouring ring radii within the contact.
    sectors
        Elements over the quarter circle between surface and axis.
    inner
        Innermost ring radius over the smallest contact radius that counts, under a sharp tip.
    far
        Far boundary over the largest contact radius.
    outer_growth
        Largest ratio of neighbouring ring radii far from the contact.
    refine
        Time steps taken between two samples.
    load_growth
        Largest growth of the load within one step, where a body yields.
    """

    growth: float
    sectors: int
    inner: float = 0.2
    far: float = 2000.0
    outer_growth: float = 1.4
    refine: int = 1
    load_growth: float = 0.125

    @property
    def even(self) -> int:
        """Number of even rings within the smallest contact of a rounded tip, as wide as the first that grows."""
        return round(1.0 / (self.growth - 1.0))


class Numbered:
    """A mesh with `equations`, -1 where a displacement is held."""

    equations: np.ndarray

    @property
    def size(self) -> int:
        """Number of equations."""
        return int(self.equations.max()) + 1


@dataclass(frozen=True, eq=False)
class Mesh(Numbered):
    """Four-node axisymmetric elements with everything that does not change during a simulation.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2)
        Reference coordinates (r, z), z <= 0.
    elements : ndarray of int, shape (m, 4)
    equations : ndarray of int, shape (n, 2)
        Equation of each displacement component, -1 where it is held at zero.
    surface : ndarray of int, shape (k,)
        Nodes of the free surface, from the axis outwards.
    gradients : ndarray, shape (m, 4, 3, 4)
        At each Gauss point dN/dr, dN/dz and N/r of the four nodes.
    weights : ndarray, shape (m, 4)
        Volume of each Gauss point, 2 pi r dA.
    """

    nodes: np.ndarray
    elements: np.ndarray
    equations: np.ndarray
    surface: np.ndarray
    gradients: np.ndarray
    weights: np.ndarray

    def share_above(self, height: float) -> np.ndarray:
        """Return the share (m,) of each element's volume of revolution above z = `height` [um], exactly."""
        corners = self.nodes[self.elements]
        halves = np.stack([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]], axis=1)
        whole, above = revolved(halves, -np.inf), revolved(halves, height)
        return above.sum(axis=1) / whole.sum(axis=1)


def revolved(triangles: np.ndarray, height: float) -> np.ndarray:
    """Return the integral of r over the part above z = `height` of triangles (..., 3 corners, r and z).

    The part above a height is one corner's tip, or the triangle less the tip of the lowest corner.
    """
    order = np.argsort(triangles[..., 1], axis=-1)
    r, z = (np.take_along_axis(triangles[..., k], order, axis=-1) for k in range(2))
    edges = triangles[..., 1:, :] - triangles[..., :1, :]
    area = 0.5 * np.abs(edges[..., 0, 0] * edges[..., 1, 1] - edges[..., 0, 1] * edges[..., 1, 0])
    whole = area * r.mean(axis=-1)
    bottom, middle, top = np.moveaxis(z, -1, 0)
    below = _tip(r[..., [0, 1, 2]], z[..., [0, 1, 2]], height, area)
    above = _tip(r[..., [2, 0, 1]], z[..., [2, 0, 1]], height, area)
    partly = np.where(height < middle, whole - below, above)
    return np.where(height <= bottom, whole, np.where(height >= top, 0.0, partly))


def _tip(r: np.ndarray, z: np.ndarray, height: float, area: np.ndarray) -> np.ndarray:
    """Return the integral of r over what a horizontal line at `height` cuts off with the first corner."""
    level = np.clip(height, z.min(axis=-1), z.max(axis=-1))
    one, two = (
        np.divide(level - z[..., 0], z[..., k] - z[..., 0], out=np.ones_like(area), where=z[..., k] != z[..., 0])
        for k in (1, 2)
    )
    mean = r[..., 0] + (one * (r[..., 1] - r[..., 0]) + two * (r[..., 2] - r[..., 0])) / 3.0
    return area * one * two * mean


def ring_radii(smallest: float, largest: float, resolution: Resolution, rounded: bool = False) -> np.ndarray:
    """Radii of the rings, for contact radii between `smallest` and `largest`, under a sharp or a `rounded` tip.

    Rings that grow by the same ratio come in multiples of half of those that a sharp tip needs from `LEAST_LOAD` on, so
    that most indentations share their mesh but for its size, and run in lanes.

    Parameters
    ----------
    smallest, largest
        Contact radii, in one unit of length with the result.
    resolution
        Of the mesh.
    rounded
        Whether the tip is rounded.
    """
    growth, even = resolution.growth, resolution.even
    radii = [smallest * (k + 1) / even for k in range(even)] if rounded else [resolution.inner * smallest]
    needed, usual = (
        math.log(2.0 * contacts / inner) / math.log(growth)
        for contacts, inner in ((largest, radii[-1]), (math.sqrt(1.0 / LEAST_LOAD), radii[-1] / smallest))
    )
    half = math.ceil(usual / 2)
    count = math.ceil(needed / half) * half
    radii += [radii[-1] * growth**k for k in range(1, count + 1)]
    farthest = 0.5 * resolution.far * radii[-1]
    while radii[-1] < farthest:
        growth = min(1.0 + 1.05 * (growth - 1.0), resolution.outer_growth)
        radii.append(radii[-1] * growth)
    return np.array(radii)


def polar_mesh(radii: np.ndarray, sectors: int) -> Mesh:
    """Mesh the quarter plane r >= 0, z <= 0 with rings at `radii` and `sectors` elements around.

    The innermost ring is a fan of quadrilaterals that collapse at the tip. The outermost ring of nodes is held.
    Nodes are numbered ring by ring, for a narrow band, and the displacement along z of a node comes first: contact is
    stiff.
    """
    angles = 0.5 * np.pi * np.linspace(0.0, 1.0, sectors + 1) ** SECTOR_GRADING
    rings = np.stack([np.outer(radii, np.cos(angles)), -np.outer(radii, np.sin(angles))], axis=-1)
    rings[:, -1, 0] = 0.0
    nodes = np.concatenate([np.zeros((1, 2)), rings.reshape(-1, 2)])
    count = sectors + 1
    number = np.arange(1, len(nodes)).reshape(len(radii), count)
    inner = np.vstack([np.zeros((1, count), dtype=int), number[:-1]])
    elements = np.stack([inner[:, 1:], number[:, 1:], number[:, :-1], inner[:, :-1]], axis=-1).reshape(-1, 4)
    free = np.ones((len(nodes), 2), dtype=bool)
    free[number[-1]] = False
    free[0, 0] = False
    free[number[:, -1], 0] = False
    order = np.cumsum(free[:, ::-1].ravel()).reshape(free.shape)[:, ::-1] - 1
    equations = np.where(free, order, -1)
    gradients, weights = _integration(nodes[elements])
    return Mesh(
        nodes=nodes,
        elements=elements,
        equations=equations,
        surface=np.concatenate([[0], number[:-1, 0]]),
        gradients=gradients,
        weights=weights,
    )


def _integration(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return shape function gradients and volumes at the 2 x 2 Gauss points of elements with these corners."""
    offset = 1.0 / np.sqrt(3.0)
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    gradients = np.empty((len(corners), 4, 3, 4))
    weights = np.empty((len(corners), 4))
    for point, (xi, eta) in enumerate(offset * signs):
        shape = 0.25 * (1 + xi * signs[:, 0]) * (1 + eta * signs[:, 1])
        local = 0.25 * np.stack([signs[:, 0] * (1 + eta * signs[:, 1]), signs[:, 1] * (1 + xi * signs[:, 0])])
        jacobian = np.einsum("ia,eaj->eij", local, corners)
        determinant = np.linalg.det(jacobian)
        radius = corners[:, :, 0] @ shape
        gradients[:, point, :2] = np.linalg.solve(jacobian, np.broadcast_to(local, (len(corners), 2, 4)))
        gradients[:, point, 2] = shape / radius[:, None]
        weights[:, point] = 2 * np.pi * radius * determinant
    return gradients, weights
