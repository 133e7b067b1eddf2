"""Orthonormal bases of whitened effects, some of which may vanish or depend on others."""

from __future__ import annotations

import numpy as np

VANISHES = 1e-9  # standard deviations of the noise: an effect that is none
DEPENDENT = 1e-10  # singular value of unit columns, below which they are linearly dependent


def orthonormal(columns: np.ndarray, beside: np.ndarray | None = None, least: float = DEPENDENT) -> np.ndarray:
    """Return an orthonormal basis of the part of whitened columns outside that of another one; may be empty.

    Parameters
    ----------
    columns : ndarray, shape (n_all, m)
        Effects, some of which may vanish or be dependent.
    beside : ndarray, shape (n_all, k), optional
        An orthonormal basis.
    least
        Singular value of what is left of unit columns, below which a direction does not count.
    """
    scale = np.linalg.norm(columns, axis=0)
    left = columns[:, scale > VANISHES] / scale[scale > VANISHES]
    if beside is not None:
        left = left - beside @ (beside.T @ left)
    u, s, _ = np.linalg.svd(left, full_matrices=False)
    return u[:, s > least]
