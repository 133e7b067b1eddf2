"""Banded systems with LAPACK: Cholesky where the matrix is symmetric, pivoted LU where it is not."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack


def allocate(size: int, bandwidth: int, symmetric: bool) -> np.ndarray:
    """Return storage for a matrix: entry (i, j) belongs in ``band[j, diagonal(band, bandwidth) + i - j]``.

    A symmetric matrix is stored as its lower half. A general one takes `bandwidth` columns more, which pivoting fills.
    """
    return np.empty((size, bandwidth + 1 if symmetric else 3 * bandwidth + 1))


def diagonal(band: np.ndarray, bandwidth: int) -> int:
    """Return the column of `band` that holds the diagonal."""
    return band.shape[1] - 1 - bandwidth


def solve(band: np.ndarray, bandwidth: int, right: np.ndarray, definite: bool) -> np.ndarray | None:
    """Solve for the columns of `right` (size, k), overwriting `band`.

    Parameters
    ----------
    band
        The matrix, see `allocate`.
    bandwidth
        Number of entries beside the diagonal.
    right : ndarray, shape (size, k)
        Right-hand sides.
    definite
        Whether the symmetric part should be positive definite.

    Returns
    -------
    ndarray, shape (size, k), or None
        None where a symmetric matrix is not positive definite, a general one is singular, or its symmetric part is not
        positive definite although it should be (`definite`).
    """
    middle = diagonal(band, bandwidth)
    if middle == 0:
        factor, failed = lapack.dpbtrf(band.T, lower=1, overwrite_ab=1)
        return None if failed else lapack.dpbtrs(factor, right, lower=1)[0]
    if definite and lapack.dpbtrf(symmetric_part(band, bandwidth).T, lower=1, overwrite_ab=1)[1]:
        return None
    factor, pivots, failed = lapack.dgbtrf(band.T, bandwidth, bandwidth, overwrite_ab=1)
    return None if failed else lapack.dgbtrs(factor, bandwidth, bandwidth, right, pivots)[0]


def symmetric_part(band: np.ndarray, bandwidth: int) -> np.ndarray:
    """Return the lower half (size, bandwidth + 1) of the symmetric part of a general matrix."""
    middle, size = diagonal(band, bandwidth), len(band)
    half = np.zeros((size, bandwidth + 1))
    for k in range(bandwidth + 1):
        half[: size - k, k] = 0.5 * (band[: size - k, middle + k] + band[k:, middle - k])
    return half
