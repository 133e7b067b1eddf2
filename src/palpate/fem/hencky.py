"""One element at large strains and rotations: Hencky's logarithmic strain in the law of the radial family.

E = (1/2) ln(F^T F), so any law written for small strains becomes one for large strains, with the same update
(Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425). In the axes of the right stretch,
with squared stretches l_a and the divided difference d = (ln l_1 - ln l_2) / (2 (l_1 - l_2)),

    dE_aa = dC_aa / (2 l_a),   dE_12 = d dC_12,

and the second derivative follows from the second divided differences. tr E = ln J, averaged over the element.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.materials.radial import BULK, invariant, solve_radial

COS, SIN, L1, L2, L3, DIFFERENCE, SPREAD = range(7)


@njit(cache=True)
def strain_at(gradients, u, strain, b, frame):
    """Logarithmic strain at a Gauss point in the axes of the right stretch.

    Parameters
    ----------
    gradients : ndarray, shape (3, 4)
    u : ndarray, shape (8,)
    strain : ndarray, shape (3,)
        Out: E along the axes 1 and 2 and the hoop; the shear vanishes.
    b : ndarray, shape (4, 8)
        Out: dE/du for 11, 22, hoop and 12.
    frame : ndarray, shape (7,)
        Out: cosine and sine of the axes, l_1, l_2, l_3, d, and (l_1 - l_2) / (l_1 + l_2).

    Returns
    -------
    bool
        False when the deformation turns the element inside out.
    """
    hrr, hrz, hzr, hzz, htt = 0.0, 0.0, 0.0, 0.0, 0.0
    for a in range(4):
        nr, nz = gradients[0, a], gradients[1, a]
        hrr += nr * u[2 * a]
        hrz += nz * u[2 * a]
        hzr += nr * u[2 * a + 1]
        hzz += nz * u[2 * a + 1]
        htt += gradients[2, a] * u[2 * a]
    if (1.0 + hrr) * (1.0 + hzz) - hrz * hzr <= 0.0 or htt <= -1.0:
        return False
    # Twice the Green-Lagrange strain, so that tiny strains far away keep all their digits.
    c11 = 2.0 * hrr + hrr * hrr + hzr * hzr
    c22 = 2.0 * hzz + hrz * hrz + hzz * hzz
    c12 = hrz + hzr + hrr * hrz + hzr * hzz
    mean, half = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    radius = math.sqrt(half * half + c12 * c12)
    angle = 0.5 * math.atan2(c12, half) if radius > 0.0 else 0.0
    c, s = math.cos(angle), math.sin(angle)
    l1, l2, l3 = 1.0 + mean + radius, 1.0 + mean - radius, (1.0 + htt) * (1.0 + htt)
    x = radius / (1.0 + mean)
    strain[0], strain[1], strain[2] = 0.5 * math.log1p(mean + radius), 0.5 * math.log1p(mean - radius), math.log1p(htt)
    difference = 0.5 * (1.0 + x * x / 3.0) / (1.0 + mean) if x < 1e-4 else 0.5 * (strain[0] - strain[1]) / radius
    a1r, a1z = (1.0 + hrr) * c + hrz * s, hzr * c + (1.0 + hzz) * s
    a2r, a2z = -(1.0 + hrr) * s + hrz * c, -hzr * s + (1.0 + hzz) * c
    for a in range(4):
        g1 = gradients[0, a] * c + gradients[1, a] * s
        g2 = -gradients[0, a] * s + gradients[1, a] * c
        b[0, 2 * a], b[0, 2 * a + 1] = a1r * g1 / l1, a1z * g1 / l1
        b[1, 2 * a], b[1, 2 * a + 1] = a2r * g2 / l2, a2z * g2 / l2
        b[2, 2 * a], b[2, 2 * a + 1] = gradients[2, a] / (1.0 + htt), 0.0
        b[3, 2 * a], b[3, 2 * a + 1] = difference * (a1r * g2 + a2r * g1), difference * (a1z * g2 + a2z * g1)
    frame[COS], frame[SIN], frame[L1], frame[L2], frame[L3] = c, s, l1, l2, l3
    frame[DIFFERENCE], frame[SPREAD] = difference, x
    return True


@njit(cache=True)
def add_curvature(gradients, b, frame, stress, weight, ke):
    """Add `weight` * T : d2E/du2 to `ke`; the stress T (11, 22, hoop, 12) is conjugate to E, in its axes."""
    c, s = frame[COS], frame[SIN]
    l1, l2, l3, difference, x = frame[L1], frame[L2], frame[L3], frame[DIFFERENCE], frame[SPREAD]
    if x < 1e-2:
        scale = 1.0 / ((l1 + l2) * (l1 + l2))
        d112 = scale * (-1.0 + x * (2.0 / 3.0 - x * (1.0 - x * (0.8 - x))))
        d122 = scale * (-1.0 - x * (2.0 / 3.0 + x * (1.0 + x * (0.8 + x))))
    else:
        d112 = (0.5 / l1 - difference) / (l1 - l2)
        d122 = (difference - 0.5 / l2) / (l1 - l2)
    t1, t2, t3, t12 = weight * stress[0], weight * stress[1], weight * stress[2], weight * stress[3]
    inverse = 0.5 / difference
    m44 = 8.0 * (t1 * d112 + t2 * d122) * inverse * inverse
    m14 = 8.0 * t12 * d112 * l1 * inverse
    m24 = 8.0 * t12 * d122 * l2 * inverse
    for i in range(8):
        left1 = m14 * b[3, i] - 2.0 * t1 * b[0, i]
        left2 = m24 * b[3, i] - 2.0 * t2 * b[1, i]
        left3 = -2.0 * t3 * b[2, i]
        left4 = m44 * b[3, i] + m14 * b[0, i] + m24 * b[1, i]
        for j in range(8):
            ke[i, j] += left1 * b[0, j] + left2 * b[1, j] + left3 * b[2, j] + left4 * b[3, j]
    s11, s22, s12, s33 = t1 / l1, t2 / l2, 2.0 * difference * t12, t3 / l3
    for i in range(4):
        gi1 = gradients[0, i] * c + gradients[1, i] * s
        gi2 = -gradients[0, i] * s + gradients[1, i] * c
        p1, p2 = s11 * gi1 + s12 * gi2, s12 * gi1 + s22 * gi2
        for j in range(4):
            gj1 = gradients[0, j] * c + gradients[1, j] * s
            gj2 = -gradients[0, j] * s + gradients[1, j] * c
            value = p1 * gj1 + p2 * gj2
            ke[2 * i, 2 * j] += value + s33 * gradients[2, i] * gradients[2, j]
            ke[2 * i + 1, 2 * j + 1] += value


@njit(cache=True)
def element(gradients, volumes, u, past, alpha, guesses, weights, row, local, ke, fe, geometric=True):
    """Write stiffness `ke` and internal force `fe` of one element; `local` (4, 4) receives R, `guesses` (4,) q.

    Without `geometric` the stiffness lacks the part that stress gives it, see `palpate.fem.element.assemble`.

    Returns
    -------
    bool
        False when the deformation turns the element inside out.
    """
    strain = np.empty((4, 3))
    b = np.empty((4, 4, 8))
    frame = np.empty((4, 7))
    trace = np.zeros(8)
    v = np.empty(8)
    stress = np.empty(4)
    volume = 0.0
    dilatation = 0.0
    for g in range(4):
        if not strain_at(gradients[g], u, strain[g], b[g], frame[g]):
            return False
        volume += volumes[g]
        dilatation += volumes[g] * (strain[g, 0] + strain[g, 1] + strain[g, 2])
        for i in range(8):
            trace[i] += volumes[g] * (b[g, 0, i] + b[g, 1, i] + b[g, 2, i])
    pressure = row[BULK] * dilatation / volume
    for i in range(8):
        fe[i] = pressure * trace[i]
        for j in range(8):
            ke[i, j] = row[BULK] / volume * trace[i] * trace[j]
    for g in range(4):
        c, s = frame[g, COS], frame[g, SIN]
        mean = (strain[g, 0] + strain[g, 1] + strain[g, 2]) / 3.0
        cross = 2.0 * past[g, 3] * s * c
        r0 = strain[g, 0] - mean - (past[g, 0] * c * c + past[g, 1] * s * s + cross)
        r1 = strain[g, 1] - mean - (past[g, 0] * s * s + past[g, 1] * c * c - cross)
        r2 = strain[g, 2] - mean - past[g, 2]
        r3 = (past[g, 0] - past[g, 1]) * s * c - past[g, 3] * (c * c - s * s)
        local[g, 0] = r0 * c * c + r1 * s * s - 2.0 * r3 * s * c
        local[g, 1] = r0 * s * s + r1 * c * c + 2.0 * r3 * s * c
        local[g, 2] = r2
        local[g, 3] = (r0 - r1) * s * c + r3 * (c * c - s * s)
        rho = invariant(r0, r1, r2, r3)
        q, slope = solve_radial(rho, guesses[g], alpha[g], weights, row)
        guesses[g] = q
        ratio = q / rho if rho > 0.0 else slope
        rank_one = volumes[g] * (slope - ratio) / (2.0 * rho * rho) if rho > 0.0 else 0.0
        scale = volumes[g] * ratio
        bg = b[g]
        for i in range(8):
            v[i] = r0 * bg[0, i] + r1 * bg[1, i] + r2 * bg[2, i] + 2.0 * r3 * bg[3, i]
            fe[i] += scale * v[i]
        for i in range(8):
            third = (bg[0, i] + bg[1, i] + bg[2, i]) / 3.0
            b0, b1, b2 = scale * (bg[0, i] - third), scale * (bg[1, i] - third), scale * (bg[2, i] - third)
            b3, vi = 2.0 * scale * bg[3, i], rank_one * v[i]
            for j in range(8):
                ke[i, j] += b0 * bg[0, j] + b1 * bg[1, j] + b2 * bg[2, j] + b3 * bg[3, j] + vi * v[j]
        stress[0], stress[1], stress[2] = ratio * r0 + pressure, ratio * r1 + pressure, ratio * r2 + pressure
        stress[3] = ratio * r3
        if geometric:
            add_curvature(gradients[g], bg, frame[g], stress, volumes[g], ke)
    return True
