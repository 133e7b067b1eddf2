"""Contact with a rigid indenter, as `palpate.fem.contact`, for `LANES` indentations at once.

A node that touches, u_z = f(r + u_r) - depth, is eliminated from the assembled system: forces and matrix are those in
the unknowns u_r and depth, K' = S^T K T and what curvature of f and friction add. T follows the indenter; S is the same
without friction, and else puts balance along the generator in place of the node's forces, (1 + m f') F_r + (f' - m) F_z
= 0. A lane in which a node does not touch has zeros in its place of the mask.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_banded import PANEL
from palpate.fem.batch_friction import anchor, arrive, reverses, rub, set_out
from palpate.fem.batch_vector import LANES, greatest, load, magnitude, splat, store
from palpate.fem.contact import PENETRATION
from palpate.fem.profile import Capped, Measured, Profile


class Touch(NamedTuple):
    """The contact during the iterations.

    Attributes
    ----------
    radius, edge, flank : ndarray, shape (LANES,)
        Radius of the cap, distance from the axis at which it ends, and slope of the cone beyond.
    knots : ndarray, shape (m, 3, LANES)
        Of measured tips, see `palpate.fem.profile.Measured`; zeros in the other lanes.
    slope, curvature : ndarray, shape (k, LANES)
        Slope and curvature of the profile where each surface node is.
    touching : ndarray, shape (k, LANES)
        One where a surface node touches, else zero.
    gap : ndarray, shape (k, LANES)
        Gap that the next change of displacements closes.
    upward, outward : ndarray, shape (k, LANES)
        Vertical and radial force on each node that touches.
    joined : ndarray of bool, shape (LANES,)
        Whether some gap is to be closed.
    """

    radius: np.ndarray
    edge: np.ndarray
    flank: np.ndarray
    knots: np.ndarray
    slope: np.ndarray
    curvature: np.ndarray
    touching: np.ndarray
    gap: np.ndarray
    upward: np.ndarray
    outward: np.ndarray
    joined: np.ndarray

    @classmethod
    def at_apex(cls, profiles: Sequence[Profile], count: int) -> Touch:
        """Return indenters whose apex alone touches the first of `count` nodes; lengths are in units of the lanes."""
        slope, curvature, touching, gap, upward, outward = np.zeros((6, count, LANES))
        touching[0] = 1.0
        caps = [(p.radius, p.edge, p.flank) if isinstance(p, Capped) else (0.0, 0.0, 0.0) for p in profiles]
        radius, edge, flank = np.array(caps).T.copy()
        joined = np.zeros(LANES, dtype=np.bool_)
        return cls(radius, edge, flank, _knots(profiles), slope, curvature, touching, gap, upward, outward, joined)


def _knots(profiles: Sequence[Profile]) -> np.ndarray:
    """Return the knots (m, 3, LANES) of measured tips; those with fewer go on along their flank."""
    measured = [profile.knots if isinstance(profile, Measured) else np.zeros((0, 3)) for profile in profiles]
    most = max(map(len, measured))
    table = np.zeros((most, 3, LANES))
    for lane, knots in enumerate(measured):
        if len(knots):
            r, f, slope = knots[-1]
            further = r * np.arange(1, most - len(knots) + 1)
            beyond = np.column_stack([r + further, f + slope * further, np.full_like(further, slope)])
            table[:, :, lane] = np.vstack([knots, beyond])
    return table


@njit(cache=True)
def measured(knots, lane, place):
    """Return height, slope and curvature of a measured tip at one distance, see `palpate.fem.profile.Measured`."""
    low, high = 0, knots.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle, 0, lane] < place:
            low = middle
        else:
            high = middle
    width = knots[high, 0, lane] - knots[low, 0, lane]
    off = (place - knots[low, 0, lane]) / width
    t = min(max(off, 0.0), 1.0)
    rise, first, last = (knots[high, 1, lane] - knots[low, 1, lane]) / width, knots[low, 2, lane], knots[high, 2, lane]
    square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
    slope = first + t * (2.0 * square + 3.0 * cube * t)
    curvature = (2.0 * square + 6.0 * cube * t) / width if off < 1.0 else 0.0
    height = knots[low, 1, lane] + width * t * (first + t * (square + cube * t)) + max(off - 1.0, 0.0) * width * slope
    return height, slope, curvature


@njit(cache=True)
def beneath(large, touch, lane, distance, moved):
    """Return height, slope and curvature of a lane's profile at a node that moved outwards from its `distance`.

    At small strains along the tangent where it was, see `palpate.fem.contact`.
    """
    radius, edge = touch.radius[lane], touch.edge[lane]
    place = distance + moved if large else distance
    height, slope, curvature = touch.flank[lane] * place, touch.flank[lane], 0.0
    if touch.knots.shape[0] > 0 and touch.knots[-1, 0, lane] > 0.0:
        height, slope, curvature = measured(touch.knots, lane, place)
    elif radius > 0.0:
        root = np.sqrt(radius**2 - min(place, edge) ** 2)
        height, slope = radius - root + max(place - edge, 0.0) * slope, min(place, edge) / root
        curvature = radius**2 / root**3 if place < edge else 0.0
    if large:
        return height, slope, curvature
    return height + slope * moved, slope, 0.0


@njit(cache=True)
def begin_step(large, body, touch, grip, displacement, depth, step):
    """Begin steps of so many seconds (LANES,) at some displacements (size + 1, LANES) and depths."""
    for k in range(body.radial.shape[0]):
        r, z, distance = body.radial[k], body.vertical[k], body.distance[k]
        for lane in range(LANES):
            moved = displacement[r, lane] if r >= 0 else 0.0
            height = beneath(large, touch, lane, distance, moved)[0]
            set_out(grip, k, lane, distance + moved, height - depth[lane] - displacement[z, lane], step[lane])


@njit(cache=True)
def end_step(body, touch, grip, displacement, step):
    """End steps of so many seconds (LANES,) at some displacements (size + 1, LANES)."""
    for k in range(body.radial.shape[0]):
        r = body.radial[k]
        for lane in range(LANES):
            moved = displacement[r, lane] if r >= 0 else 0.0
            arrive(grip, k, lane, body.distance[k] + moved, touch.touching[k, lane] > 0.0, step[lane])


@njit(cache=True)
def follow(large, body, touch, grip, displacement, depth, done):
    """Put the nodes that touch onto the indenters and let those join that lie inside, in the lanes not `done`."""
    for lane in range(LANES):
        if done[lane]:
            continue
        touch.joined[lane], grip.changed[lane] = False, False
        for k in range(body.radial.shape[0]):
            r, z, distance, moved = body.radial[k], body.vertical[k], body.distance[k], 0.0
            if r >= 0:
                if reverses(grip, k, lane, distance + displacement[r, lane]):
                    displacement[r, lane] = grip.anchor[k, lane] - distance
                moved = displacement[r, lane]
            height, slope, curvature = beneath(large, touch, lane, distance, moved)
            touch.slope[k, lane], touch.curvature[k, lane] = slope, curvature
            gap = height - depth[lane] - displacement[z, lane]
            touch.gap[k, lane] = 0.0
            if touch.touching[k, lane] > 0.0:
                displacement[z, lane] += gap
            elif gap < -PENETRATION * abs(depth[lane]):
                touch.touching[k, lane] = 1.0
                touch.gap[k, lane] = gap
                touch.joined[lane] = True
                anchor(grip, k, lane, gap)
            rub(grip, k, lane, distance + moved)


@njit(cache=True)
def pulled(body, touch, attraction, forces, lane, tolerance):
    """Return whether the indenter of a lane would have to pull a node by a `tolerance` more than attraction does."""
    for k in range(body.radial.shape[0]):
        if touch.touching[k, lane] > 0.0 and pressing(body, touch, attraction, forces, k, lane) < -tolerance:
            return True
    return False


@njit(cache=True)
def pressing(body, touch, attraction, forces, k, lane):
    """Return the force of the contact on a node along its normal, attraction aside, times 1 / cos of the slope."""
    slope, radial = (touch.slope[k, lane], forces[body.radial[k], lane]) if body.radial[k] >= 0 else (0.0, 0.0)
    return slope * radial - forces[body.vertical[k], lane] + (1.0 + slope**2) * attraction.hold[k, lane]


@njit(cache=True)
def release(body, touch, attraction, forces, lane, tolerance, keeps):
    """Let go the nodes of a lane that are pulled, but keep one where the lane `keeps` it; return whether any went."""
    before, kept, last, largest = 0, 0, 0, -np.inf
    for k in range(body.radial.shape[0]):
        if touch.touching[k, lane] > 0.0:
            before += 1
            if pressing(body, touch, attraction, forces, k, lane) < -tolerance:
                touch.touching[k, lane] = 0.0
                if forces[body.vertical[k], lane] > largest:
                    last, largest = k, forces[body.vertical[k], lane]
            else:
                kept += 1
    if kept == 0 and keeps:
        touch.touching[last, lane] = 1.0
        kept = 1
    return before > kept


@njit(cache=True)
def close_gaps(body, touch, band, forces):
    """Add to the `forces` what closing the gaps will add to them by the assembled stiffness."""
    for k in range(body.radial.shape[0]):
        z, gap = body.vertical[k], load(touch.gap, k)
        if greatest(magnitude(gap)) > 0.0:
            for m in range(max(0, z - body.width + PANEL), min(body.size, z + body.width - PANEL + 1)):
                store(forces, m, load(forces, m) + gap * load(band, entry(m, z, body.width)))


@njit(cache=True)
def constrain_forces(body, touch, grip, forces, reaction):
    """Put balance along the profiles in place of the forces of the nodes that touch; add the rest to `reaction`."""
    total = splat(0.0)
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        vertical = load(forces, z)
        force = load(touch.touching, k) * vertical
        total = total + force
        store(touch.upward, k, force)
        store(forces, z, vertical - force)
        if r >= 0:
            radial = load(forces, r)
            along, across = balance(touch, grip, k)
            store(touch.outward, k, load(touch.touching, k) * radial)
            store(forces, r, along * radial + across * vertical)
    store(reaction, 0, total)


@njit(cache=True, inline="always")
def balance(touch, grip, k):
    """Return what a node's two forces count along the profile: one and zero where it does not touch."""
    held, slope, ratio = load(touch.touching, k), load(touch.slope, k), load(grip.ratio, k)
    return 1.0 + held * (ratio * slope), held * (slope - ratio)


