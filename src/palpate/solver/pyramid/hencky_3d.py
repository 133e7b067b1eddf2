"""One hexahedron at large strains and rotations: the law relates logarithmic strain to true stress.

As in the plane (`palpate.solver.axisymmetric.hencky`, which gives the reasons): E = (1/2) ln C with C = F^T F takes the
place of the linear strain, and the stress T of the law counts per present area. In the axes N_a of the right stretch,
with squared stretches l_a, images n_a = F N_a of the axes, and the divided differences f_ab and f_abc of (1/2) ln l,

    dE_ab = f_ab dC_ab,   dC_ab = n_a . dF N_b + n_b . dF N_a,   d2E_ab = 2 f_acb dC_ac dC_cb + f_ab d2C_ab

(Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425). tr E = ln J, averaged over the
element. The smallest stretch follows from the others and the change of volume, so that a squeezed element keeps its
digits.

Arguments of the functions: those of `element` are those of `palpate.solver.pyramid.linear_3d`; `axes`, `images` (3, 3)
and `squared` (3,) are written by `strain_at`, `pairs` (3, 3) by `write_pairs` and `triples` (3, 3, 3) by
`write_triples`; `r` (6,) is the tensor R in the axes, `moduli` (6, 6) the derivative of the stress by the strain there;
`a`, `b`, `c` are places in `values`.
"""

from __future__ import annotations

import math

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.point import length, solve
from palpate.materials.flow.radial import borne
from palpate.materials.flow.row import BULK, SPLIT
from palpate.solver.pyramid.linear_3d import COMPONENTS, DISPLACEMENTS

PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])  # of each entry of a tensor among its components
CLOSE_PAIR, CLOSE_TRIPLE = 1e-3, 1e-2  # relative distance below which divided differences are series
SWEEPS = 12  # at most: Jacobi's rotations converge quadratically


@inner_kernel(cache=True)
def eigen(tensor, axes):
    """Turn a symmetric `tensor` (3, 3) into its diagonal, in place; the columns of `axes` (3, 3) receive its axes.

    Jacobi's rotations: small entries of a matrix whose others are zero keep all their digits.
    """
    axes[:] = 0.0
    for i in range(3):
        axes[i, i] = 1.0
    for _ in range(SWEEPS):
        beside = abs(tensor[0, 1]) + abs(tensor[1, 2]) + abs(tensor[2, 0])
        if beside <= 1e-17 * (abs(tensor[0, 0]) + abs(tensor[1, 1]) + abs(tensor[2, 2])):
            return
        for p, r in ((0, 1), (1, 2), (0, 2)):
            if tensor[p, r] != 0.0:
                half = 0.5 * (tensor[r, r] - tensor[p, p]) / tensor[p, r]
                tangent = math.copysign(1.0, half) / (abs(half) + math.hypot(1.0, half))
                c = 1.0 / math.hypot(1.0, tangent)
                s = tangent * c
                for i in range(3):
                    tensor[i, p], tensor[i, r] = _turned(tensor[i, p], tensor[i, r], c, s)
                for i in range(3):
                    tensor[p, i], tensor[r, i] = _turned(tensor[p, i], tensor[r, i], c, s)
                for i in range(3):
                    axes[i, p], axes[i, r] = _turned(axes[i, p], axes[i, r], c, s)


@inner_kernel(cache=True, inline="always")
def _turned(x, y, c, s):
    return c * x - s * y, s * x + c * y


@inner_kernel(cache=True)
def write_pairs(strain, squared, pairs):
    """Write the divided differences f_ab (3, 3) of (1/2) ln l at `squared` stretches l (3,) of that `strain`."""
    for a in range(3):
        for b in range(3):
            x = (squared[a] - squared[b]) / (squared[a] + squared[b])
            if abs(x) < CLOSE_PAIR:
                pairs[a, b] = (1.0 + x * x / 3.0) / (squared[a] + squared[b])
            else:
                pairs[a, b] = (strain[a] - strain[b]) / (squared[a] - squared[b])


@inner_kernel(cache=True)
def write_triples(squared, pairs, triples):
    """Write the second divided differences f_abc (3, 3, 3)."""
    for a in range(3):
        for b in range(3):
            for c in range(3):
                low, middle, high = sorted_by(squared, a, b, c)
                mean = (squared[low] + squared[middle] + squared[high]) / 3.0
                if squared[high] - squared[low] > CLOSE_TRIPLE * mean:
                    difference = pairs[high, middle] - pairs[middle, low]
                    triples[a, b, c] = difference / (squared[high] - squared[low])
                else:
                    x, y, z = squared[low] / mean - 1.0, squared[middle] / mean - 1.0, squared[high] / mean - 1.0
                    second = x * x + y * y + z * z + x * y + y * z + z * x
                    triples[a, b, c] = -0.25 * (1.0 + 0.5 * second) / (mean * mean)


