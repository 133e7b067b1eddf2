"""One element at large strains and rotations: the law relates logarithmic strain to true stress.

E = (1/2) ln(F^T F) takes the place of the linear strain, so any law written for small strains becomes one for large
strains, with the same update (Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425). In the
axes of the right stretch, with squared stretches l_a and d = (ln l_1 - ln l_2) / (2 (l_1 - l_2)),

    dE_aa = dC_aa / (2 l_a),   dE_12 = d dC_12,

and the second derivative follows from the second divided differences. tr E = ln J, averaged over the element. The
smaller stretch in r and z follows from the larger one and the change of area, and the axis along it from the other one:
where a sharp tip squeezes an element to a thousandth, differences of what is large would lose all their digits.

The law's stress T counts per present area, as a laboratory and Abaqus mean it: its power is J T : dE/dt per undeformed
volume. Where the axes keep still T is the Cauchy stress; without the factor J it would be Kirchhoff's, which under a
cone hardens a polymer by the few per cent that it is compressed. With J there is no potential: the tangent has the
unsymmetric part f (d ln J / du)^T.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem.scalar_radial import BULK, invariant, solve_radial

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
    area = hrr + hzz + hrr * hzz - hrz * hzr
    if area <= -1.0 or htt <= -1.0:
        return False
    # Twice the Green-Lagrange strain, so that tiny strains far away keep all their digits.
    c11 = 2.0 * hrr + hrr * hrr + hzr * hzr
    c22 = 2.0 * hzz + hrz * hrz + hzz * hzz
    c12 = hrz + hzr + hrr * hrz + hzr * hzz
    mean, half = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    if mean <= -1.0:  # a point, to rounding: nothing is left of the squared stretches, whose mean this is, less one
        return False
    radius = math.sqrt(half * half + c12 * c12)
    c, s = half_angle(half, c12, radius)
    l1, l3 = 1.0 + mean + radius, (1.0 + htt) * (1.0 + htt)
    l2 = (1.0 + area) * (1.0 + area) / l1
    x = radius / (1.0 + mean)
    strain[0], strain[2] = 0.5 * math.log1p(mean + radius), math.log1p(htt)
    strain[1] = math.log1p(area) - strain[0]
    difference = 0.5 * (1.0 + x * x / 3.0) / (1.0 + mean) if x < 1e-4 else 0.5 * (strain[0] - strain[1]) / radius
    a1r, a1z = (1.0 + hrr) * c + hrz * s, hzr * c + (1.0 + hzz) * s
    ratio = (1.0 + area) / l1
    a2r, a2z = -ratio * a1z, ratio * a1r
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


@njit(cache=True, inline="always")
def half_angle(x, y, radius):
    """Return cosine and sine of half the angle of the point (x, y) at that `radius` from the origin."""
    if radius == 0.0:
        return 1.0, 0.0
    if x >= 0.0:
        c = math.sqrt(0.5 * (1.0 + x / radius))
        return c, 0.5 * y / (radius * c)
    s = math.copysign(math.sqrt(0.5 * (1.0 - x / radius)), y)
    return 0.5 * y / (radius * s), s


@njit(cache=True)
def write_moduli(r0, r1, r2, r3, ratio, excess, moduli):
    """Write dT/dE of the law in the axes, `ratio` I_dev + `excess` R R, to `moduli` (4, 4); for 12 twice the tensor."""
    for i in range(3):
        for j in range(3):
            moduli[i, j] = -ratio / 3.0
        moduli[i, i] += ratio
        moduli[i, 3] = moduli[3, i] = 0.0
    moduli[3, 3] = 2.0 * ratio
    double = 2.0 * r3
    for i, ri in enumerate((r0, r1, r2, double)):
        for j, rj in enumerate((r0, r1, r2, double)):
            moduli[i, j] += excess * ri * rj


@njit(cache=True)
def add_curvature(frame, stress, moduli):
    """Add to `moduli` (4, 4) what T : d2E/du2 gives by the changing axes and stretches; T (4,) is in the axes of E."""
    l1, l2, difference, x = frame[L1], frame[L2], frame[DIFFERENCE], frame[SPREAD]
    if x < 1e-2:
        scale = 1.0 / ((l1 + l2) * (l1 + l2))
        d112 = scale * (-1.0 + x * (2.0 / 3.0 - x * (1.0 - x * (0.8 - x))))
        d122 = scale * (-1.0 - x * (2.0 / 3.0 + x * (1.0 + x * (0.8 + x))))
    else:
        d112 = (0.5 / l1 - difference) / (l1 - l2)
        d122 = (difference - 0.5 / l2) / (l1 - l2)
    inverse = 0.5 / difference
    m14, m24 = 8.0 * stress[3] * d112 * l1 * inverse, 8.0 * stress[3] * d122 * l2 * inverse
    for i in range(3):
        moduli[i, i] -= 2.0 * stress[i]
    moduli[0, 3] += m14
    moduli[3, 0] += m14
    moduli[1, 3] += m24
    moduli[3, 1] += m24
    moduli[3, 3] += 8.0 * (stress[0] * d112 + stress[1] * d122) * inverse * inverse


@njit(cache=True)
def add_initial_stress(gradients, frame, stress, weight, ke):
    """Add `weight` * S : (grad N_i grad N_j) to the lower half of `ke`; S is the second Piola-Kirchhoff stress of T."""
    c, s = frame[COS], frame[SIN]
    s11, s22 = weight * stress[0] / frame[L1], weight * stress[1] / frame[L2]
    s33, s12 = weight * stress[2] / frame[L3], 2.0 * weight * frame[DIFFERENCE] * stress[3]
    srr, szz = s11 * c * c + s22 * s * s - 2.0 * s12 * s * c, s11 * s * s + s22 * c * c + 2.0 * s12 * s * c
    srz = (s11 - s22) * s * c + s12 * (c * c - s * s)
    for i in range(4):
        along_r = srr * gradients[0, i] + srz * gradients[1, i]
        along_z = srz * gradients[0, i] + szz * gradients[1, i]
        around = s33 * gradients[2, i]
        for j in range(i + 1):
            value = along_r * gradients[0, j] + along_z * gradients[1, j]
            ke[2 * i, 2 * j] += value + around * gradients[2, j]
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
    stress, moduli = np.empty(4), np.empty((4, 4))
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
    expansion = math.exp(dilatation / volume)
    bulk = expansion * row[BULK] / volume
    for i in range(8):
        fe[i] = expansion * pressure * trace[i]
        for j in range(i + 1):
            ke[i, j] = bulk * trace[i] * trace[j]
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
        present, bg = expansion * volumes[g], b[g]
        write_moduli(r0, r1, r2, r3, ratio, 0.5 * (slope - ratio) / (rho * rho) if rho > 0.0 else 0.0, moduli)
        if geometric:
            stress[0], stress[1], stress[2] = ratio * r0 + pressure, ratio * r1 + pressure, ratio * r2 + pressure
            stress[3] = ratio * r3
            add_curvature(frame[g], stress, moduli)
            add_initial_stress(gradients[g], frame[g], stress, present, ke)
        scale = present * ratio
        t0, t1, t2, t3 = scale * r0, scale * r1, scale * r2, 2.0 * scale * r3
        for i in range(8):
            b0, b1, b2, b3 = bg[0, i], bg[1, i], bg[2, i], bg[3, i]
            fe[i] += t0 * b0 + t1 * b1 + t2 * b2 + t3 * b3
            m0 = present * (moduli[0, 0] * b0 + moduli[0, 1] * b1 + moduli[0, 2] * b2 + moduli[0, 3] * b3)
            m1 = present * (moduli[1, 0] * b0 + moduli[1, 1] * b1 + moduli[1, 2] * b2 + moduli[1, 3] * b3)
            m2 = present * (moduli[2, 0] * b0 + moduli[2, 1] * b1 + moduli[2, 2] * b2 + moduli[2, 3] * b3)
            m3 = present * (moduli[3, 0] * b0 + moduli[3, 1] * b1 + moduli[3, 2] * b2 + moduli[3, 3] * b3)
            for j in range(i + 1):
                ke[i, j] += m0 * bg[0, j] + m1 * bg[1, j] + m2 * bg[2, j] + m3 * bg[3, j]
    for i in range(8):
        for j in range(i):
            ke[j, i] = ke[i, j]
    if geometric:
        for i in range(8):
            for j in range(8):
                ke[i, j] += fe[i] * trace[j] / volume
    return True
