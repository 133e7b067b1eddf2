"""Attraction between surface and tip, as `palpate.fem.adhesion`, for `LANES` indentations at once.

A lane without adhesion has an attraction of no strength.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.adhesion import Adhesion
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

    @property
    def acts(self) -> bool:
        """Whether any lane has adhesion."""
        return bool(self.hold.any())

    def stride(self, change: np.ndarray) -> np.ndarray:
        """Return the farthest (LANES,) that one iteration may move a node of a step with a guess of its `change`."""
        return np.maximum(STRIDE * self.reach, np.abs(change).max(axis=0)) if self.acts else np.full(LANES, np.inf)


@njit(cache=True)
def attract(attraction, k, lane, gap):
    """Write and return the pull on a node across a gap, zero where it touches."""
    pull = attraction.hold[k, lane] * np.exp(-gap / attraction.reach[lane])
    attraction.pull[k, lane] = pull
    return pull