@inner_kernel(cache=True)
def sorted_by(values, a, b, c):
    """Return three places in the order of what `values` hold there."""
    if values[a] > values[b]:
        a, b = b, a
    if values[b] > values[c]:
        b, c = c, b
    if values[a] > values[b]:
        a, b = b, a
    return a, b, c


@inner_kernel(cache=True)
def strain_at(gradients, u, strain, squared, axes, images):
    """Logarithmic strain at a Gauss point.

    Parameters
    ----------
    gradients, u : ndarray, shape (8, 3)
        Of the shape functions; displacements.
    strain, squared : ndarray, shape (3,)
        Out: E along the axes of the right stretch, and the squared stretches.
    axes, images : ndarray, shape (3, 3)
        Out: the axes, and what the deformation makes of them, in columns.

    Returns
    -------
    bool
        False when the deformation turns the element inside out.
    """
    h = np.zeros((3, 3))
    for a in range(8):
        for i in range(3):
            for j in range(3):
                h[i, j] += u[a, i] * gradients[a, j]
    swelling = h[0, 0] + h[1, 1] + h[2, 2]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        swelling += h[i, i] * h[j, j] - h[i, j] * h[j, i] + h[0, i] * (h[1, j] * h[2, k] - h[1, k] * h[2, j])
    if swelling <= -1.0:
        return False
    # Twice the Green-Lagrange strain, so that tiny strains far away keep all their digits.
    tensor = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            tensor[i, j] = h[i, j] + h[j, i] + h[0, i] * h[0, j] + h[1, i] * h[1, j] + h[2, i] * h[2, j]
    eigen(tensor, axes)
    for a in range(3):
        squared[a] = 1.0 + tensor[a, a]
    low, middle, high = sorted_by(squared, 0, 1, 2)
    strain[high], strain[middle] = 0.5 * math.log1p(tensor[high, high]), 0.5 * math.log1p(tensor[middle, middle])
    strain[low] = math.log1p(swelling) - strain[high] - strain[middle]
    squared[low] = (1.0 + swelling) ** 2 / (squared[high] * squared[middle])
    for i in range(3):
        for a in range(3):
            images[i, a] = axes[i, a] + h[i, 0] * axes[0, a] + h[i, 1] * axes[1, a] + h[i, 2] * axes[2, a]
    return True


@inner_kernel(cache=True)
def write_slopes(gradients, axes, images, pairs, b, along):
    """Write dE/du in the axes to `b` (6, 24), and the gradients there to `along` (8, 3)."""
    for node in range(8):
        for a in range(3):
            along[node, a] = (
                gradients[node, 0] * axes[0, a] + gradients[node, 1] * axes[1, a] + gradients[node, 2] * axes[2, a]
            )
        for a in range(3):
            for c in range(a + 1):
                row, factor = PLACE[a, c], pairs[a, c]
                for i in range(3):
                    b[row, 3 * node + i] = factor * (images[i, a] * along[node, c] + images[i, c] * along[node, a])


@inner_kernel(cache=True)
def write_moduli(r, ratio, excess, moduli):
    """Write dT/dE of the law, `ratio` I_dev + `excess` R R, to `moduli` (6, 6); shear counts twice."""
    for i in range(6):
        ri = r[i] if i < 3 else 2.0 * r[i]
        for j in range(6):
            moduli[i, j] = excess * ri * (r[j] if j < 3 else 2.0 * r[j])
            if i < 3 and j < 3:
                moduli[i, j] -= ratio / 3.0
        moduli[i, i] += ratio if i < 3 else 2.0 * ratio


@inner_kernel(cache=True)
def add_curvature(stress, pairs, triples, moduli):
    """Add to `moduli` (6, 6) what T : d2E gives by the changing axes and stretches, T (6,) in the axes."""
    for a in range(3):
        for b in range(3):
            for c in range(3):
                i, j = PLACE[a, c], PLACE[c, b]
                moduli[i, j] += 2.0 * stress[PLACE[a, b]] * triples[a, c, b] / (pairs[a, c] * pairs[c, b])


