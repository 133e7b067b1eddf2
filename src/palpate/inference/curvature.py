"""Curves around a fit to second order, where recordings leave its parameters open.

Along the few directions in which least is known an interval is wide, and the slope at the best point is not that at its
ends. The forward model's derivatives one standard deviation to either side along each of these axes tell by how much
the curves bend along it, and how the slope by every other coordinate changes with it (Box & Wilson, J. R. Stat. Soc. B
13 (1951) 1-45, with slopes in place of further runs).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.inference.explanation import Fit

AXES = 3  # along which the curves may bend
REACH = 2.0  # standard deviations, beyond which they go on straight


@dataclass(frozen=True, eq=False)
class Curvature:
    """A Taylor series of the curves about a fit.

    Parameters
    ----------
    fit
    slopes : ndarray, shape (n_all, k)
        By the coordinates, at the fit [nm].
    axes : ndarray, shape (k, m)
        Steps of one standard deviation along the axes.
    bends : ndarray, shape (m, n_all, k)
        By how much the slopes change over one such step [nm].
    """

    fit: Fit
    slopes: np.ndarray
    axes: np.ndarray
    bends: np.ndarray

    @classmethod
    def of(cls, fit: Fit) -> Curvature:
        """Simulate the slopes around a fit; where one end lies beyond a limit, or fails, the other tells the bend."""
        variances, directions = np.linalg.eigh(fit.posterior)
        axes = (directions * np.sqrt(variances))[:, -AXES:]
        least, largest = fit.coordinates.walls
        ends = [fit.z + side * step for step in axes.T for side in (1.0, -1.0)]
        within = [bool(np.all((end >= least) & (end <= largest))) for end in ends]
        outcomes = fit.model.tangents([fit.z, *(end for end, inside in zip(ends, within, strict=True) if inside)])
        found = [None if isinstance(each, str) else fit.problem.stacked(each[1]) for each in outcomes]
        here, simulated = fit.tangent if found[0] is None else found[0], iter(found[1:])
        there = [next(simulated) if inside else None for inside in within]
        bends = []
        for ahead, behind in zip(there[::2], there[1::2], strict=True):
            changes = [ahead - here] if ahead is not None else []
            changes += [here - behind] if behind is not None else []
            bends.append(np.mean(changes, axis=0) if changes else np.zeros_like(here))
        return cls(fit, here, axes, np.array(bends))

    def curves(self, z: np.ndarray) -> np.ndarray:
        """Return the curves (p, n_all) at coordinates z (p, k) [nm]."""
        off = z - self.fit.z
        along = np.linalg.lstsq(self.axes, off.T, rcond=None)[0].T
        within = np.clip(along, -REACH, REACH)
        curves = self.fit.curve + off @ self.slopes.T
        beside = off - 0.5 * within @ self.axes.T
        for number, bend in enumerate(self.bends):
            curves += within[:, number, None] * (beside @ bend.T)
        return curves
