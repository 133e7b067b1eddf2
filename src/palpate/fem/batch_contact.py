"""Contact with a rigid frictionless cone, as `palpate.fem.contact`, for `LANES` indentations at once.

A node that touches, u_z = slope (r + u_r) - depth, is eliminated from the assembled system: forces and matrix are those
in the unknowns u_r and depth, K' = T^T K T. A lane in which a node does not touch has zeros in its place of the mask.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_banded import PANEL
from palpate.fem.batch_vector import LANES, greatest, load, magnitude, splat, store
from palpate.fem.contact import PENETRATION


class Touch(NamedTuple):
    """The contact during the iterations.

    Attributes
    ----------
    slope : ndarray, shape (LANES,)
        Slope of the cones.
    touching : ndarray, shape (k, LANES)
        One where a surface node touches, else zero.
    gap : ndarray, shape (k, LANES)
        Gap that the next change of displacements closes.
    joined : ndarray of bool, shape (LANES,)
        Whether some gap is to be closed.
    """

    slope: np.ndarray
    touching: np.ndarray
    gap: np.ndarray
    joined: np.ndarray

    @classmethod
    def at_apex(cls, slope: np.ndarray, count: int) -> Touch:
        """Return cones whose apex alone touches the first of `count` nodes."""
        touching = np.zeros((count, LANES))
        touching[0] = 1.0
        return cls(slope, touching, np.zeros((count, LANES)), np.zeros(LANES, dtype=np.bool_))


@njit(cache=True)
def follow(body, touch, displacement, depth, done):
    """Put the nodes that touch onto the cones and let those join that lie inside, in the lanes that are not `done`."""
    for lane in range(LANES):
        if done[lane]:
            continue
        touch.joined[lane] = False
        for k in range(body.radial.shape[0]):
            z = body.vertical[k]
            moved = displacement[body.radial[k], lane] if body.radial[k] >= 0 else 0.0
            gap = touch.slope[lane] * (body.distance[k] + moved) - depth[lane] - displacement[z, lane]
            touch.gap[k, lane] = 0.0
            if touch.touching[k, lane] > 0.0:
                displacement[z, lane] += gap
            elif gap < -PENETRATION * abs(depth[lane]):
                touch.touching[k, lane] = 1.0
                touch.gap[k, lane] = gap
                touch.joined[lane] = True


@njit(cache=True)
def pulled(body, touch, forces, lane, tolerance):
    """Return whether the cone of a lane would have to pull a node by more than a `tolerance`."""
    for k in range(body.radial.shape[0]):
        if touch.touching[k, lane] > 0.0 and pressing(body, touch, forces, k, lane) < -tolerance:
            return True
    return False


@njit(cache=True)
def pressing(body, touch, forces, k, lane):
    """Return the force of the cone on a node along its normal, times 1 / cos of the slope."""
    along = touch.slope[lane] * forces[body.radial[k], lane] if body.radial[k] >= 0 else 0.0
    return along - forces[body.vertical[k], lane]


@njit(cache=True)
def release(body, touch, forces, lane, tolerance):
    """Let go the nodes of a lane that are pulled, but keep one; return whether any went."""
    before, kept, last, largest = 0, 0, 0, -np.inf
    for k in range(body.radial.shape[0]):
        if touch.touching[k, lane] > 0.0:
            before += 1
            if pressing(body, touch, forces, k, lane) < -tolerance:
                touch.touching[k, lane] = 0.0
                if forces[body.vertical[k], lane] > largest:
                    last, largest = k, forces[body.vertical[k], lane]
            else:
                kept += 1
    if kept == 0:
        touch.touching[last, lane] = 1.0
    return before > max(kept, 1)


@njit(cache=True)
def close_gaps(body, touch, band, forces):
    """Add to the `forces` what closing the gaps will add to them by the assembled stiffness."""
    for k in range(body.radial.shape[0]):
        z, gap = body.vertical[k], load(touch.gap, k)
        if greatest(magnitude(gap)) > 0.0:
            for m in range(max(0, z - body.width + PANEL), min(body.size, z + body.width - PANEL + 1)):
                store(forces, m, load(forces, m) + gap * load(band, entry(m, z, body.width)))


@njit(cache=True)
def constrain_forces(body, touch, forces, reaction):
    """Put balance along the generators in place of the forces of the nodes that touch; add the rest to `reaction`."""
    slope, total = load(touch.slope, 0), splat(0.0)
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        vertical = load(forces, z)
        force = load(touch.touching, k) * vertical
        total = total + force
        store(forces, z, vertical - force)
        if r >= 0:
            store(forces, r, load(forces, r) + slope * force)
    store(reaction, 0, total)


@njit(cache=True)
def constrain_matrix(body, touch, band, border, corner):
    """Eliminate the nodes that touch from `band`; write the column (size, LANES) and diagonal (LANES,) of the depth."""
    border[:] = 0.0
    corner[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z, held = body.radial[k], body.vertical[k], load(touch.touching, k)
        if greatest(held) == 0.0:
            continue
        slope = load(touch.slope, 0) * held
        diagonal = load(band, entry(z, z, body.width))
        side = load(border, z)
        store(corner, 0, load(corner, 0) + held * (diagonal - 2.0 * side))
        if r >= 0:
            shared = load(band, entry(z, r, body.width))
            own = load(band, entry(r, r, body.width))
            store(band, entry(r, r, body.width), own + slope * (2.0 * shared + slope * diagonal))
            store(border, r, load(border, r) + slope * (side - diagonal) - held * shared)
            store(band, entry(z, r, body.width), shared - held * shared)
        store(border, z, side - held * side)
        for m in range(max(0, z - body.width + PANEL), min(body.size, z + body.width - PANEL + 1)):
            if r <= m <= z:
                continue
            value = load(band, entry(m, z, body.width))
            store(band, entry(m, z, body.width), value - held * value)
            store(border, m, load(border, m) - held * value)
            if r >= 0:
                store(band, entry(m, r, body.width), load(band, entry(m, r, body.width)) + slope * value)


@njit(cache=True, inline="always")
def entry(i, j, width):
    """Return where the band holds the entry (i, j)."""
    return min(i, j) * width + abs(i - j)
