"""Coulomb friction along the generator of a rigid indenter.

The indenter moves along z only, so a node that touches it at the distance R from the axis slips exactly when R changes.
Its friction T = -m N opposes the slip since first touch, up to the limit |m| = mu,

    m = mu clip((R - A) / (ELASTIC_SLIP f(r)), -1, 1),

with the anchor A: R at first touch, dragged along when the node slips. The little slip that precedes the limit stands
for sticking; in proportion to the height f(r) of the indenter over its apex, as displacements are, and to the normal
force N, it adds no length to a sharp cone.

Source: return mapping after Wriggers, Computational Contact Mechanics, 2nd ed. (2006), chapter 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ELASTIC_SLIP = 3e-4


@dataclass(frozen=True, eq=False)
class Friction:
    """Coulomb friction of the surface nodes.

    Parameters
    ----------
    coefficient
        mu.
    reach : ndarray, shape (k,)
        Slip at which a node that stuck reaches the limit [um].
    """

    coefficient: float
    reach: np.ndarray

    @classmethod
    def of(cls, coefficient: float, height: np.ndarray) -> Friction:
        """Return the friction of nodes under these heights (k,) of the indenter [um], in rising order from zero."""
        return cls(coefficient, ELASTIC_SLIP * np.maximum(height, height[1]))

    def slip(self, distance: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """Return (R - A) / reach of nodes at the distances R."""
        return (distance - anchor) / self.reach

    def ratio(self, slip: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return m and dm/dR."""
        sticks = np.abs(slip) < 1.0
        return self.coefficient * np.clip(slip, -1.0, 1.0), np.where(sticks, self.coefficient / self.reach, 0.0)

    def dragged(self, distance: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """Return the anchors at the end of a step."""
        return np.clip(anchor, distance - self.reach, distance + self.reach)
