r"""Weighted least squares of simulated curves against recorded ones, with a prior.

What is minimised, in coordinates u with the prior of `palpate.models.coordinates`, is

    chi^2(u) = r^T (C + d^2 I)^-1 r + sum departures(u)^2,    r = simulated - recorded depth,

with the covariance C of the errors: noise of the recordings, error of the solver and, near the end of a search, the
discrepancy of the law. Farther away, or where the law is taken to be exact and is not, more is left; that remainder is
taken to be the same at all points, with the variance d^2 that makes chi^2 of the curves equal to its degrees of freedom
(method of moments). It is zero for a model that explains the recordings. Weighting a remainder by the noise alone would
sacrifice the level of a curve to its smallest details. Independent measurements of the parameters, such as the drift
rate in a hold at low load, join with their departures in standard deviations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import brentq

from palpate.models.coordinates import Coordinates
from palpate.models.forward import Curves, Forward

STEP = 1e-4  # of a range, over which departures from independent measurements are differenced
BEYOND_ANY = 1e6  # times the mean square of the residual, an upper bound of the remainder


@dataclass(frozen=True, eq=False)
class Misfit:
    """How far curves lie from recorded ones.

    Parameters
    ----------
    measured : ndarray, shape (n,)
        Mean recorded curves, one condition after the other [nm].
    covariance : ndarray, shape (n, n)
        Of the errors [nm^2].
    stacked
        Returns curves or slopes (n_points, ...) of all conditions one after the other (n, ...), in nm.
    coordinates
        Of the parameters.
    independent
        Returns the departures (m,) [standard deviations] of coordinates u (k,) from independent measurements of
        amplitudes.
    allow_remainder
        Whether a remainder is estimated; else it is zero.
    """

    measured: np.ndarray
    covariance: np.ndarray
    stacked: Callable[[Curves], np.ndarray]
    coordinates: Coordinates
    independent: Callable[[np.ndarray], np.ndarray] = lambda u: np.empty(0)
    allow_remainder: bool = True

    @cached_property
    def principal(self) -> tuple[np.ndarray, np.ndarray]:
        """Variances (n,) [nm^2] and directions (n, n) of the errors."""
        return np.linalg.eigh(self.covariance)

    @cached_property
    def _inverse_factor(self) -> np.ndarray:
        """Inverse (n, n) of the lower Cholesky factor of the covariance."""
        factor = cholesky(self.covariance, lower=True)
        return solve_triangular(factor, np.eye(len(factor)), lower=True)

    def curves(self, model: Forward, points: Sequence[np.ndarray]) -> list[np.ndarray | str]:
        """Return a model's curves (n,) [nm] at each of the points (k,), or why it failed."""
        return [found if isinstance(found, str) else self.stacked(found) for found in model.curves(points)]

    def tangents(self, model: Forward, points: Sequence[np.ndarray]) -> list[tuple[np.ndarray, np.ndarray] | str]:
        """Return the same with the slopes (n, k) [nm]."""
        return [
            found if isinstance(found, str) else (self.stacked(found[0]), self.stacked(found[1]))
            for found in model.tangents(points)
        ]

    def residual(self, curve: np.ndarray) -> np.ndarray:
        """Return a simulated less the recorded curve (n,) [nm]."""
        return curve - self.measured

    def remainder(self, residual: np.ndarray) -> float:
        """Return the variance d^2 [nm^2] of the remainder, see the module."""
        if not self.allow_remainder:
            return 0.0
        return remainder(residual, *self.principal, len(self.coordinates.free))

    def weights(self, remainder: float) -> np.ndarray:
        """Return the matrix (n, n) that whitens residuals and derivatives in nm."""
        if not self.allow_remainder:
            return self._inverse_factor
        variances, directions = self.principal
        floor = 1e-12 * max(float(variances.max()), remainder)
        return (directions / np.sqrt(np.maximum(variances, floor) + remainder)).T

    def chi_square(self, curve: np.ndarray, u: np.ndarray, weights: np.ndarray) -> float:
        """Return the misfit of a curve (n,) [nm] at coordinates u (k,), prior included."""
        return float(np.sum((weights @ self.residual(curve)) ** 2) + np.sum(self.of_parameters(u) ** 2))

    def of_parameters(self, u: np.ndarray) -> np.ndarray:
        """Return the departures (k + m,) [standard deviations] from the prior and from independent measurements."""
        return np.append(self.coordinates.departures(u), self.independent(u))

    def slopes_of_parameters(self, u: np.ndarray) -> np.ndarray:
        """Return their derivatives (k + m, k) by the coordinates."""
        return np.vstack([self.coordinates.slopes_of_departures(u), central_slopes(self.independent, u)])


def remainder(residual: np.ndarray, variances: np.ndarray, directions: np.ndarray, parameters: int) -> float:
    """Return the variance d^2 [nm^2] of the remainder, see the module.

    Parameters
    ----------
    residual : ndarray, shape (n,)
        What the model leaves [nm].
    variances, directions : ndarray, shape (n,) and (n, n)
        Of the known errors [nm^2].
    parameters
        Number of parameters that were fitted.
    """
    squares, freedom = (directions.T @ residual) ** 2, max(len(residual) - parameters, 1)
    largest = BEYOND_ANY * float(np.mean(residual**2))

    def above_freedom(more: float) -> float:
        return float(np.sum(squares / (np.maximum(variances, 0.0) + more))) - freedom

    least = 1e-12 * largest
    if largest == 0.0 or above_freedom(least) <= 0.0:
        return 0.0
    return float(brentq(above_freedom, least, largest, rtol=1e-10))


def central_slopes(values: Callable[[np.ndarray], np.ndarray], u: np.ndarray) -> np.ndarray:
    """Return the central differences (m, k) of values (m,) by coordinates u (k,), over `STEP` to either side."""
    steps = STEP * np.eye(len(u))
    return np.stack([(values(u + step) - values(u - step)) / (2.0 * STEP) for step in steps], axis=1)


def by_misfit(
    misfit: Misfit, weights: np.ndarray, model: Forward, places: Sequence[np.ndarray]
) -> list[tuple[float, np.ndarray]]:
    """Return coordinates (k,) with their misfit, the least first; it is infinite where the model fails.

    Parameters
    ----------
    misfit
        The least-squares problem.
    weights : ndarray, shape (n, n)
        Matrix that whitens curves [nm].
    model
        Gives the curves.
    places
        The coordinates.
    """
    outcomes = zip(misfit.curves(model, places), places, strict=True)
    found = [(np.inf if isinstance(c, str) else misfit.chi_square(c, u, weights), u) for c, u in outcomes]
    return sorted(found, key=lambda each: each[0])
