"""What distinguishes recordings of one condition: their contrasts, or what is left of a residual beside slow trends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import helmert

from palpate.data.noise import point_noise, slope_by_rho

DEGREE = 3  # of the polynomials that count as slow trends
LEAST_LEFT = 0.25  # of the points, beside slow trends


@dataclass(frozen=True, eq=False)
class Replicates:
    """Deviations of one condition's recordings from their mean.

    Parameters
    ----------
    contrasts : ndarray, shape (k, d)
        Independent vectors with covariance ``basis @ K @ basis.T`` [nm].
    basis : ndarray, shape (d, n)
        The identity, or what projects smooth trends out.
    components : mapping of ndarray, shape (n, n)
        Matrix M of each variance component.
    scale
        Largest depth [nm].
    """

    contrasts: np.ndarray
    basis: np.ndarray
    components: Mapping[str, np.ndarray]
    scale: float

    @cached_property
    def parts(self) -> dict[str, np.ndarray]:
        """Matrix (d, d) of each variance component in the basis."""
        return {name: self.in_basis(component) for name, component in self.components.items()}

    def in_basis(self, matrix: np.ndarray) -> np.ndarray:
        """Return a covariance (n, n) in the basis (d, d), which is the identity where it has n rows."""
        return self.basis @ matrix @ self.basis.T if len(self.basis) < len(matrix) else matrix

    def with_parts(self, points: np.ndarray, variances: Mapping[str, float]) -> np.ndarray:
        """Return the covariance (d, d) in the basis: of the point noise and of the variance components."""
        return points + sum(variances[name] * part for name, part in self.parts.items())

    def points(self, sigma: float, autocorrelation: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the point noise's covariance (d, d) in the basis, and its derivative by logit rho."""
        size = self.basis.shape[1]
        return self.in_basis(point_noise(sigma, autocorrelation, size)), self.in_basis(
            slope_by_rho(sigma, autocorrelation, size)
        )


def contrasts(depth: np.ndarray) -> np.ndarray:
    """Return orthonormal contrasts (R - 1, n) of replicates (R, n)."""
    return helmert(len(depth)) @ depth


def without_trend(segments: Sequence[np.ndarray]) -> np.ndarray:
    """Return an orthonormal basis (d, n) of what is left when each segment (bool, n) loses a polynomial.

    Where that would leave less than `LEAST_LEFT` of the points, or than two, the degree is lower, or nothing is lost.
    """
    count = len(segments[0])
    for degree in range(DEGREE, -1, -1):
        trends = _trends(segments, degree)
        if count - len(trends) >= max(LEAST_LEFT * count, 2):
            return np.linalg.qr(np.column_stack(trends), mode="complete")[0][:, len(trends) :].T
    return np.eye(count)


def _trends(segments: Sequence[np.ndarray], degree: int) -> list[np.ndarray]:
    """Return the powers (n,) of each segment (bool, n) up to a degree."""
    trends = []
    for segment in segments:
        x = np.linspace(-1, 1, int(segment.sum()))
        for power in range(min(degree, len(x) - 1) + 1):
            column = np.zeros(len(segment))
            column[segment] = x**power
            trends.append(column)
    return trends
