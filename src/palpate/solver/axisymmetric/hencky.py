"""Internal forces and stiffness at large strains and rotations, for `LANES` bodies of one shape at once.

E = (1/2) ln(F^T F) takes the place of the linear strain, so any law written for small strains becomes one for large
strains, with the same update (Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425).
tr E = ln J, averaged over the element.

The law's stress T counts per present area, as a laboratory and Abaqus mean it: its power is J T : dE/dt per undeformed
volume. Where the axes keep still T is the Cauchy stress; without the factor J it would be Kirchhoff's, which under a
cone hardens a polymer by the few per cent that it is compressed. With J there is no potential: the tangent has the
unsymmetric part f (d ln J / du)^T.

Branches cost lanes, so nothing is turned to the axes of stretch. With C - 1 in r and z split into its mean m, half the
difference h and the shear c, and s = h^2 + c^2, the logarithmic strain is an isotropic function of two scalars,

    E = alpha 1 + beta (h, c),   alpha = (1/4) ln q,   beta = A(s / (1 + m)^2) / (2 (1 + m)),   q = (1 + m)^2 - s,

with A(y) = artanh(sqrt y) / sqrt y. As q is the square of the determinant of the displacement gradient with 1, it is
taken from there: where an element is squeezed to a hundredth the difference would have lost half of its digits. The
tangent's unsymmetric part, which true stress brings, is replaced by its symmetric half: Newton's method then takes an
iteration or so more, and Cholesky's factorisation serves.

The return to the law is written out in `internal_forces` here and in `element`: as one function that both call,
inlined or not, it makes a run a fifth slower.

Arguments of the kernels: `body`, `points`, `laws`, `weights`, `displacement`, `forces` and `band` are those of
`palpate.solver.axisymmetric.element`; `parts` (PARTS, LANES) is written by `stretch`; `t0`, `t1`, `t2`, `t3` are the
stress rr, zz, tt, rz [GPa], and `r0`, `r1`, `r2`, `r3` the direction R / rho likewise; `moduli` (4, 4, LANES) are the
derivatives of the stress by m, h, c and the hoop strain.
"""

from __future__ import annotations

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.radial import NOTHING, UNKNOWN, borne, solve_radial
from palpate.materials.flow.row import BACK_STRESS, BULK, PRESSED, SPLIT, STATE
from palpate.solver.axisymmetric.lanes import LANES, exponential, load, log_of_one_plus, root, splat, store, where_less
from palpate.solver.axisymmetric.law_lanes import region_of

# What `stretch` writes of a Gauss point: displacement gradient with 1, m, h, c, and alpha and beta with derivatives.
RR, RZ, ZR, ZZ, TT, MEAN, HALF, SHEAR, ALPHA, BETA, BETA_S, BETA_SS, INVERSE_Q, HOOP, PARTS = range(15)
SMALL = 0.01  # y, below which the derivatives of A are series


