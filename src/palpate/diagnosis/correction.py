"""What the forward model adds to the surrogates' curves near some coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class Correction:
    """Forward model less surrogates, a plane which each run moves, and tilts by the secant between two runs.

    Parameters
    ----------
    at : ndarray, shape (k,)
        The coordinates.
    value : ndarray, shape (n_all,)
        There [nm].
    slope : ndarray, shape (n_all, k)
        [nm]
    """

    at: np.ndarray
    value: np.ndarray
    slope: np.ndarray

    @classmethod
    def none(cls, points: int, dimensions: int) -> Correction:
        """Return the correction that trusts the surrogates."""
        return cls.constant(np.zeros(dimensions), np.zeros(points))

    @classmethod
    def constant(cls, at: np.ndarray, value: np.ndarray) -> Correction:
        """Return the correction that is known at some coordinates (k,) alone, and the same everywhere."""
        return cls(at, value, np.zeros((len(value), len(at))))

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """Return the values (m, n_all) at coordinates z (m, k) [nm]."""
        return self.value + (z - self.at) @ self.slope.T

    def widened(self, dimensions: int) -> Correction:
        """Return the correction for an explanation with more coordinates, on which it does not depend."""
        more = dimensions - len(self.at)
        return Correction(np.pad(self.at, (0, more)), self.value, np.pad(self.slope, ((0, 0), (0, more))))

    def with_secant(self, z: np.ndarray, value: np.ndarray) -> Correction:
        """Return the correction that is `value` (n_all,) at z (k,), too, its slope changed as little as this demands.

        Source: C.G. Broyden, Math. Comp. 19 (1965) 577-593, eq. 4.5.
        """
        step = z - self.at
        missed = value - self(z)
        return replace(self, slope=self.slope + np.outer(missed, step) / (step @ step))

    def moved(self, at: np.ndarray, value: np.ndarray) -> Correction:
        """Return the correction with a new value elsewhere, the slope that of the secant between both places."""
        return replace(self.with_secant(at, value), at=at, value=value)
