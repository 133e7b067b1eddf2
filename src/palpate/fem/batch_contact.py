"""Contact with a rigid frictionless indenter, as `palpate.fem.contact`, for `LANES` indentations at once.

A node that touches, u_z = f(r + u_r) - depth, is eliminated from the assembled system: forces and matrix are those in
the unknowns u_r and depth, K' = T^T K T and, at large strains, what the curvature of f adds. A lane in which a node
does not touch has zeros in its place of the mask.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_banded import PANEL
from palpate.fem.batch_vector import LANES, greatest, load, magnitude, splat, store
from palpate.fem.contact import PENETRATION, Profile


class Touch(NamedTuple):
    """The contact during the iterations.

    Attributes
    ----------
    radius, edge, flank : ndarray, shape (LANES,)
        Radius of the cap, distance from the axis at which it ends, and slope of the cone beyond.
    slope, curvature : ndarray, shape (k, LANES)
        Slope and curvature of the profile where each surface node is.
    touching : ndarray, shape (k, LANES)
        One where a surface node touches, else zero.
    gap : ndarray, shape (k, LANES)
        Gap that the next change of displacements closes.
    push : ndarray, shape (k, LANES)
        Vertical force on each node that touches.
    joined : ndarray of bool, shape (LANES,)
        Whether some gap is to be closed.
    """

    radius: np.ndarray
    edge: np.ndarray
    flank: np.ndarray
    slope: np.ndarray
    curvature: np.ndarray
    touching: np.ndarray
    gap: np.ndarray
    push: np.ndarray
    joined: np.ndarray

    @classmethod
    def at_apex(cls, profiles: Sequence[Profile], count: int) -> Touch:
        """Return indenters whose apex alone touches the first of `count` nodes; lengths are in units of the lanes."""
        slope, curvature, touching, gap, push = np.zeros((5, count, LANES))
        touching[0] = 1.0
        radius, edge, flank = np.array([(p.radius, p.edge, p.flank) for p in profiles]).T.copy()
        return cls(radius, edge, flank, slope, curvature, touching, gap, push, np.zeros(LANES, dtype=np.bool_))


@njit(cache=True)
def follow(large, body, touch, displacement, depth, done):
    """Put the nodes that touch onto the indenters and let those join that lie inside, in the lanes not `done`.

    The profile is that at the nodes, and at small strains its tangent where they were, see `palpate.fem.contact`.
    """
    for lane in range(LANES):
        if done[lane]:
            continue
        touch.joined[lane] = False
        radius, edge = touch.radius[lane], touch.edge[lane]
        for k in range(body.radial.shape[0]):
            z = body.vertical[k]
            moved = displacement[body.radial[k], lane] if body.radial[k] >= 0 else 0.0
            distance = body.distance[k] + moved if large else body.distance[k]
            height, slope, curvature = touch.flank[lane] * distance, touch.flank[lane], 0.0
            if radius > 0.0:
                root = np.sqrt(radius**2 - min(distance, edge) ** 2)
                height, slope = radius - root + max(distance - edge, 0.0) * slope, min(distance, edge) / root
                curvature = radius**2 / root**3 if distance < edge else 0.0
            if not large:
                height, curvature = height + slope * moved, 0.0
            touch.slope[k, lane], touch.curvature[k, lane] = slope, curvature
            gap = height - depth[lane] - displacement[z, lane]
            touch.gap[k, lane] = 0.0
            if touch.touching[k, lane] > 0.0:
                displacement[z, lane] += gap
            elif gap < -PENETRATION * abs(depth[lane]):
                touch.touching[k, lane] = 1.0
                touch.gap[k, lane] = gap
                touch.joined[lane] = True


@njit(cache=True)
def pulled(body, touch, forces, lane, tolerance):
    """Return whether the indenter of a lane would have to pull a node by more than a `tolerance`."""
    for k in range(body.radial.shape[0]):
        if touch.touching[k, lane] > 0.0 and pressing(body, touch, forces, k, lane) < -tolerance:
            return True
    return False


@njit(cache=True)
def pressing(body, touch, forces, k, lane):
    """Return the force of the indenter on a node along its normal, times 1 / cos of the slope."""
    along = touch.slope[k, lane] * forces[body.radial[k], lane] if body.radial[k] >= 0 else 0.0
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
    """Put balance along the profiles in place of the forces of the nodes that touch; add the rest to `reaction`."""
    total = splat(0.0)
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        vertical = load(forces, z)
        force = load(touch.touching, k) * vertical
        total = total + force
        store(touch.push, k, force)
        store(forces, z, vertical - force)
        if r >= 0:
            store(forces, r, load(forces, r) + load(touch.slope, k) * force)
    store(reaction, 0, total)


@njit(cache=True)
def constrain_matrix(body, touch, geometric, band, border, corner):
    """Eliminate the nodes that touch from `band`; write the column (size, LANES) and diagonal (LANES,) of the depth.

    The curvature of the profiles counts where `geometric` (LANES,) is one.
    """
    border[:] = 0.0
    corner[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z, held = body.radial[k], body.vertical[k], load(touch.touching, k)
        if greatest(held) == 0.0:
            continue
        slope, curvature = load(touch.slope, k) * held, load(touch.curvature, k) * load(geometric, 0)
        diagonal = load(band, entry(z, z, body.width))
        side = load(border, z)
        store(corner, 0, load(corner, 0) + held * (diagonal - 2.0 * side))
        if r >= 0:
            shared = load(band, entry(z, r, body.width))
            own = load(band, entry(r, r, body.width))
            own = own + slope * (2.0 * shared + slope * diagonal) + curvature * load(touch.push, k)
            store(band, entry(r, r, body.width), own)
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
