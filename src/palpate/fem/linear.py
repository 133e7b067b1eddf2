"""One element at small strains: everything that the geometry fixes is integrated once, when the mesh is made.

At a Gauss point  K = (q/rho) M + (dq/drho - q/rho)/(2 rho^2) v v^T  with  M = B^T I_dev B  fixed and  v = B^T R.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from palpate.fem.scalar_radial import BULK, invariant, solve_radial


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


@njit(cache=True)
def element(gradients, volumes, deviatoric, dilatation, u, past, alpha, guesses, weights, row, local, ke, fe):
    """Write stiffness `ke` and internal force `fe` of one element; `local` (4, 4) receives R, `guesses` (4,) q."""
    v = np.empty(8)
    volume = volumes[0] + volumes[1] + volumes[2] + volumes[3]
    theta = 0.0
    for i in range(8):
        theta += dilatation[i] * u[i]
    stiffness = row[BULK] * volume
    for i in range(8):
        fe[i] = stiffness * theta * dilatation[i]
        for j in range(8):
            ke[i, j] = stiffness * dilatation[i] * dilatation[j]
    for g in range(4):
        err, ezz, ett, erz = 0.0, 0.0, 0.0, 0.0
        for a in range(4):
            nr, nz = gradients[g, 0, a], gradients[g, 1, a]
            err += nr * u[2 * a]
            ezz += nz * u[2 * a + 1]
            ett += gradients[g, 2, a] * u[2 * a]
            erz += 0.5 * (nz * u[2 * a] + nr * u[2 * a + 1])
        mean = (err + ezz + ett) / 3.0
        r0, r1 = err - mean - past[g, 0], ezz - mean - past[g, 1]
        r2, r3 = ett - mean - past[g, 2], erz - past[g, 3]
        local[g, 0], local[g, 1], local[g, 2], local[g, 3] = r0, r1, r2, r3
        rho = invariant(r0, r1, r2, r3)
        q, slope = solve_radial(rho, guesses[g], alpha[g], weights, row)
        guesses[g] = q
        ratio = q / rho if rho > 0.0 else slope
        rank_one = volumes[g] * (slope - ratio) / (2.0 * rho * rho) if rho > 0.0 else 0.0
        for a in range(4):
            nr, nz = gradients[g, 0, a], gradients[g, 1, a]
            v[2 * a] = r0 * nr + r2 * gradients[g, 2, a] + r3 * nz
            v[2 * a + 1] = r1 * nz + r3 * nr
        scale = volumes[g] * ratio
        for i in range(8):
            fe[i] += scale * v[i]
            vi = rank_one * v[i]
            for j in range(8):
                ke[i, j] += ratio * deviatoric[g, i, j] + vi * v[j]
    return True
