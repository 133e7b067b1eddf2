r"""Proper orthogonal decomposition: the few curves from which all snapshots are made.

Y (n_snapshots, n_points) is factored as Y = U S V^T (thin SVD); the first K right singular vectors are the modes
and the coordinates of the snapshots are Y V_K. The snapshots are not centred, as in chapter 4 of the thesis,
so the first mode is close to the mean curve. The energy of K modes is sum_{k<=K} s_k^2 / sum_k s_k^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class POD:
    """Modes of a set of snapshots.

    Attributes
    ----------
    modes : ndarray, shape (n_modes, n_points)
        Orthonormal rows.
    energy : ndarray
        Cumulative fraction of the energy, one entry for each singular value, the largest first.
    """

    modes: np.ndarray
    energy: np.ndarray

    def reduce(self, curves: np.ndarray) -> np.ndarray:
        """Coordinates (n, n_modes) of curves (n, n_points)."""
        return curves @ self.modes.T

    def expand(self, coordinates: np.ndarray) -> np.ndarray:
        """Curves (n, n_points) from coordinates (n, n_modes)."""
        return coordinates @ self.modes


def pod(curves: np.ndarray, *, energy: float, n_modes: int | None = None) -> POD:
    """Decompose `curves` (n_snapshots, n_points) [nm].

    Parameters
    ----------
    energy
        The fewest modes that keep this fraction of the energy are kept, when `n_modes` is not given.
    n_modes
        Number of modes, at most the number of singular values.
    """
    _, singular, modes = np.linalg.svd(curves, full_matrices=False)
    total = float(np.sum(singular**2))
    cumulative = np.cumsum(singular**2) / total if total > 0 else np.ones_like(singular)
    if n_modes is None:
        n_modes = int(np.searchsorted(cumulative, min(energy, cumulative[-1]))) + 1
    return POD(modes[:n_modes], cumulative)
