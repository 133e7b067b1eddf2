"""Corners of a history: the points between which straight lines describe it (Douglas and Peucker)."""

from __future__ import annotations

import numpy as np


def corners(time: np.ndarray, drive: np.ndarray, allowed: float) -> np.ndarray:
    """Return which points (n,) a piecewise linear history must keep to stay within `allowed` of all others."""
    keep = np.zeros(len(time), dtype=bool)
    keep[[0, -1]] = True
    pending = [(0, len(time) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        chord = np.interp(time[first : last + 1], time[[first, last]], drive[[first, last]])
        distance = np.abs(drive[first : last + 1] - chord)
        worst = first + int(np.argmax(distance))
        if distance.max() > allowed:
            keep[worst] = True
            pending += [(first, worst), (worst, last)]
    return keep
