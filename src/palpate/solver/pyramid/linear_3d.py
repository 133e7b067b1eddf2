"""One hexahedron at small strains.

The volumetric strain of an element is the mean of tr E over it, against locking (B-bar; Hughes, Int. J. Numer. Meth.
Eng. 15 (1980) 1413-1418). With the gradients g_a of the shape functions and v_a = R g_a, the deviatoric stiffness of
the displacements i of node a and j of node b is a sum over the Gauss points,

    K_ai,bj = sum w (q/rho) (delta_ij g_a.g_b/2 + g_aj g_bi/2 - g_ai g_bj/3) + w (dq/drho - q/rho)/(2 rho^2) v_ai v_bj,

so all that must be summed is g_ai g_bj and v_ai v_bj with their weights. Where the pressure acts on the flow, its
derivative dq/dp adds the symmetric half of an unsymmetric part.

Arguments of `element`, here and in `palpate.solver.pyramid.hencky_3d`:

- `gradients` (8, 8, 3), `volumes` (8,): gradients of the shape functions at each Gauss point [1/um], and its volume
  [um^3]
- `u` (8, 3): displacements of the nodes [um]
- `points`: `Points3D`
- `law`: weights (w,) of the law in the time step, and its row (c,), see `palpate.materials.flow.row`
- `ke` (24 or more, same), `fe` (24 or more,): out: stiffness and internal force
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.point import length, residual, solve
from palpate.materials.flow.radial import borne
from palpate.materials.flow.row import BULK, SPLIT

COMPONENTS, DISPLACEMENTS = 6, 24


class Points3D(NamedTuple):
    """The eight Gauss points of an element; of m elements every shape begins with m.

    Attributes
    ----------
    past, back : ndarray, shape (8, 6)
        Strain and back stress fixed by the history, see `palpate.materials.flow.point.history`.
    alpha : ndarray, shape (8,)
        Hardening variable, likewise.
    guesses : ndarray, shape (8,)
        Invariant q [GPa]; in: the last one; out: the solution.
    local : ndarray, shape (8, 6)
        Out: the tensor R of the radial equation.
    """

    past: np.ndarray
    back: np.ndarray
    alpha: np.ndarray
    guesses: np.ndarray
    local: np.ndarray


@inner_kernel(cache=True)
def element(gradients, volumes, u, points, law, ke, fe):
    """Write stiffness `ke` and internal force `fe` of one element, and the solution at its `points`.

    Returns
    -------
    float
        Pressure of the element [GPa], positive in compression.
    """
    past, back, alpha, guesses, local = points
    weights, row = law
    volume = volumes.sum()
    mean = np.zeros(DISPLACEMENTS)
    v = np.empty(DISPLACEMENTS)
    sums = np.zeros((DISPLACEMENTS, DISPLACEMENTS))
    rank_one = np.zeros((DISPLACEMENTS, DISPLACEMENTS))
    force, squeeze = np.zeros(DISPLACEMENTS), np.zeros(DISPLACEMENTS)
    for g in range(8):
        flat = gradients[g].reshape(DISPLACEMENTS)
        for i in range(DISPLACEMENTS):
            mean[i] += volumes[g] / volume * flat[i]
    theta = 0.0
    for a in range(8):
        for i in range(3):
            theta += mean[3 * a + i] * u[a, i]
    pressure = -row[BULK] * theta
    for g in range(8):
        flat = gradients[g].reshape(DISPLACEMENTS)
        local[g] = 0.0
        for a in range(8):
            gx, gy, gz = gradients[g, a]
            ux, uy, uz = u[a]
            local[g, 0] += gx * ux
            local[g, 1] += gy * uy
            local[g, 2] += gz * uz
            local[g, 3] += 0.5 * (gx * uy + gy * ux)
            local[g, 4] += 0.5 * (gy * uz + gz * uy)
            local[g, 5] += 0.5 * (gz * ux + gx * uz)
        third = (local[g, 0] + local[g, 1] + local[g, 2]) / 3.0
        for i in range(3):
            local[g, i] -= third
        local[g] = residual(local[g], past[g], weights)
        xx, yy, zz, xy, yz, zx = local[g]
        rho = length(local[g], COMPONENTS)
        q, slope, push = solve(rho, guesses[g], alpha[g], pressure, weights, row)
        guesses[g] = q
        ratio, order, push = borne(q / rho if rho > 0.0 else slope, slope * rho / q if q > 0.0 else 1.0, push, weights)
        bxx, byy, bzz, bxy, byz, bzx = back[g]
        for a in range(8):
            gx, gy, gz = gradients[g, a]
            force[3 * a] += volumes[g] * (bxx * gx + bxy * gy + bzx * gz)
            force[3 * a + 1] += volumes[g] * (bxy * gx + byy * gy + byz * gz)
            force[3 * a + 2] += volumes[g] * (bzx * gx + byz * gy + bzz * gz)
            v[3 * a] = xx * gx + xy * gy + zx * gz
            v[3 * a + 1] = xy * gx + yy * gy + yz * gz
            v[3 * a + 2] = zx * gx + yz * gy + zz * gz
        radial, changed = volumes[g] * ratio, volumes[g] * weights[SPLIT] * ratio
        extra = changed * (order - 1.0) / (2.0 * rho * rho) if rho > 0.0 else 0.0
        pushed = 0.5 * volumes[g] * push * row[BULK] / rho if rho > 0.0 else 0.0
        for i in range(DISPLACEMENTS):
            force[i] += radial * v[i]
            squeeze[i] += pushed * v[i]
            s, t = changed * flat[i], extra * v[i]
            for j in range(DISPLACEMENTS):
                sums[i, j] += s * flat[j]
                rank_one[i, j] += t * v[j]
    stiffness = row[BULK] * volume
    for i in range(DISPLACEMENTS):
        fe[i] = force[i] + stiffness * theta * mean[i]
    for a in range(8):
        for b in range(8):
            trace = 0.0
            for i in range(3):
                trace += sums[3 * a + i, 3 * b + i]
            for i in range(3):
                for j in range(3):
                    p, r = 3 * a + i, 3 * b + j
                    value = 0.5 * sums[3 * a + j, 3 * b + i] - sums[p, r] / 3.0
                    if i == j:
                        value += 0.5 * trace
                    value -= mean[p] * squeeze[r] + squeeze[p] * mean[r]
                    ke[p, r] = value + rank_one[p, r] + stiffness * mean[p] * mean[r]
    return pressure
