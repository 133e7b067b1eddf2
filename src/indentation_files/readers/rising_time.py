"""Which points of a recording come later than those before them, where some of its times are spoilt."""

from __future__ import annotations

from bisect import bisect_left

import numpy as np

ROUNDING = 1e-9  # of a recording's duration: times that differ less are one


def increasing(time: np.ndarray) -> np.ndarray:
    """Return which points of `time` (n,) rise, by more than its rounding, while the fewest are left out.

    So a time that is too late by far is left out itself, not all that follow it.
    """
    rounding = ROUNDING * np.ptp(time)
    latest = time if (time[1:] > time[:-1]).all() else np.maximum.accumulate(time)
    if latest is time or not (latest - time > rounding).any():
        return np.append(True, np.diff(latest) > rounding)
    places = _longest_rise(time)
    rising = np.zeros(len(time), dtype=bool)
    rising[places[np.append(True, np.diff(time[places]) > rounding)]] = True
    return rising


def stands_still(time: np.ndarray, rising: np.ndarray) -> np.ndarray:
    """Return which points of `time` (n,) repeat the last one before them that is `rising`."""
    if rising.all():
        return ~rising
    latest = np.maximum.accumulate(np.where(rising, time, -np.inf))
    return ~rising & (np.abs(time - latest) <= ROUNDING * np.ptp(time))


def _longest_rise(time: np.ndarray) -> np.ndarray:
    """Return the numbers of a longest subsequence of `time` (n,) that never stands still or falls.

    By the least last time of a subsequence of each length (Fredman, Discrete Mathematics 11, 1975).
    """
    ends: list[float] = []
    places: list[int] = []
    before = np.full(len(time), -1)
    for k, value in enumerate(time.tolist()):
        length = bisect_left(ends, value)
        if length:
            before[k] = places[length - 1]
        if length == len(ends):
            ends.append(value)
            places.append(k)
        elif value < ends[length]:
            ends[length], places[length] = value, k
    chosen = [places[-1]]
    while before[chosen[-1]] >= 0:
        chosen.append(int(before[chosen[-1]]))
    return np.array(chosen[::-1])