@inner_kernel(cache=True)
def stretch(gradients, u, parts):
    """Write the `parts` (PARTS, LANES) of a Gauss point at the nodal displacements `u` (8, LANES)."""
    hrr, hrz, hzr, hzz, htt = splat(0.0), splat(0.0), splat(0.0), splat(0.0), splat(0.0)
    for a in range(4):
        radial, vertical = load(u, 2 * a), load(u, 2 * a + 1)
        nr, nz = gradients[0, a], gradients[1, a]
        hrr, hrz = hrr + nr * radial, hrz + nz * radial
        hzr, hzz = hzr + nr * vertical, hzz + nz * vertical
        htt = htt + gradients[2, a] * radial
    c11 = 2.0 * hrr + hrr * hrr + hzr * hzr
    c22 = 2.0 * hzz + hrz * hrz + hzz * hzz
    c12 = hrz + hzr + hrr * hrz + hzr * hzz
    mean, half = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    s = half * half + c12 * c12
    s = where_less(s, splat(NOTHING), splat(NOTHING), s)
    area = hrr + hzz + hrr * hzz - hrz * hzr
    upright, whole = 1.0 + area, 1.0 + mean
    y = s / (whole * whole)
    x = root(y)
    near, inverse = (whole * whole) / (upright * upright), 0.5 / y
    a0 = 0.5 * log_of_one_plus(2.0 * x * (1.0 + x) * near) / x
    first = 1 / 3 + y * (2 / 5 + y * (3 / 7 + y * (4 / 9 + y * (5 / 11 + y * (6 / 13 + y * (7 / 15))))))
    second = 2 / 5 + y * (6 / 7 + y * (12 / 9 + y * (20 / 11 + y * (30 / 13))))
    a1 = where_less(y, splat(SMALL), first, (near - a0) * inverse)
    a2 = where_less(y, splat(SMALL), second, (near * near - 3.0 * a1) * inverse)
    scale = 1.0 / whole
    cube = 0.5 * scale * scale * scale
    store(parts, RR, 1.0 + hrr)
    store(parts, RZ, hrz)
    store(parts, ZR, hzr)
    store(parts, ZZ, 1.0 + hzz)
    store(parts, TT, 1.0 / (1.0 + htt))
    store(parts, MEAN, whole)
    store(parts, HALF, half)
    store(parts, SHEAR, c12)
    store(parts, ALPHA, where_less(splat(0.0), upright, 0.5 * log_of_one_plus(area), splat(np.nan)))
    store(parts, BETA, 0.5 * a0 * scale)
    store(parts, BETA_S, a1 * cube)
    store(parts, BETA_SS, a2 * cube * scale * scale)
    store(parts, INVERSE_Q, 1.0 / (upright * upright))
    store(parts, HOOP, where_less(splat(-1.0), htt, log_of_one_plus(htt), splat(np.nan)))


@inner_kernel(cache=True)
def swelling(parts):
    """Return ln J of a Gauss point; NaN where the element is inside out."""
    return 2.0 * load(parts, ALPHA) + load(parts, HOOP)


@inner_kernel(cache=True)
def stretched(gradients, volumes, u, parts):
    """Write the `parts` of an element's Gauss points at `u` (8, LANES); return its mean ln J and its volume.

    `gradients` (4, 3, 4) and `volumes` (4,) are those of the element in `Body`.
    """
    theta, volume = splat(0.0), 0.0
    for g in range(4):
        stretch(gradients[g], u, parts[g])
        theta = theta + volumes[g] * swelling(parts[g])
        volume += volumes[g]
    return theta * (1.0 / volume), volume


@inner_kernel(cache=True)
def second_stress(parts, t0, t1, t3):
    """Return the second Piola-Kirchhoff stress rr, zz, rz of the law's stress rr, zz, rz."""
    half, shear, inverse_q = load(parts, HALF), load(parts, SHEAR), load(parts, INVERSE_Q)
    both, apart = t0 + t1, (t0 - t1) * half + 2.0 * t3 * shear
    by_mean = 0.5 * inverse_q * (both * load(parts, MEAN) - apart)
    by_s = 2.0 * apart * load(parts, BETA_S) - 0.5 * both * inverse_q
    beta = load(parts, BETA)
    by_half = by_s * half + beta * (t0 - t1)
    return by_mean + by_half, by_mean - by_half, by_s * shear + 2.0 * beta * t3


