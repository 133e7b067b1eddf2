"""Curves between their points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

SMOOTH = 3  # knots between two corners, from which on a curve is smooth there
SAME = 1e-9  # of the time, within which a knot lies at a corner
STAYING = 1e-3  # of the way of a root that goes up once, for the time of a whole test


def smooth_between(corners: np.ndarray, time: np.ndarray, knots: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return columns at all times, shape (n, k), smooth between corners, where they may have a kink.

    They are monotone cubics (PCHIP) where three knots or more lie between two corners, else straight lines. Straight
    lines everywhere would have a kink at each knot, which correlated noise has not.

    Parameters
    ----------
    corners : ndarray, shape (c,)
        Times of the corners [s].
    time : ndarray, shape (n,)
        Where they are asked for [s].
    knots : ndarray, shape (m,)
        Where they are known [s].
    columns : ndarray, shape (m, k)
        What they are there.

    Source: F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.
    """
    found = np.stack([np.interp(time, knots, column) for column in columns.T], axis=1)
    near = SAME * time[-1]
    for first, last in pairwise([-np.inf, *corners, np.inf]):
        between = (knots >= first - near) & (knots <= last + near)
        if between.sum() >= SMOOTH:
            own = knots[between]
            inside = (time >= own[0]) & (time <= own[-1])
            found[inside] = PchipInterpolator(own, columns[between])(time[inside])
    return found


def depth_at(
    moments: np.ndarray, time: np.ndarray, depth: np.ndarray, corners: np.ndarray, drive: np.ndarray
) -> np.ndarray:
    """Return the depth at some moments of a curve that starts at (0, 0), smooth between the corners of its history.

    The depth of a sharp tip goes about with the root of the load: from the start of loading on, and to the end of
    unloading, where cones recover like the root and creeping bodies like a power of 0.6 to 0.7. So points are joined
    along the way that the root of the drive has gone, by monotone cubics (PCHIP). Straight lines in time through the
    160 points of a test would err by 1.4 nm of 1600 before the end of unloading.

    Parameters
    ----------
    moments : ndarray, shape (m,)
        Where it is asked for [s].
    time, depth : ndarray, shape (n,)
        Points of the curve [s], [nm].
    corners, drive : ndarray, shape (c,)
        Corners of the history [s], and what drives the test there, the load or the displacement.
    """
    after = time > SAME * corners[-1]  # a point that coincides with the start would make the curve level there
    points, values = np.append(0.0, time[after]), np.append(0.0, depth[after])
    asked, known, ends = (_way_of_root(each, corners, drive) for each in (moments, points, corners))
    found = smooth_between(ends, asked, known, values[:, None])[:, 0]
    return np.where(np.abs(found) < SAME * np.abs(values).max(), 0.0, found)  # a test may end where it began


def _way_of_root(time: np.ndarray, corners: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Return how far the root of the drive has gone up and down at times (n,), as a share of its largest value.

    While it stays the time counts a little.
    """
    largest = float(np.abs(drive).max()) or 1.0
    roots = np.sqrt(np.abs(drive) / largest)
    gone = np.append(0.0, np.cumsum(np.abs(np.diff(roots))))
    last = np.clip(np.searchsorted(corners, time, side="right") - 1, 0, len(corners) - 1)
    root = np.sqrt(np.abs(np.interp(time, corners, drive)) / largest)
    return gone[last] + np.abs(root - roots[last]) + STAYING * time / corners[-1]


def load_at(moments: np.ndarray, time: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the load (m,) at some moments (m,) of a curve that starts at (0, 0), along straight lines (n,)."""
    return np.interp(moments, np.append(0.0, time), np.append(0.0, load))
