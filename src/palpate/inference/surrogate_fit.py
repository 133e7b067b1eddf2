r"""Generalised least squares on the surrogates, inside the bounds.

Minimises chi^2(u) = r^T C^-1 r with r = surrogate(u) - mean measured depth, one condition after
the other, by SciPy's trust-region reflective method on the whitened residuals L^-1 r, C = L L^T.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares

from palpate.inference.surrogate_space import Space

AT_BOUND = 1e-3  # of a range


class Predictor(Protocol):
    """What a surrogate must offer."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Curves (n, n_points) [nm] at parameters (n, p)."""

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Slope (n_points, p) of the curve at parameters (p,)."""


@dataclass(frozen=True, eq=False)
class WeightedFit:
    """The least-squares problem.

    Parameters
    ----------
    space
        The parameters.
    surrogates
        Predictor of each condition.
    measured
        Mean depth (n_points,) of each condition [nm].
    covariance
        Covariance C (n, n) of all means, one condition after the other in the order of `measured` [nm^2].
    """

    space: Space
    surrogates: Mapping[str, Predictor]
    measured: Mapping[str, np.ndarray]
    covariance: np.ndarray
    factor: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "factor", cholesky(self.covariance, lower=True))

    def curves(self, u: np.ndarray) -> dict[str, np.ndarray]:
        """Surrogate curve (n_points,) of each condition at scaled coordinates u (k,) [nm]."""
        x = self.space.physical(u)
        return {name: self.surrogates[name].predict(x)[0] for name in self.measured}

    def residual(self, u: np.ndarray) -> np.ndarray:
        """Whitened residuals of all conditions, one after the other."""
        return self.whiten({name: curve - self.measured[name] for name, curve in self.curves(u).items()})

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Slope (n_residuals, k) of `residual`."""
        x, free = self.space.physical(u)[0], self.space.free
        extent = self.space.extent[free]
        return self.whiten({name: self.surrogates[name].jacobian(x)[:, free] * extent for name in self.measured})

    def whiten(self, parts: Mapping[str, np.ndarray]) -> np.ndarray:
        """L^-1 applied to a vector or matrix for each condition, stacked."""
        return solve_triangular(self.factor, np.concatenate([parts[name] for name in self.measured]), lower=True)

    def chi_square(self, curves: Mapping[str, np.ndarray]) -> float:
        """Misfit chi^2 of any curves, one for each condition."""
        return float(np.sum(self.whiten({name: curves[name] - self.measured[name] for name in self.measured}) ** 2))

    def at_bound(self, u: np.ndarray) -> np.ndarray:
        """Return which coordinates (k,) lie on a bound."""
        return (u < AT_BOUND) | (u > 1 - AT_BOUND)

    def solve(self, starts: Iterable[np.ndarray]) -> np.ndarray:
        """Coordinates (k,) of least chi^2 among the minima reached from the starts."""
        found = [
            least_squares(self.residual, np.clip(u, 1e-6, 1 - 1e-6), self.jacobian, bounds=(0.0, 1.0), max_nfev=200)
            for u in starts
        ]
        return min(found, key=lambda result: result.cost).x
