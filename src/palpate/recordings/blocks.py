"""Averages of a recording over blocks of neighbouring points, and the covariance of their noise."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np


@dataclass(frozen=True)
class Blocks:
    """Averages over blocks of points, all (n,).

    Attributes
    ----------
    time, depth, load
        Means of the points; the unit is the caller's.
    count
        Points in each block.
    begin, end
        Times between which a block lies.
    """

    time: np.ndarray
    depth: np.ndarray
    load: np.ndarray
    count: np.ndarray
    begin: np.ndarray
    end: np.ndarray

    @classmethod
    def of(cls, edges: np.ndarray, time: np.ndarray, depth: np.ndarray, load: np.ndarray) -> Blocks:
        """Average time, depth and load (n,) between the indices `edges` (b + 1,), from 0 to the number that counts."""
        count = np.diff(edges)
        clock, way, force = (np.add.reduceat(c[: edges[-1]], edges[:-1]) / count for c in (time, depth, load))
        between = 0.5 * (time[:-1] + time[1:])[edges[1:-1] - 1]
        before, behind = (0.5 * float(time[k + 1] - time[k]) for k in (0, edges[-1] - 2))
        begin, end = np.append(time[0] - before, between), np.append(between, time[edges[-1] - 1] + behind)
        return cls(clock, way, force, count, begin, end)

    @classmethod
    def even(cls, most: int, time: np.ndarray, depth: np.ndarray, load: np.ndarray) -> Blocks:
        """Average time, depth and load (n,) over at most so many blocks of equally many points (`most`)."""
        edges = np.unique(np.linspace(0, len(time), min(len(time), most) + 1).round().astype(int))
        return cls.of(edges, time, depth, load)

    def __len__(self) -> int:
        return len(self.time)

    def joined(self, others: Blocks) -> Blocks:
        """Return these blocks and others behind them."""
        return Blocks(*(np.append(getattr(self, each.name), getattr(others, each.name)) for each in fields(self)))


def correlated(begin: np.ndarray, end: np.ndarray, time: float) -> np.ndarray:
    r"""Return the covariance (n, n) of averages of an Ornstein-Uhlenbeck process over blocks from `begin` to `end`.

    The process has unit variance and the correlation :math:`e^{-|t - t'| / \tau}`; its averages follow by integration.
    """
    length = np.maximum((end - begin) / time, 1e-6)
    mean = -np.expm1(-length) / length
    gap = np.maximum(begin[None, :] - end[:, None], begin[:, None] - end[None, :]) / time
    found = np.exp(-np.maximum(gap, 0.0)) * np.outer(mean, mean)
    found[np.diag_indices(len(length))] = 2 * (length - 1 + np.exp(-length)) / length**2
    return found
