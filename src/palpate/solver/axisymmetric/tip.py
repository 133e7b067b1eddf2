"""The profiles of rigid tips of revolution in the lanes: height, slope and curvature at a distance from the axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES, load, root, smaller, splat, store, where_less
from palpate.solver.axisymmetric.profile import Capped, Measured, Profile


class Tip(NamedTuple):
    """Profiles of `LANES` tips, lengths in units of the lanes.

    Attributes
    ----------
    radius, edge, flank : ndarray, shape (LANES,)
        Radius of the cap, distance from the axis at which it ends, and slope of the cone beyond.
    knots : ndarray, shape (m, 3, LANES)
        Of measured tips, see `profile.Measured`; zeros in the other lanes.
    """

    radius: np.ndarray
    edge: np.ndarray
    flank: np.ndarray
    knots: np.ndarray

    @classmethod
    def of(cls, profiles: Sequence[Profile]) -> Tip:
        """Return the tips of these profiles, one for each lane."""
        caps = [(p.radius, p.edge, p.flank) if isinstance(p, Capped) else (0.0, 0.0, 0.0) for p in profiles]
        radius, edge, flank = np.array(caps).T.copy()
        return cls(radius, edge, flank, _knots(profiles))


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


@inner_kernel(cache=True)
def between_knots(knots, lane, place):
    """Return height, slope and curvature of a measured tip at one distance, see `profile.Measured`."""
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


@inner_kernel(cache=True, error_model="numpy")
def measured_at(knots, place, height, slope, curvature):
    """Return height, slope and curvature of tips at a `place`: by `knots` where measured, as given elsewhere."""
    rows = np.empty((4, LANES))
    for i, row in enumerate((place, height, slope, curvature)):
        store(rows, i, row)
    for lane in range(LANES):
        if knots[-1, 0, lane] > 0.0:
            rows[1, lane], rows[2, lane], rows[3, lane] = between_knots(knots, lane, rows[0, lane])
    return load(rows, 1), load(rows, 2), load(rows, 3)


@inner_kernel(cache=True, error_model="numpy")
def profile_at(large, tip, distance, moved):
    """Return height, slope and curvature of the tips over nodes that moved outwards from their `distance`.

    At small strains along the tangent where the node was, f(r) + f'(r) u, linear in the displacement like all else.

    Parameters
    ----------
    large
        Whether the profile is taken where the node has moved to.
    tip
        The tips.
    distance, moved
        Undeformed distance from the axis, and radial displacement, in each lane.
    """
    radius, edge, flank, none = load(tip.radius, 0), load(tip.edge, 0), load(tip.flank, 0), splat(0.0)
    place = distance + moved if large else distance
    within = smaller(edge, place)
    length = root(radius * radius - within * within)
    inclined = within / length
    on_cap = where_less(place, edge, radius * radius / (length * length * length), none)
    slope = where_less(none, radius, inclined, flank)
    height = where_less(none, radius, radius - length + (place - within) * inclined, flank * place)
    curvature = where_less(none, radius, on_cap, none)
    if tip.knots.shape[0] > 0:
        height, slope, curvature = measured_at(tip.knots, place, height, slope, curvature)
    if large:
        return height, slope, curvature
    return height + slope * moved, slope, none
