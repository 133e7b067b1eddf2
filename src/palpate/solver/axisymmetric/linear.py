"""Matrices of elements at small strains that the geometry alone fixes: M = B^T I_dev B, and the mean of tr B."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def fixed_matrices(gradients, volumes):
    """Return the deviatoric matrices M (m, 4, 8, 8) times volume, and the mean rows of tr B (m, 8)."""
    count = gradients.shape[0]
    deviatoric = np.zeros((count, 4, 8, 8))
    dilatation = np.zeros((count, 8))
    b = np.zeros((4, 8))
    for e in range(count):
        volume = volumes[e].sum()
        for g in range(4):
            weight = volumes[e, g]
            for a in range(4):
                nr, nz, nt = gradients[e, g, 0, a], gradients[e, g, 1, a], gradients[e, g, 2, a]
                b[0, 2 * a], b[1, 2 * a + 1], b[2, 2 * a] = nr, nz, nt
                b[3, 2 * a], b[3, 2 * a + 1] = 0.5 * nz, 0.5 * nr
                dilatation[e, 2 * a] += weight / volume * (nr + nt)
                dilatation[e, 2 * a + 1] += weight / volume * nz
            for i in range(8):
                third = (b[0, i] + b[1, i] + b[2, i]) / 3.0
                for j in range(8):
                    value = 2.0 * b[3, i] * b[3, j]
                    for k in range(3):
                        value += (b[k, i] - third) * b[k, j]
                    deviatoric[e, g, i, j] = weight * value
    return deviatoric, dilatation
