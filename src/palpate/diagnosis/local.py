"""The forward model's own curves around an optimum, fitted to a design of runs: linear, and bent along a few axes.

Where recordings leave parameters open, the curves hardly change between them. A surrogate's error, which is as rough
as its snapshots are far apart, may exceed that change, so that its slopes make known what is not. A two-level design
(Plackett & Burman, Biometrika 33 (1946) 305-325), in which every run moves all coordinates, tells slopes with the least
error for its number of runs. Along the axes on which least is known the range is wide, and what was level at the
optimum may not be so further on: runs at their ends tell by how much the curves bend (a central composite design; Box &
Wilson, J. R. Stat. Soc. B 13 (1951) 1-45).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import circulant, hadamard

from palpate.diagnosis.plane import Plane

TWELVE = np.array([1, 1, -1, 1, 1, 1, -1, -1, -1, 1, -1])  # Plackett and Burman's first of twelve runs
BENT = 3  # axes along which the curves may bend
REACH = 2.0  # standard deviations from the optimum to an end; beyond it curves go on straight
NEAR = 0.5  # standard deviations: an end nearer than that, at a bound, is not worth a run


@dataclass(frozen=True, eq=False)
class Local(Plane):
    """Curves near some coordinates, simulated there; the least squares over runs.

    Parameters
    ----------
    at, value, slope
        See `palpate.diagnosis.plane.Plane`.
    middle : ndarray, shape (k,)
        The coordinates around which the runs lie.
    axes : ndarray, shape (k, m)
        Directions along which the curves bend; their products with coordinates count standard deviations.
    bend : ndarray, shape (n_all, m)
        Second derivative of the curves along each [nm].
    scatter : ndarray, shape (n_all, n_all)
        Covariance of what the runs depart from this [nm^2].
    """

    middle: np.ndarray
    axes: np.ndarray
    bend: np.ndarray
    scatter: np.ndarray

    @classmethod
    def through(cls, curve: np.ndarray, places: np.ndarray, curves: np.ndarray, axes: np.ndarray) -> Local:
        """Return what fits runs with `curves` (m, n_all) at `places` (m, k), moved through a `curve` at the first."""
        middle, scale = places[0], np.ptp(places, axis=0) + 1e-9
        off = places - middle
        terms = np.column_stack([np.ones(len(off)), off / scale, _risen(off @ axes)])
        found = np.linalg.lstsq(terms, curves, rcond=1e-8)[0]
        left = curves - terms @ found
        scatter = left.T @ left / max(len(terms) - terms.shape[1], 1)
        slope, bend = np.split(found[1:], [len(middle)])
        return cls(middle, curve, (slope / scale[:, None]).T, middle, axes, bend.T, scatter)

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """Return the curves (m, n_all) at coordinates z (m, k) [nm]."""
        risen = _risen((z - self.middle) @ self.axes) - _risen((self.at - self.middle) @ self.axes)
        return super().__call__(z) + risen @ self.bend.T

    def slope_at(self, z: np.ndarray) -> np.ndarray:
        """Return the slope (n_all, k) of the curves at coordinates z (k,) [nm]."""
        along = np.clip((z - self.middle) @ self.axes, -REACH, REACH)
        return self.slope + (self.bend * along) @ self.axes.T

    def moved(self, at: np.ndarray, curve: np.ndarray) -> Local:
        """Return the same shape through what was simulated elsewhere."""
        return replace(self, at=at, value=curve)


def _risen(along: np.ndarray) -> np.ndarray:
    """Return what a unit second derivative adds: half the square, and straight on beyond the ends."""
    within = np.minimum(np.abs(along), REACH)
    return within * (np.abs(along) - 0.5 * within)


def design(centre: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places (m, k) around a centre (k,), and the axes (k, n) along which they tell how the curves bend."""
    variances, axes = np.linalg.eigh(covariance)
    deviations, widest = np.sqrt(variances[-BENT:]), axes[:, -BENT:]
    return np.vstack([two_level(centre, covariance), _ends(centre, widest * deviations)]), widest / deviations


def _ends(centre: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return places (m, k) as far as `REACH` steps (k, n) up and down from a centre, within the unit cube."""
    places = []
    for step in np.hstack([steps, -steps]).T:
        room = np.where(step > 0.0, 1.0 - centre, centre) / np.maximum(np.abs(step), 1e-12)
        if (far := min(REACH, float(room.min()))) > NEAR:
            places.append(centre + far * step)
    return np.array(places).reshape(-1, len(centre))


def two_level(centre: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return a design (m, k) of one standard deviation up or down along every principal axis of a covariance (k, k)."""
    variances, axes = np.linalg.eigh(covariance)
    return centre + _levels(len(centre)) @ (axes * np.sqrt(variances)).T


def _levels(factors: int) -> np.ndarray:
    """Return orthogonal columns (m, factors) of levels -1 and 1."""
    if 7 < factors < 12:
        return np.vstack([circulant(TWELVE).T, -np.ones(11)])[:, :factors]
    return hadamard(2 ** int(np.ceil(np.log2(factors + 1))))[:, 1 : factors + 1]
