"""Curves around a fit to second order, along the parameters that the recordings determine least.

Along the few least determined directions an interval is wide, and the derivatives at the best point differ from those
at its ends. The forward model's derivatives one standard deviation to either side along each of these axes give the
second derivatives along it, pure and mixed with every other coordinate (Box & Wilson, J. R. Stat. Soc. B 13 (1951)
1-45, with slopes in place of further runs).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.inference.explanation import Fit

AXES = 3  # along which second derivatives are taken
REACH = 2.0  # standard deviations, beyond which the curves are continued linearly


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
        """Simulate the slopes around a fit, one-sided where an end lies beyond a limit or the model fails."""
        variances, directions = np.linalg.eigh(fit.posterior)
        axes = (directions * np.sqrt(variances))[:, -AXES:]
        least, largest = fit.coordinates.limits
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

    @property
    def columns(self) -> np.ndarray:
        """What the curves are made of (n_all, c), in the proportions of `features` [nm]."""
        return np.column_stack([self.fit.curve, self.slopes, *self.bends])

    def features(self, z: np.ndarray) -> np.ndarray:
        """Return the proportions (p, c) of `columns` at coordinates z (p, k)."""
        off = z - self.fit.z
        along = np.linalg.lstsq(self.axes, off.T, rcond=None)[0].T
        within = np.clip(along, -REACH, REACH)
        beside = off - 0.5 * within @ self.axes.T
        bent = [within[:, number, None] * beside for number in range(len(self.bends))]
        return np.column_stack([np.ones(len(z)), off, *bent])