@inner_kernel(cache=True)
def element(gradients, volumes, u, points, law, ke, fe, geometric):
    """Write stiffness `ke` and internal force `fe` of one element, and the solution at its `points`.

    Without `geometric` the stiffness lacks the part that stress gives it. Of what remains unsymmetric, because stress
    counts per present area, it holds the symmetric part.

    Returns
    -------
    float
        Pressure of the element [GPa], positive in compression; NaN when the deformation turns it inside out.
    """
    past, back, alpha, guesses, local = points
    weights, row = law
    strain, squared = np.empty((8, 3)), np.empty((8, 3))
    axes, images = np.empty((8, 3, 3)), np.empty((8, 3, 3))
    pairs, triples = np.empty((8, 3, 3)), np.empty((3, 3, 3))
    b, along = np.empty((8, COMPONENTS, DISPLACEMENTS)), np.empty((8, 8, 3))
    squeeze = np.zeros(DISPLACEMENTS)
    trace, r, stress = np.zeros(DISPLACEMENTS), np.empty(COMPONENTS), np.empty(COMPONENTS)
    deviator, split = np.empty(COMPONENTS), weights[SPLIT]
    moduli, image = np.empty((COMPONENTS, COMPONENTS)), np.empty(COMPONENTS)
    volume, dilatation = volumes.sum(), 0.0
    for g in range(8):
        if not strain_at(gradients[g], u, strain[g], squared[g], axes[g], images[g]):
            return np.nan
        write_pairs(strain[g], squared[g], pairs[g])
        write_slopes(gradients[g], axes[g], images[g], pairs[g], b[g], along[g])
        dilatation += volumes[g] / volume * strain[g].sum()
        for i in range(DISPLACEMENTS):
            trace[i] += volumes[g] * (b[g, 0, i] + b[g, 1, i] + b[g, 2, i])
    pressure, expansion = row[BULK] * dilatation, math.exp(dilatation)
    for i in range(DISPLACEMENTS):
        fe[i] = expansion * pressure * trace[i]
        for j in range(i + 1):
            ke[i, j] = expansion * row[BULK] / volume * trace[i] * trace[j]
    for g in range(8):
        present = expansion * volumes[g]
        mean = strain[g].sum() / 3.0
        for a in range(3):
            for c in range(a + 1):
                fixed, backed = 0.0, 0.0
                for i in range(3):
                    for j in range(3):
                        fixed += axes[g, i, a] * past[g, PLACE[i, j]] * axes[g, j, c]
                        backed += axes[g, i, a] * back[g, PLACE[i, j]] * axes[g, j, c]
                r[PLACE[a, c]] = (split * (strain[g, a] - mean) if a == c else 0.0) - fixed
                deviator[PLACE[a, c]] = backed
        for i in range(3):
            for j in range(i + 1):
                local[g, PLACE[i, j]] = 0.0
                for a in range(3):
                    for c in range(3):
                        local[g, PLACE[i, j]] += axes[g, i, a] * r[PLACE[a, c]] * axes[g, j, c]
        rho = length(r, COMPONENTS)
        q, slope, push = solve(rho, guesses[g], alpha[g], -pressure, weights, row)
        guesses[g] = q
        ratio, order, push = borne(q / rho if rho > 0.0 else slope, slope * rho / q if q > 0.0 else 1.0, push, weights)
        changed = split * ratio
        write_moduli(r, changed, 0.5 * changed * (order - 1.0) / (rho * rho) if rho > 0.0 else 0.0, moduli)
        for i in range(COMPONENTS):
            deviator[i] += ratio * r[i]
            stress[i] = deviator[i] + (pressure if i < 3 else 0.0)
        if geometric:
            write_triples(squared[g], pairs[g], triples)
            add_curvature(stress, pairs[g], triples, moduli)
            _add_initial_stress(along[g], stress, pairs[g], present, ke)
        slopes, pushed = b[g], present * push * row[BULK] / rho if rho > 0.0 else 0.0
        for i in range(DISPLACEMENTS):
            for c in range(COMPONENTS):
                image[c] = 0.0
                for d in range(COMPONENTS):
                    image[c] += present * moduli[c, d] * slopes[d, i]
                part = slopes[c, i] * (1.0 if c < 3 else 2.0)
                fe[i] += present * deviator[c] * part
                squeeze[i] += pushed * r[c] * part
            m0, m1, m2, m3, m4, m5 = image
            for j in range(i + 1):
                normal = m0 * slopes[0, j] + m1 * slopes[1, j] + m2 * slopes[2, j]
                ke[i, j] += normal + m3 * slopes[3, j] + m4 * slopes[4, j] + m5 * slopes[5, j]
    for i in range(DISPLACEMENTS):
        for j in range(i + 1):
            if geometric:
                first, second = fe[i] - squeeze[i], fe[j] - squeeze[j]
                ke[i, j] += 0.5 * (first * trace[j] + trace[i] * second) / volume
            ke[j, i] = ke[i, j]
    return -pressure


@inner_kernel(cache=True)
def _add_initial_stress(along, stress, pairs, weight, ke):
    """Add `weight` * S : (grad N_i grad N_j) to the lower half of `ke`; S is the second Piola-Kirchhoff stress of T."""
    second = np.empty((3, 3))
    for a in range(3):
        for c in range(3):
            second[a, c] = 2.0 * weight * pairs[a, c] * stress[PLACE[a, c]]
    for i in range(8):
        x = second[0, 0] * along[i, 0] + second[0, 1] * along[i, 1] + second[0, 2] * along[i, 2]
        y = second[1, 0] * along[i, 0] + second[1, 1] * along[i, 1] + second[1, 2] * along[i, 2]
        z = second[2, 0] * along[i, 0] + second[2, 1] * along[i, 1] + second[2, 2] * along[i, 2]
        for j in range(i + 1):
            value = x * along[j, 0] + y * along[j, 1] + z * along[j, 2]
            for k in range(3):
                ke[3 * i + k, 3 * j + k] += value
