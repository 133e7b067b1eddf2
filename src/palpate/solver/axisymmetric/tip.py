"""The profiles of rigid tips of revolution in the lanes: height, slope and curvature at a distance from the axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES
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


@inner_kernel(cache=True)
def profile_at(large, tip, lane, distance, moved):
    """Return height, slope and curvature of a tip over a node that moved outwards from its `distance`.

    At small strains along the tangent where the node was, f(r) + f'(r) u, linear in the displacement like all else.

    Parameters
    ----------
    large
        Whether the profile is taken where the node has moved to.
    tip, lane
        The tips, and the number of the lane.
    distance, moved
        Undeformed distance from the axis, and radial displacement.
    """
    radius, edge = tip.radius[lane], tip.edge[lane]
    place = distance + moved if large else distance
    height, slope, curvature = tip.flank[lane] * place, tip.flank[lane], 0.0
    if tip.knots.shape[0] > 0 and tip.knots[-1, 0, lane] > 0.0:
        height, slope, curvature = between_knots(tip.knots, lane, place)
    elif radius > 0.0:
        root = np.sqrt(radius**2 - min(place, edge) ** 2)
        height, slope = radius - root + max(place - edge, 0.0) * slope, min(place, edge) / root
        curvature = radius**2 / root**3 if place < edge else 0.0
    if large:
        return height, slope, curvature
    return height + slope * moved, slope, 0.0
