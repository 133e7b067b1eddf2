"""Where the next step begins its iteration: the last two changes carried on, by Newton's divided differences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.lanes import LANES

SPREADING = 0.5  # largest change of the logarithm of the area of contact that is carried on


@dataclass(frozen=True, eq=False)
class Trend:
    """The last two changes of the unknowns, and how long they took.

    Parameters
    ----------
    last, before : ndarray, shape (unknowns, LANES)
        Changes of the last step and of the one before, see `palpate.solver.axisymmetric.march.States.unknowns`.
    taken, earlier : ndarray, shape (LANES,)
        Durations of both [s]; `earlier` is NaN where the last step did not carry on from the one before.
    """

    last: np.ndarray
    before: np.ndarray
    taken: np.ndarray
    earlier: np.ndarray

    @classmethod
    def none(cls, unknowns: int) -> Trend:
        """Return the trend of so many unknowns that have not moved yet."""
        still = np.zeros((unknowns, LANES))
        return cls(still, still, np.ones(LANES), np.full(LANES, np.nan))

    def guess(self, step: np.ndarray, carries: np.ndarray) -> np.ndarray:
        """Return the changes of the unknowns (unknowns, LANES) expected in a `step` (LANES,) [s].

        None is expected where the next step does not carry the last change on: `carries` (LANES,).
        """
        bends = carries & np.isfinite(self.earlier)
        earlier = np.where(bends, self.earlier, 1.0)
        bend = np.where(bends, step * (step + self.taken) / (self.taken + earlier), 0.0)
        change = np.where(carries, step / self.taken, 0.0) * self.last
        change = change + bend * (self.last / self.taken - self.before / earlier)
        change[-1] = np.clip(change[-1], -SPREADING, SPREADING)
        return change

    def followed(self, change: np.ndarray, step: np.ndarray, carried: np.ndarray) -> Trend:
        """Return the trend after one more `change` (unknowns, LANES) in a `step` that carried on or not."""
        return Trend(change, self.last, step, np.where(carried, self.taken, np.nan))
