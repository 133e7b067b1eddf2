"""The forward model's own curves around an optimum, fitted to a design of runs: linear, and quadratic in a few axes.

Where recordings leave parameters open, the curves hardly change between them. A surrogate's error, which is as rough
as its snapshots are far apart, may exceed that change, so that its slopes make known what is not. The slopes here are
central differences of the forward model, over one standard deviation either way along each principal axis of the
posterior. Along the axes on which least is known the range is wide, and what was level at the optimum may not be so
further on: there the differences reach over two, and their second differences tell by how much the curves bend. How
they twist, the slope along one such axis changing along another, is told by runs that move both. All this is the second
order of a Taylor series (Box & Wilson, J. R. Stat. Soc. B 13 (1951) 1-45).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

BENT = 3  # axes along which the curves may bend, and twist from one to another
REACH = 2.0  # standard deviations from the optimum to an end; beyond it curves go on straight
STILL = 1e-9  # coordinates that vary by no more are not moved


@dataclass(frozen=True, eq=False)
class Straight:
    """Coordinates in which valleys are straight: what acts as a factor counts by its logarithm.

    Twice the compliance of a Voigt element that takes twice as long says nearly the same of a shorter test. Below its
    standard deviation such a coordinate counts as it is, so that none at all is a number, too.

    Parameters
    ----------
    scale : ndarray, shape (k,)
        Below which each coordinate counts as it is; infinite for all that are no factors.
    """

    scale: np.ndarray

    def of(self, z: np.ndarray) -> np.ndarray:
        """Return straightened coordinates (..., k)."""
        return np.where(np.isinf(self.scale), z, self._finite * np.log1p(z / self._finite))

    def slope(self, z: np.ndarray) -> np.ndarray:
        """Return their derivatives by the coordinates (..., k)."""
        return np.where(np.isinf(self.scale), 1.0, 1.0 / (1.0 + z / self._finite))

    def back(self, straight: np.ndarray) -> np.ndarray:
        """Return the coordinates (..., k) of straightened ones."""
        return np.where(np.isinf(self.scale), straight, self._finite * np.expm1(straight / self._finite))

    @property
    def _finite(self) -> np.ndarray:
        return np.where(np.isinf(self.scale), 1.0, self.scale)


@dataclass(frozen=True, eq=False)
class Local:
    """Curves near some coordinates, simulated there; the least squares over runs.

    Parameters
    ----------
    at : ndarray, shape (k,)
        Coordinates through whose curves these go.
    value : ndarray, shape (n_all,)
        The curves there [nm].
    slope : ndarray, shape (n_all, k)
        By straightened coordinates [nm].
    middle : ndarray, shape (k,)
        The straightened coordinates around which the runs lie.
    straight
        How coordinates are straightened.
    axes : ndarray, shape (k, m)
        Directions along which the curves bend; their products with straightened coordinates count standard deviations.
    bend : ndarray, shape (n_all, m (m + 1) / 2)
        Second derivatives of the curves along each, then along each two [nm].
    scatter : ndarray, shape (n_all, n_all)
        Covariance of what the runs depart from this [nm^2].
    """

    at: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    middle: np.ndarray
    straight: Straight
    axes: np.ndarray
    bend: np.ndarray
    scatter: np.ndarray

    @classmethod
    def through(
        cls,
        curve: np.ndarray,
        places: np.ndarray,
        curves: np.ndarray,
        axes: np.ndarray,
        straight: Straight,
        known: np.ndarray | float = 0.0,
    ) -> Local:
        """Return what fits runs with `curves` (m, n_all) at `places` (m, k), moved through a `curve` at the first.

        Slopes by coordinates that no run moves are `known` (n_all, k).
        """
        off = straight.of(places)
        middle, extent = off[0], np.ptp(off, axis=0)
        off, scale = off - middle, np.where(extent > STILL, extent, np.inf)
        terms = np.column_stack([np.ones(len(off)), off / scale, _second_order(off @ axes)])
        found, _, rank, _ = np.linalg.lstsq(terms, curves, rcond=1e-8)
        left = curves - terms @ found
        scatter = left.T @ left / max(len(terms) - rank, 1)
        slope, bend = np.split(found[1:], [len(middle)])
        return cls(places[0], curve, (slope / scale[:, None]).T + known, middle, straight, axes, bend.T, scatter)

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """Return the curves (m, n_all) at coordinates z (m, k) [nm]."""
        straight, at = self.straight.of(z), self.straight.of(self.at[None])
        rise = _second_order((straight - self.middle) @ self.axes) - _second_order((at - self.middle) @ self.axes)
        return self.value + (straight - at) @ self.slope.T + rise @ self.bend.T

    def slope_at(self, z: np.ndarray) -> np.ndarray:
        """Return the slope (n_all, k) of the curves at coordinates z (k,) [nm]."""
        along = (self.straight.of(z) - self.middle) @ self.axes
        return (self.slope + self.bend @ _slope_of_second_order(along) @ self.axes.T) * self.straight.slope(z)

    def moved(self, at: np.ndarray, curve: np.ndarray) -> Local:
        """Return the same shape through what was simulated elsewhere."""
        return replace(self, at=at, value=curve)


def _second_order(along: np.ndarray) -> np.ndarray:
    """Return what unit second derivatives add at distances (n, m) along axes, straight on beyond the ends.

    First half the square of each distance, then the product of each two.
    """
    within = np.clip(along, -REACH, REACH)
    first, second = np.triu_indices(along.shape[1], 1)
    return np.hstack([within * (along - 0.5 * within), within[:, first] * within[:, second]])


def _slope_of_second_order(along: np.ndarray) -> np.ndarray:
    """Return the derivatives of these by distances (m,) along axes."""
    within, inside = np.clip(along, -REACH, REACH), np.diag(1.0 * (np.abs(along) < REACH))
    first, second = np.triu_indices(len(along), 1)
    return np.vstack([np.diag(within), within[second, None] * inside[first] + within[first, None] * inside[second]])


def design(
    centre: np.ndarray, covariance: np.ndarray, straight: Straight, moved: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return places (m, k) around a centre (k,), and the axes (k, n) along which they tell how the curves bend.

    The covariance (k, k) is that of the coordinates, the axes are those of straightened ones. Only those coordinates
    vary that are to be `moved` (k,); by default all.
    """
    middle, slope = straight.of(centre), straight.slope(centre)
    among = np.eye(len(centre))[:, np.ones(len(centre), dtype=bool) if moved is None else moved]
    variances, axes = np.linalg.eigh(among.T @ (covariance * np.outer(slope, slope)) @ among)
    deviations, axes = np.sqrt(variances), among @ axes
    steps = (axes * deviations).T
    known, widest = steps[:-BENT], steps[-BENT:]
    both = np.array([a + b for a, b in itertools.combinations(widest, 2)]).reshape(-1, len(centre))
    straightened = straight.of(np.zeros_like(centre)), straight.of(np.ones_like(centre))
    ends = [_end(middle, step, *straightened) for step in np.vstack([widest, -widest])]
    places = middle + np.vstack([known, -known, both, -both, ends])
    return straight.back(places), axes[:, -BENT:] / deviations[-BENT:]


def _end(middle: np.ndarray, step: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return `step` (k,) as far as `REACH` of it goes from a middle within bounds, but never less than the step."""
    room = np.where(step > 0.0, upper - middle, middle - lower) / np.maximum(np.abs(step), 1e-12)
    return step * np.clip(room.min(), 1.0, REACH)