@njit(cache=True)
def constrain_matrix(body, touch, grip, geometric, lower, upper, column, row, corner):
    """Eliminate the nodes that touch from the matrix; write column and row (size, LANES) and diagonal of the depth.

    The curvature of the profiles counts where `geometric` (LANES,) is one. Without friction the matrix is symmetric:
    `upper` is empty, see `palpate.fem.batch_banded`, and the `row` the `column`.
    """
    symmetric = len(upper) == 0
    column[:] = 0.0
    corner[:] = 0.0
    if not symmetric:
        upper[:] = lower
        row[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z, held = body.radial[k], body.vertical[k], load(touch.touching, k)
        if greatest(held) == 0.0:
            continue
        slope = held * load(touch.slope, k)
        along, across = balance(touch, grip, k)
        diagonal = load(lower, entry(z, z, body.width))
        side, below = load(column, z), load(row, z)
        store(corner, 0, load(corner, 0) + held * (diagonal - side - below))
        if r >= 0:
            shared = load(lower, entry(z, r, body.width))
            own = load(lower, entry(r, r, body.width))
            own = along * (own + slope * shared) + across * (shared + slope * diagonal)
            upward, outward = load(touch.upward, k), load(touch.outward, k)
            own = own + load(touch.curvature, k) * load(geometric, 0) * (upward + load(grip.ratio, k) * outward)
            own = own + load(grip.steepness, k) * (load(touch.slope, k) * outward - upward)
            store(lower, entry(r, r, body.width), own)
            store(column, r, along * (load(column, r) - held * shared) + across * (side - held * diagonal))
            store(lower, entry(z, r, body.width), shared - held * shared)
            if not symmetric:
                store(row, r, load(row, r) + slope * below - held * (shared + slope * diagonal))
                store(upper, entry(z, r, body.width), shared - held * shared)
        store(column, z, side - held * side)
        if symmetric:
            fold(body, k, held, splat(1.0), slope, lower, lower, column)
        else:
            store(row, z, below - held * below)
            fold(body, k, held, splat(1.0), slope, lower, upper, column)
            fold(body, k, held, along, across, upper, lower, row)


@njit(cache=True)
def fold(body, k, held, own, other, below, above, border):
    """Add to a node's radial column, times `own`, its vertical one times `other`, and take that to the `border`.

    With the halves of the matrix exchanged the same happens to its rows.
    """
    r, z = body.radial[k], body.vertical[k]
    for m in range(max(0, z - body.width + PANEL), min(body.size, z + body.width - PANEL + 1)):
        if r <= m <= z:
            continue
        half = below if m > z else above
        value = load(half, entry(m, z, body.width))
        store(half, entry(m, z, body.width), value - held * value)
        store(border, m, load(border, m) - held * value)
        if r >= 0:
            store(half, entry(m, r, body.width), own * load(half, entry(m, r, body.width)) + other * value)


@njit(cache=True, inline="always")
def entry(i, j, width):
    """Return where the band holds the entry (i, j)."""
    return min(i, j) * width + abs(i - j)
