"""Attraction between surface and tip, as `palpate.fem.adhesion`, for `LANES` indentations at once.

A lane without adhesion has an attraction of no strength.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.adhesion import Adhesion
from palpate.fem.batch_contact import beneath, entry
from palpate.fem.batch_vector import LANES
from palpate.fem.newton import STRIDE


class Attraction(NamedTuple):
    """The attraction of the surface nodes.

    Attributes
    ----------
    reach : ndarray, shape (LANES,)
        Gap over which it falls by e.
    hold : ndarray, shape (k, LANES)
        Force along z that parts a node from the indenter.
    pull : ndarray, shape (k, LANES)
        Force along z of the attraction.
    """

    reach: np.ndarray
    hold: np.ndarray
    pull: np.ndarray

    @classmethod
    def of(cls, adhesions: Sequence[Adhesion | None], units: np.ndarray, count: int) -> Attraction:
        """Return the attraction of `count` nodes; of areas in `units` (LANES,) [um] squared and reaches in um."""
        reach, hold = np.ones(LANES), np.zeros((count, LANES))
        for lane, adhesion in enumerate(adhesions):
            if adhesion is not None:
                reach[lane], hold[:, lane] = adhesion.reach / units[lane], adhesion.hold
        return cls(reach, hold, np.zeros_like(hold))

    def stride(self, change: np.ndarray) -> np.ndarray:
        """Return the farthest (LANES,) that one iteration may move a node of a step with a guess of its `change`."""
        farthest = np.maximum(STRIDE * self.reach, np.abs(change).max(axis=0))
        return np.where(self.hold.any(axis=0), farthest, np.inf)


@njit(cache=True)
def attract_forces(large, body, touch, grip, attraction, displacement, depth, forces, reaction):
    """Add the attraction to constrained `forces` and `reaction`; it raises the friction of nodes that touch."""
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            if attraction.hold[k, lane] == 0.0:
                continue
            moved, slope = (displacement[r, lane], touch.slope[k, lane]) if r >= 0 else (0.0, 0.0)
            touches = touch.touching[k, lane] > 0.0
            height = beneath(large, touch, lane, body.distance[k], moved)[0]
            gap = 0.0 if touches else height - depth[lane] - displacement[z, lane]
            pull = attraction.hold[k, lane] * np.exp(-gap / attraction.reach[lane])
            attraction.pull[k, lane] = pull
            if touches:
                along = grip.ratio[k, lane] * (1.0 + slope**2) * pull
            else:
                along = slope * pull
                forces[z, lane] -= pull
                reaction[lane] += pull
            if r >= 0:
                forces[r, lane] += along


@njit(cache=True)
def attract_matrix(body, touch, grip, attraction, geometric, lower, upper, column, row, corner):
    """Add the stiffness of the attraction to the constrained matrix.

    What decaying attraction takes away counts where `geometric` (LANES,) is one: without, the matrix stays positive
    definite.
    """
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            pull = attraction.pull[k, lane]
            if pull == 0.0:
                continue
            slope, curvature = (touch.slope[k, lane], touch.curvature[k, lane]) if r >= 0 else (0.0, 0.0)
            if touch.touching[k, lane] > 0.0:
                own = grip.steepness[k, lane] * (1.0 + slope**2) + 2.0 * grip.ratio[k, lane] * slope * curvature
                own *= pull
            else:
                stiffness = -geometric[lane] * pull / attraction.reach[lane]
                own = stiffness * slope**2 + curvature * pull
                lower[entry(z, z, body.width), lane] += stiffness
                column[z, lane] += stiffness
                corner[lane] += stiffness
                if r >= 0:
                    lower[entry(z, r, body.width), lane] -= stiffness * slope
                    column[r, lane] -= stiffness * slope
                if len(upper) > 0:
                    row[z, lane] += stiffness
                    if r >= 0:
                        upper[entry(z, r, body.width), lane] -= stiffness * slope
                        row[r, lane] -= stiffness * slope
            if r >= 0:
                lower[entry(r, r, body.width), lane] += own
