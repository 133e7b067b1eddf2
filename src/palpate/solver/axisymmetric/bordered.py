"""The linearised system of a step: the band matrix of body and contact, bordered by depth and area of the contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.rows import put_rows


class System(NamedTuple):
    """The linearised system of `LANES` indentations, bordered by the depth.

    Attributes
    ----------
    band, upper : ndarray, shape (size * width + 1, LANES)
        Both halves of the matrix or of its factor; `upper` is empty without friction.
    border, row : ndarray, shape (size + 1, LANES)
        Derivatives of all forces by the depth, and of the load by the displacements; one array without friction.
    corner : ndarray, shape (LANES,)
        Derivative of the load by the depth.
    sideways : ndarray, shape (size + 1, LANES)
        Solution for the border.
    widening, swelling : ndarray, shape (size + 1, LANES)
        Derivatives of the area, and solution for those of all forces by it, see
        `palpate.solver.axisymmetric.contact.spread`.
    growth : ndarray, shape (LANES,)
        Derivative of the load by the area.
    """

    band: np.ndarray
    upper: np.ndarray
    border: np.ndarray
    row: np.ndarray
    corner: np.ndarray
    sideways: np.ndarray
    widening: np.ndarray
    swelling: np.ndarray
    growth: np.ndarray

    @classmethod
    def of(cls, body: Body, symmetric: bool) -> System:
        """Return storage for the systems of a body."""
        band, border = np.empty((body.size * body.width + 1, LANES)), np.zeros((body.size + 1, LANES))
        upper = np.empty((0, LANES)) if symmetric else np.empty_like(band)
        row = border if symmetric else np.zeros_like(border)
        sideways, widening, swelling = (np.zeros_like(border) for _ in range(3))
        return cls(band, upper, border, row, np.zeros(LANES), sideways, widening, swelling, np.zeros(LANES))


@inner_kernel(cache=True)
def copy_of(system):
    """Return a copy of the linearised system."""
    return System(
        system.band.copy(), system.upper.copy(), system.border.copy(), system.row.copy(), system.corner.copy(),
        system.sideways.copy(), system.widening.copy(), system.swelling.copy(), system.growth.copy(),
    )  # fmt: skip


@inner_kernel(cache=True)
def put_back(system, before, changed):
    """Make the system what it was before in the lanes that have not `changed` (LANES,): their factor serves on."""
    kept = ~changed
    for now, then in (
        (system.band, before.band), (system.upper, before.upper), (system.border, before.border),
        (system.row, before.row), (system.sideways, before.sideways), (system.widening, before.widening),
        (system.swelling, before.swelling),
    ):  # fmt: skip
        put_rows(then, now, kept)
    for lane in range(LANES):
        if not changed[lane]:
            system.corner[lane], system.growth[lane] = before.corner[lane], before.growth[lane]