@inner_kernel(cache=True)
def internal_forces(body, points, laws, weights, displacement, forces):
    """Write the `forces` (size + 1, LANES) of the stress at a `displacement` (same), and the solution at `points`."""
    forces[:] = 0.0
    u, f, parts = np.empty((8, LANES)), np.empty((8, LANES)), np.empty((4, PARTS, LANES))
    for e in range(body.unknowns.shape[0]):
        region = region_of(e, laws)
        law, step, bulk = laws[region], weights[region], load(laws[region], BULK)
        pressed, stateful = law[PRESSED, 0] > 0.0, law[STATE, 0] > 0.0
        backed, split = law[BACK_STRESS, 0] > 0.0, load(step, SPLIT)
        for i in range(8):
            store(u, i, load(displacement, body.unknowns[e, i]))
            store(f, i, splat(0.0))
        theta, _ = stretched(body.gradients[e], body.volumes[e], u, parts)
        pressure, squeezed, expansion = bulk * theta, splat(0.0) - bulk * theta, exponential(theta)
        store(points.pressure, e, squeezed)
        for g in range(4):
            gradients, part, p = body.gradients[e, g], parts[g], 4 * e + g
            alpha, beta, hoop = load(part, ALPHA), load(part, BETA), load(part, HOOP)
            mean, half = (2.0 * alpha + hoop) * (1.0 / 3.0), beta * load(part, HALF)
            r0 = split * (alpha + half - mean) - load(points.past, 4 * p)
            r1 = split * (alpha - half - mean) - load(points.past, 4 * p + 1)
            r2 = split * (hoop - mean) - load(points.past, 4 * p + 2)
            r3 = split * (beta * load(part, SHEAR)) - load(points.past, 4 * p + 3)
            rho = root(0.5 * (r0 * r0 + r1 * r1 + r2 * r2) + r3 * r3)
            rho = where_less(rho, splat(NOTHING), splat(NOTHING), rho)
            last, log_q, order = load(points.rho, p), load(points.log_q, p), load(points.order, p)
            log_q = where_less(splat(UNKNOWN), log_q, log_q, splat(2.0 * UNKNOWN))
            strained = load(points.alpha, p) if stateful else rho
            q, log_q, order, push = solve_radial(rho, last, log_q, order, strained, squeezed, law, step)
            inverse = 1.0 / rho
            store(points.rho, p, rho)
            store(points.log_q, p, log_q)
            store(points.secant, p, q * inverse)
            store(points.order, p, order)
            if pressed:
                store(points.push, p, push)
            r0, r1, r2, r3 = r0 * inverse, r1 * inverse, r2 * inverse, r3 * inverse
            store(points.direction, 4 * p, r0)
            store(points.direction, 4 * p + 1, r1)
            store(points.direction, 4 * p + 2, r2)
            store(points.direction, 4 * p + 3, r3)
            size = expansion * body.volumes[e, g]
            secant, _, _ = borne(q * inverse, order, push, step)
            along = secant * rho
            t0, t1, t2, t3 = along * r0, along * r1, along * r2, along * r3
            if backed:
                t0, t1 = t0 + load(points.back, 4 * p), t1 + load(points.back, 4 * p + 1)
                t2, t3 = t2 + load(points.back, 4 * p + 2), t3 + load(points.back, 4 * p + 3)
            s0, s1, s3 = second_stress(part, t0 + pressure, t1 + pressure, t3)
            s0, s1, s3 = size * s0, size * s1, size * s3
            around = size * (t2 + pressure) * load(part, TT)
            frr, frz, fzr, fzz = load(part, RR), load(part, RZ), load(part, ZR), load(part, ZZ)
            prr, prz = frr * s0 + frz * s3, frr * s3 + frz * s1
            pzr, pzz = fzr * s0 + fzz * s3, fzr * s3 + fzz * s1
            for a in range(4):
                nr, nz, nt = gradients[0, a], gradients[1, a], gradients[2, a]
                store(f, 2 * a, load(f, 2 * a) + (prr * nr + prz * nz + around * nt))
                store(f, 2 * a + 1, load(f, 2 * a + 1) + (pzr * nr + pzz * nz))
        for i in range(8):
            row = body.unknowns[e, i]
            store(forces, row, load(forces, row) + load(f, i))


@inner_kernel(cache=True)
def slopes(gradients, parts, b):
    """Write the derivatives of m, h, c and the hoop strain by the nodal displacements to `b` (4, 8, LANES)."""
    for column in range(2):
        along_r, along_z = load(parts, RR + 2 * column), load(parts, RZ + 2 * column)
        for a in range(4):
            nr, nz, i = gradients[0, a], gradients[1, a], 2 * a + column
            store(b, i, nr * along_r + nz * along_z)
            store(b, 8 + i, nr * along_r - nz * along_z)
            store(b, 16 + i, nz * along_r + nr * along_z)
            store(b, 24 + i, load(parts, TT) * (gradients[2, a] if column == 0 else 0.0))


@inner_kernel(cache=True)
def add_product(rows, k, weight, moduli):
    """Add `weight` times the product of row `k` of `rows` (5, 4, LANES) with itself to `moduli` (4, 4, LANES)."""
    for i in range(4):
        value = weight * load(rows, 4 * k + i)
        for j in range(i + 1):
            store(moduli, 4 * i + j, load(moduli, 4 * i + j) + value * load(rows, 4 * k + j))


