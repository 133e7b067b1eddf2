"""What is linear in the coordinates of an explanation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Plane:
    """Curves, or what is added to them, by value and slope at some coordinates.

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

    def __call__(self, z: np.ndarray) -> np.ndarray:
        """Return the values (m, n_all) at coordinates z (m, k) [nm]."""
        return self.value + (z - self.at) @ self.slope.T
