"""Curves between their points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

SMOOTH = 3  # knots between two corners, from which on a curve is smooth there
SAME = 1e-9  # of the time, within which a knot lies at a corner


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


def depth_at(moments: np.ndarray, time: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the depth (m,) at some moments (m,) of a curve that starts at (0, 0), by its points at times (n,).

    Between points the square of the depth is linear, as that of a sharp tip is while the load grows evenly: straight
    lines through few points of a curve that begins like a root would lie below it by many nanometres.
    """
    square = np.interp(moments, np.append(0.0, time), np.append(0.0, depth * np.abs(depth)))
    return np.sign(square) * np.sqrt(np.abs(square))


def load_at(moments: np.ndarray, time: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the load (m,) at some moments (m,) of a curve that starts at (0, 0), along straight lines (n,)."""
    return np.interp(moments, np.append(0.0, time), np.append(0.0, load))
