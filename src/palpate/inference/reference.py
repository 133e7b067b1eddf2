"""Curves of an accurate and a fast model at the same parameters, by which `palpate.inference.space_mapping` scales."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from palpate.base.interpolation import smooth_between
from palpate.study.protocol import Protocol

NO_DEPTH = 1e-6  # of the largest depth: below it an elastic body is unloaded


@dataclass(frozen=True, eq=False)
class Reference:
    """Curves of the body under one condition, of both models.

    Parameters
    ----------
    accurate : ndarray, shape (n_points,)
        At all samples.
    fast : ndarray, shape (n_kept,)
        At those that are `kept` (bool, n_points).
    kept : ndarray
    changed : ndarray, shape (n_points,)
        By how much the accurate model differs from that on the study's mesh, where known.
    steeper : ndarray, shape (n_points, k)
        By how much the accurate model's derivatives by the coordinates exceed those that are carried, where known.
    rest : ndarray, shape (n_points,)
        Part of the accurate model's curve [-] that finer meshes add to it, which is in `accurate` already.
    """

    accurate: np.ndarray
    fast: np.ndarray
    kept: np.ndarray
    changed: np.ndarray
    steeper: np.ndarray | None = None
    rest: np.ndarray | float = 0.0

    def with_rest(self, rest: np.ndarray | float) -> Reference:
        """Return the same with this part (n_points,) that finer meshes add, in place of what they added before."""
        return replace(self, accurate=self.accurate / (1.0 + self.rest) * (1.0 + rest), steeper=None, rest=rest)

    def carried(self, fast: np.ndarray, protocol: Protocol) -> np.ndarray:
        """Return the fast model's values (n_kept, ...) scaled to the accurate model, at all samples (n_points, ...)."""
        divides, time = _deep(self.fast), protocol.sample_time
        ratios = (fast[divides].T / self.fast[divides]).T.reshape(int(divides.sum()), -1)
        everywhere = smooth_between(protocol.knot_time, time, time[self.kept][divides], ratios)
        return (self.accurate[:, None] * everywhere).reshape(len(time), *fast.shape[1:])


def rest_of(before: np.ndarray, change: np.ndarray, time: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Return the part of a curve (n_points,) [-] that all finer meshes add; none where the body is unloaded.

    Parameters
    ----------
    before : ndarray, shape (n_kept,)
        The curve at some of its samples.
    change : ndarray, shape (n_kept,)
        What the next finer mesh adds to it. As much lies beyond (Richardson's extrapolation, second order in the
        spacing).
    time : ndarray, shape (n_points,)
        All samples [s].
    kept : ndarray of bool, shape (n_points,)
        Which of them are known.
    """
    part = np.divide(2.0 * change, before, out=np.zeros_like(before), where=_deep(before))
    return np.interp(time, time[kept], part)


def _deep(curve: np.ndarray) -> np.ndarray:
    """Return where a curve (n,) differs from nothing, by which it may be divided."""
    return np.abs(curve) > NO_DEPTH * np.abs(curve).max()
