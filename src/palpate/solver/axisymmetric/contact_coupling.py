"""How the forces and the area of the contact depend on its nodes and on each other, and their place in the matrix.

Arguments of several functions: `body` is that of `palpate.solver.axisymmetric.element`; `geometric` (LANES,) is zero
where the matrix is to be positive definite.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES
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
    size = widening.shape[0] - 1
    widening[:], swelling[:], growth[:] = 0.0, 0.0, 0.0
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            response = max(1.0 - coupling.feedback[lane], LEAST_RESPONSE)
            rate = coupling.touching[k, 1, lane] / response
            widening[z, lane] += rate
            widening[size, lane] += rate
            swelling[z, lane] += coupling.by_area[k, 1, lane]
            growth[lane] += coupling.by_area[k, 1, lane]
            if r >= 0:
                widening[r, lane] += coupling.touching[k, 0, lane] / response
                swelling[r, lane] += coupling.by_area[k, 0, lane]


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
    symmetric = len(upper) == 0
    column[:] = 0.0
    corner[:] = 0.0
    if not symmetric:
        copy_rows(lower, upper)
        row[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            part = 0 if geometric[lane] > 0.0 else 1
            vertical = tangent[k, part, 3, lane]
            lower[entry(z, z, body.width), lane] += vertical
            column[z, lane] += vertical
            corner[lane] += vertical
            if not symmetric:
                row[z, lane] += vertical
            if r >= 0:
                by_gap, across = tangent[k, part, 1, lane], tangent[k, part, 2, lane]
                lower[entry(r, r, body.width), lane] += tangent[k, part, 0, lane]
                lower[entry(z, r, body.width), lane] += by_gap
                column[r, lane] += by_gap
                if not symmetric:
                    upper[entry(z, r, body.width), lane] += across
                    row[r, lane] += across


@inner_kernel(cache=True, inline="always")
def entry(i, j, width):
    """Return where the band holds the entry (i, j)."""
    return min(i, j) * width + abs(i - j)
