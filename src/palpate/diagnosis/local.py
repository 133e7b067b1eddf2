"""The forward model's own curves around an optimum: linear in the coordinates, fitted to a design of runs.

Where recordings leave parameters open, the curves hardly change between them; nor are they far from linear there. A
surrogate's error, which is as rough as its snapshots are far apart, may exceed that change, so that its slopes make
known what is not. A two-level design (Plackett & Burman, Biometrika 33 (1946) 305-325), in which every run moves all
coordinates, tells slopes with the least error for its number of runs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import circulant, hadamard

from palpate.diagnosis.plane import Plane

TWELVE = np.array([1, 1, -1, 1, 1, 1, -1, -1, -1, 1, -1])  # Plackett and Burman's first of twelve runs


@dataclass(frozen=True, eq=False)
class Local(Plane):
    """Curves near some coordinates, simulated there; the slope is one by least squares over runs.

    Parameters
    ----------
    at, value, slope
        See `palpate.diagnosis.plane.Plane`.
    scatter : ndarray, shape (n_all, n_all)
        Covariance of what the runs depart from a plane [nm^2].
    """

    scatter: np.ndarray

    @classmethod
    def through(cls, at: np.ndarray, curve: np.ndarray, places: np.ndarray, curves: np.ndarray) -> Local:
        """Return the plane over the runs that gave `curves` (m, n_all) at `places` (m, k), moved through one."""
        scale = np.ptp(places, axis=0) + 1e-9
        terms = np.column_stack([np.ones(len(places)), (places - at) / scale])
        found = np.linalg.lstsq(terms, curves, rcond=1e-8)[0]
        left = curves - terms @ found
        return cls(at, curve, (found[1:] / scale[:, None]).T, left.T @ left / max(len(terms) - terms.shape[1], 1))

    def moved(self, at: np.ndarray, curve: np.ndarray) -> Local:
        """Return the same plane through what was simulated elsewhere."""
        return replace(self, at=at, value=curve)


def two_level(centre: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return a design (m, k) of one standard deviation up or down along every principal axis of a covariance (k, k)."""
    variances, axes = np.linalg.eigh(covariance)
    return centre + _levels(len(centre)) @ (axes * np.sqrt(variances)).T


def _levels(factors: int) -> np.ndarray:
    """Return orthogonal columns (m, factors) of levels -1 and 1."""
    if 7 < factors < 12:
        return np.vstack([circulant(TWELVE).T, -np.ones(11)])[:, :factors]
    return hadamard(2 ** int(np.ceil(np.log2(factors + 1))))[:, 1 : factors + 1]
