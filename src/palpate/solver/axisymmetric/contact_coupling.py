"""How the forces and the area of the contact depend on its nodes and on each other, and their place in the matrix.

Arguments of several functions: `body` is that of `palpate.solver.axisymmetric.element`; `geometric` (LANES,) is zero
where the matrix is to be positive definite.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES, larger, load, splat, store, where_less
from palpate.solver.axisymmetric.rows import copy_rows

LEAST_RESPONSE = 0.2  # of the area to what makes it larger, in which it takes part itself


class Coupling(NamedTuple):
    """How forces and area of the contact depend on where its nodes are, and on each other.

    Attributes
    ----------
    tangent : ndarray, shape (k, 2, 4, LANES)
        Derivatives of a node's radial residual by u_r and by u_z, and those of its vertical one; by the depth they are
        those by u_z. The second of the two leaves out what keeps a matrix from being positive definite: the rise of
        the force where b < 1 makes it fall, attraction that decays, and a tip that curves away.
    by_area : ndarray, shape (k, 2, LANES)
        Derivatives of its radial and its vertical residual by the area, at the same load.
    touching : ndarray, shape (k, 2, LANES)
        Derivatives of the sum of A Phi(2 x + 2) by u_r and by u_z.
    area, feedback : ndarray, shape (LANES,)
        That sum, and its derivative by the area that the width belongs to.
    """

    tangent: np.ndarray
    by_area: np.ndarray
    touching: np.ndarray
    area: np.ndarray
    feedback: np.ndarray


@inner_kernel(cache=True)
def no_coupling(count):
    """Return storage for the coupling of so many nodes."""
    return Coupling(
        np.zeros((count, 2, 4, LANES)), np.zeros((count, 2, LANES)), np.zeros((count, 2, LANES)), np.zeros(LANES),
        np.zeros(LANES),
    )  # fmt: skip


@inner_kernel(cache=True, error_model="numpy")
def spread(body, coupling, widening, swelling, growth):
    """Write the derivatives of the area, of the residual by it (size + 1, LANES), and of the load by it (LANES,).

    Those of the area are by the displacements, and by the depth in the last row.

    Parameters
    ----------
    coupling
        See `Coupling`.
    widening, swelling : ndarray, shape (size + 1, LANES)
        Out: derivatives of the area, and of the residual by it.
    growth : ndarray, shape (LANES,)
        Out: derivative of the load by the area.
    """
    size, none = widening.shape[0] - 1, splat(0.0)
    for i in range(size + 1):
        store(widening, i, none)
        store(swelling, i, none)
    response = larger(1.0 - load(coupling.feedback, 0), splat(LEAST_RESPONSE))
    deeper, together = none, none
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        rate, push = load(coupling.touching, 2 * k + 1) / response, load(coupling.by_area, 2 * k + 1)
        store(widening, z, rate)
        store(swelling, z, push)
        deeper, together = deeper + rate, together + push
        if r >= 0:
            store(widening, r, load(coupling.touching, 2 * k) / response)
            store(swelling, r, load(coupling.by_area, 2 * k))
    store(widening, size, deeper)
    store(growth, 0, together)


@inner_kernel(cache=True)
def add_tangent(body, tangent, geometric, lower, upper, column, row, corner):
    """Add the tangent of the contact to the band; write column and row (size + 1, LANES) and diagonal of the depth.

    Without friction the matrix is symmetric: `upper` is empty, see `palpate.solver.axisymmetric.banded`, and the `row`
    the `column`. `geometric` (LANES,) is zero where the matrix is to be positive definite.

    Parameters
    ----------
    tangent
        See `Coupling`.
    lower, upper : ndarray, shape (size * width + 1, LANES)
        In and out: both halves of the band.
    column, row : ndarray, shape (size + 1, LANES)
        Out: border of the depth.
    corner : ndarray, shape (LANES,)
        Out: diagonal entry of the depth.
    """
    symmetric, none, half, whole = len(upper) == 0, splat(0.0), splat(0.5), splat(0.0)
    kept = load(geometric, 0)
    if not symmetric:
        copy_rows(lower, upper)
    for i in range(column.shape[0]):
        store(column, i, none)
        if not symmetric:
            store(row, i, none)
    for k in range(body.radial.shape[0]):
        r, z, at = body.radial[k], body.vertical[k], 8 * k
        upright = where_less(half, kept, load(tangent, at + 3), load(tangent, at + 7))
        add_to(lower, entry(z, z, body.width), upright)
        store(column, z, upright)
        whole = whole + upright
        if not symmetric:
            store(row, z, upright)
        if r >= 0:
            by_gap = where_less(half, kept, load(tangent, at + 1), load(tangent, at + 5))
            add_to(lower, entry(r, r, body.width), where_less(half, kept, load(tangent, at), load(tangent, at + 4)))
            add_to(lower, entry(z, r, body.width), by_gap)
            store(column, r, by_gap)
            if not symmetric:
                across = where_less(half, kept, load(tangent, at + 2), load(tangent, at + 6))
                add_to(upper, entry(z, r, body.width), across)
                store(row, r, across)
    store(corner, 0, whole)


@inner_kernel(cache=True)
def add_to(rows, i, value):
    """Add a vector to row `i` of `rows` (n, LANES)."""
    store(rows, i, load(rows, i) + value)


@inner_kernel(cache=True, inline="always")
def entry(i, j, width):
    """Return where the band holds the entry (i, j)."""
    return min(i, j) * width + abs(i - j)
