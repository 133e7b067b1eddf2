"""Coulomb friction of surface nodes along a rigid indenter that need not be a body of revolution.

The indenter z = f(x, y) - depth moves along z only, so a node that touches it slips exactly when its place x_i changes.
Along the tangents t_i = e_i + f_i e_z, with the metric a_ij = t_i . t_j = delta_ij + f_i f_j, friction is

    T . t_i = -mu N a_ij s_j / max(1, |s|),   s_i = (x_i - A_i) / (ELASTIC_SLIP f(X)),   |s|^2 = a_ij s_i s_j,

with the anchor A: the place at first touch, dragged along when the node slips. As in the plane, the little slip before
the limit takes the place of sticking and grows with the height f(X) of the indenter over its apex.

The normal force follows from the force F of the indenter on the node: N = P / J with P = f_i F_i - F_z, J^2 = 1 + f_i
f_i. On a mirror plane a node slips in that plane alone, and the plane bears what acts across it, so that N follows from
the components within: N = P J / (1 + f_1^2) with P = f_1 F_1 - F_z. Under the edge of a pyramid, where two faces lean
against each other, that is more than the force they leave along the plane, by J^2 / (1 + f_1^2).

Source: return mapping after Wriggers, Computational Contact Mechanics, 2nd ed. (2006), chapter 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ELASTIC_SLIP = 3e-4  # of the indenter's height, that precedes the limit of friction; chosen


@dataclass(frozen=True, eq=False)
class Friction:
    """Coulomb friction of the surface nodes; places, slopes and slips (k, 2) are along the axes of each node.

    Parameters
    ----------
    coefficient
        mu.
    reach : ndarray, shape (k,)
        Slip along the indenter at which a node that stuck reaches the limit [um].
    free : ndarray of bool, shape (k, 2)
        Axes along which each node may slip: one on a mirror plane, none under the apex.
    """

    coefficient: float
    reach: np.ndarray
    free: np.ndarray

    @classmethod
    def of(cls, coefficient: float, height: np.ndarray, free: np.ndarray) -> Friction:
        """Return the friction of nodes under these heights (k,) of the indenter [um], the first of which is zero."""
        return cls(coefficient, ELASTIC_SLIP * np.maximum(height, height[1:].min()), free)

    def slip(self, place: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """Return s (k, 2)."""
        return (place - anchor) / self.reach[:, None]

    def along(self, slope: np.ndarray) -> np.ndarray:
        """Return the slopes (k, 2) of what a node may slip along: none across a mirror plane, none under the apex."""
        return slope * self.free

    def size(self, slip: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Return |s| (k,), more than one where a node slips."""
        return np.sqrt(_dot(slip, slip) + _dot(slip, self.along(slope)) ** 2)

    def ratio(self, slip: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return c_i = -T . t_i / P (k, 2) and dc_i/dx_j (k, 2, 2), symmetric and not negative.

        The derivative leaves out that the tangents turn along a curved indenter: little, over the way from the anchor.
        """
        slopes = self.along(slope)
        metric = np.eye(2) + slopes[:, :, None] * slopes[:, None, :]
        beyond = np.maximum(1.0, self.size(slip, slope))
        covariant = np.einsum("kij,kj->ki", metric, slip) / beyond[:, None]
        factor = self.coefficient * np.sqrt(1.0 + _dot(slope, slope)) / (1.0 + _dot(slopes, slopes))
        turning = np.where(beyond > 1.0, 1.0, 0.0)[:, None, None] * covariant[:, :, None] * covariant[:, None, :]
        return factor[:, None] * covariant, (factor / (self.reach * beyond))[:, None, None] * (metric - turning)

    def dragged(self, place: np.ndarray, anchor: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Return the anchors (k, 2) at the end of a step."""
        slip = self.slip(place, anchor)
        return place - (self.reach / np.maximum(1.0, self.size(slip, slope)))[:, None] * slip


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.einsum("ki,ki->k", one, other)
