"""An instrument that records before it moves: rest without load, before time begins to count."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from indentation_files.borne_load import OUTLIER
from indentation_files.channel_noise import noise_of
from indentation_files.contact_point import CLEAR
from indentation_files.recording import BARELY_LOADED, Recording

FEWEST = 3  # sampling steps, chosen: the first sample or two are where a test begins
FIRST = 5  # points, chosen: the median of a channel over these is what it rests at
LEAST = 0.01  # of the time from the first movement to the largest load, chosen: a shorter rest is no matter
LONGER = 0.8  # of the time until a channel leaves its noise, chosen: what moves from the start rests for less
AVERAGES = 50  # of which a rest, or the loading after it, is made, chosen
ROUNDING = 1e-6  # of a channel's range: what a channel without noise may differ by


def without_rest(r: Recording) -> tuple[Recording, tuple[str, ...]]:
    """Return a recording that begins at its first movement, and a message where a rest before it is left out.

    During a rest load and depth stay at their first level, to their noise, and the level of the load is zero. A hold
    without load after unloading is recovery, and stays. The zeros of time and depth stay as they are.
    """
    peak = int(np.argmax(r.load))
    last = _last_at_rest(r.load[:peak], r.depth[:peak], float(r.load[peak])) if peak > FIRST else 0
    rest = float(r.time[last] - r.time[0])
    if last < FEWEST or rest <= LEAST * float(r.time[peak] - r.time[last]):
        return r, ()
    message = f"the instrument rests without load for the first {rest:.4g} s: these {last} points are left out"
    return r.at(slice(last, None)), (message,)


def _last_at_rest(load: np.ndarray, depth: np.ndarray, largest: float) -> int:
    """Return the last point at rest of channels (n,) up to the `largest` load; 0 where there is no rest.

    Its average is the last at or below its level before load or depth leaves the noise, whichever does first: no part
    of the movement is lost. Where the depth stands still, the load's noise does not matter.
    """
    moved = np.zeros(len(load), dtype=bool)
    for channel in (load, depth):
        clear = max(CLEAR * noise_of(channel), BARELY_LOADED * float(np.ptp(channel)))
        moved |= np.abs(median_filter(channel, OUTLIER, mode="nearest") - np.median(channel[:FIRST])) > clear
    still = int(np.argmax(moved))
    if not still or abs(np.median(load[:still])) > max(CLEAR * noise_of(load), BARELY_LOADED * largest):
        return 0
    if np.ptp(depth[:still]) <= ROUNDING * np.ptp(depth):
        return still - 1
    ends = []
    for channel in (load[:still], depth[:still]):
        smooth = uniform_filter1d(channel, max(min(still, len(moved) - still) // AVERAGES, 1))
        at_level = smooth <= np.median(channel[: still // 2 + 1]) + ROUNDING * np.ptp(channel)
        ends.append(int(np.flatnonzero(at_level)[-1]) if at_level.any() else 0)
    return min(ends) if min(ends) > LONGER * still else 0