@inner_kernel(cache=True)
def strain_rows(parts, r0, r1, r2, r3, rows):
    """Write to `rows` (5, 4, LANES) what m, h, c and the hoop strain do to parts of E.

    The parts are half the trace in r and z less the hoop, half the difference, the shear, the strain along R, and the
    trace.
    """
    half, shear, inverse_q = load(parts, HALF), load(parts, SHEAR), load(parts, INVERSE_Q)
    beta, twice = load(parts, BETA), 2.0 * load(parts, BETA_S)
    m0, m1, m2 = 0.5 * inverse_q * load(parts, MEAN), -0.5 * inverse_q * half, -0.5 * inverse_q * shear
    h0, h1, h2 = -0.5 * inverse_q * half, beta + twice * half * half, twice * half * shear
    c0, c1, c2 = -0.5 * inverse_q * shear, twice * half * shear, beta + twice * shear * shear
    both, apart, double = r0 + r1, r0 - r1, 2.0 * r3
    none = splat(0.0)
    for i, value in enumerate((
        m0, m1, m2, splat(-1.0), h0, h1, h2, none, c0, c1, c2, none,
        both * m0 + apart * h0 + double * c0, both * m1 + apart * h1 + double * c1,
        both * m2 + apart * h2 + double * c2, r2, 2.0 * m0, 2.0 * m1, 2.0 * m2, splat(1.0),
    )):  # fmt: skip
        store(rows, i, value)


@inner_kernel(cache=True)
def add_curvature(parts, t0, t1, t2, t3, moduli):
    """Add to the lower half of `moduli` (4, 4, LANES) the stress times the second derivative of E by m, h, c, hoop."""
    half, shear, inverse_q, whole = load(parts, HALF), load(parts, SHEAR), load(parts, INVERSE_Q), load(parts, MEAN)
    beta_s, square = load(parts, BETA_S), load(parts, INVERSE_Q) * load(parts, INVERSE_Q)
    both, apart, double = t0 + t1, t0 - t1, 2.0 * t3
    along = apart * half + double * shear
    by_mm = both * (0.5 * inverse_q - whole * whole * square) + along * whole * square
    by_ms = square * (both * whole - along)
    by_ss = 4.0 * along * load(parts, BETA_SS) - both * square
    by_s = 2.0 * along * beta_s - 0.5 * both * inverse_q
    sideways, cross = -0.5 * inverse_q, 2.0 * beta_s
    store(moduli, 0, load(moduli, 0) + by_mm)
    store(moduli, 4, load(moduli, 4) + by_ms * half + sideways * apart)
    store(moduli, 8, load(moduli, 8) + by_ms * shear + sideways * double)
    store(moduli, 5, load(moduli, 5) + by_ss * half * half + by_s + 2.0 * cross * apart * half)
    store(moduli, 9, load(moduli, 9) + by_ss * half * shear + cross * (apart * shear + double * half))
    store(moduli, 10, load(moduli, 10) + by_ss * shear * shear + by_s + 2.0 * cross * double * shear)
    store(moduli, 15, load(moduli, 15) - t2)


@inner_kernel(cache=True)
def stiffness(body, points, laws, weights, displacement, geometric, band):
    """Write the lower half of the tangent's symmetric part at the solution of `points` to the `band`.

    `geometric` (LANES,) is one where the stiffness that stress gives is kept, zero where it is left out, for the matrix
    to be positive definite whatever the stress.
    """
    band[:] = 0.0
    u, f, trace = np.empty((8, LANES)), np.empty((8, LANES)), np.empty((8, LANES))
    parts, rows, moduli = np.empty((4, PARTS, LANES)), np.empty((20, LANES)), np.empty((16, LANES))
    b, ke, squeeze = np.empty((32, LANES)), np.empty((36, LANES)), np.empty((8, LANES))
    kept = load(geometric, 0)
    for e in range(body.unknowns.shape[0]):
        law, step = laws[region_of(e, laws)], weights[region_of(e, laws)]
        bulk, pressed, split = load(law, BULK), law[PRESSED, 0] > 0.0, load(step, SPLIT)
        backed = law[BACK_STRESS, 0] > 0.0
        for i in range(8):
            store(u, i, load(displacement, body.unknowns[e, i]))
            store(f, i, splat(0.0))
            store(trace, i, splat(0.0))
            store(squeeze, i, splat(0.0))
        ke[:] = 0.0
        theta, volume = stretched(body.gradients[e], body.volumes[e], u, parts)
        expansion = exponential(theta)
        for g in range(4):
            gradients, part, p = body.gradients[e, g], parts[g], 4 * e + g
            size = expansion * body.volumes[e, g]
            secant, order, slope = borne(load(points.secant, p), load(points.order, p), load(points.push, p), step)
            ratio = split * secant
            r0, r1 = load(points.direction, 4 * p), load(points.direction, 4 * p + 1)
            r2, r3 = load(points.direction, 4 * p + 2), load(points.direction, 4 * p + 3)
            slopes(gradients, part, b)
            strain_rows(part, r0, r1, r2, r3, rows)
            moduli[:] = 0.0
            add_product(rows, 0, (2.0 / 3.0) * ratio, moduli)
            add_product(rows, 1, 2.0 * ratio, moduli)
            add_product(rows, 2, 2.0 * ratio, moduli)
            add_product(rows, 3, 0.5 * ratio * (order - 1.0), moduli)
            along, pressure = secant * load(points.rho, p) * kept, bulk * theta * kept
            t0, t1, t2, t3 = along * r0 + pressure, along * r1 + pressure, along * r2 + pressure, along * r3
            if backed:
                t0, t1 = t0 + kept * load(points.back, 4 * p), t1 + kept * load(points.back, 4 * p + 1)
                t2, t3 = t2 + kept * load(points.back, 4 * p + 2), t3 + kept * load(points.back, 4 * p + 3)
            add_curvature(part, t0, t1, t2, t3, moduli)
            s0, s1, s3 = second_stress(part, t0, t1, t3)
            for i in range(8):
                b0, b1, b2, b3 = load(b, i), load(b, 8 + i), load(b, 16 + i), load(b, 24 + i)
                swell = load(rows, 16) * b0 + load(rows, 17) * b1 + load(rows, 18) * b2 + load(rows, 19) * b3
                push = 0.5 * (s0 + s1) * b0 + 0.5 * (s0 - s1) * b1 + s3 * b2 + t2 * b3
                store(trace, i, load(trace, i) + body.volumes[e, g] * swell)
                store(f, i, load(f, i) + size * push)
                if pressed:
                    along = load(rows, 12) * b0 + load(rows, 13) * b1 + load(rows, 14) * b2 + load(rows, 15) * b3
                    store(squeeze, i, load(squeeze, i) + size * slope * kept * along)
                h0 = load(moduli, 0) * b0 + load(moduli, 4) * b1 + load(moduli, 8) * b2 + load(moduli, 12) * b3
                h1 = load(moduli, 4) * b0 + load(moduli, 5) * b1 + load(moduli, 9) * b2 + load(moduli, 13) * b3
                h2 = load(moduli, 8) * b0 + load(moduli, 9) * b1 + load(moduli, 10) * b2 + load(moduli, 14) * b3
                h3 = load(moduli, 12) * b0 + load(moduli, 13) * b1 + load(moduli, 14) * b2 + load(moduli, 15) * b3
                h0, h1, h2, h3 = size * h0, size * h1, size * h2, size * h3
                nr, nz = gradients[0, i // 2], gradients[1, i // 2]
                along_r, along_z = size * (s0 * nr + s3 * nz), size * (s3 * nr + s1 * nz)
                pair = i * (i + 1) // 2
                for j in range(i + 1):
                    value = load(ke, pair + j) + h0 * load(b, j) + h1 * load(b, 8 + j)
                    value = value + h2 * load(b, 16 + j) + h3 * load(b, 24 + j)
                    if (i - j) % 2 == 0:
                        value = value + along_r * gradients[0, j // 2] + along_z * gradients[1, j // 2]
                    store(ke, pair + j, value)
        stiff, half = expansion * bulk * (1.0 / volume), 0.5 / volume
        pair = 0
        for i in range(8):
            swell = stiff * load(trace, i) + half * load(f, i)
            for j in range(i + 1):
                row = body.entries[e, pair]
                value = load(ke, pair) + swell * load(trace, j) + half * load(trace, i) * load(f, j)
                if pressed:
                    both = load(trace, i) * load(squeeze, j) + load(squeeze, i) * load(trace, j)
                    value = value - half * bulk * both
                store(band, row, load(band, row) + value)
                pair += 1
