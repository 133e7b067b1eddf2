"""The load history that the instrument imposes, and the times at which the depth is recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError

MOST_KNOTS = 500
MOST_NOISE = 0.02
ONSET = 0.01
LEAST_STEP = 1e-8  # of the test, the shortest that a segment, or the way from one sample to the next, may last


@dataclass(frozen=True, eq=False)
class Protocol:
    """A piecewise linear load history with its sampling times.

    Parameters
    ----------
    knot_time, knot_load : ndarray, shape (k,)
        Corners of the load history [s], [mN]; the first knot is (0, 0).
    sample_time : ndarray, shape (n,)
        Times at which a recording has points [s], increasing, within the history, all positive.

    Raises
    ------
    InputError
        If times do not increase, a load is negative, or nothing is loaded at all.
    """

    knot_time: np.ndarray
    knot_load: np.ndarray
    sample_time: np.ndarray

    def __post_init__(self) -> None:
        time, load, sample = (np.asarray(a, dtype=float) for a in (self.knot_time, self.knot_load, self.sample_time))
        for name, value in (("knot_time", time), ("knot_load", load), ("sample_time", sample)):
            object.__setattr__(self, name, value)
            if value.ndim != 1 or not np.all(np.isfinite(value)):
                raise InputError(f"{name} must be a finite 1D array", remedy="remove missing values", place=name)
        if len(time) < 2 or len(time) != len(load):
            raise InputError("the load history needs at least two knots", remedy="give times and loads of equal number")
        if time[0] != 0.0 or np.any(np.diff(time) <= 0):
            raise InputError(
                "times of the load history must start at 0 and increase", remedy="sort or correct the times"
            )
        if np.any(load < 0) or load.max() <= 0:
            raise InputError(
                f"loads are {load.min():g} to {load.max():g} mN, expected none negative and a positive maximum",
                remedy="check sign and unit (mN)",
                place="loads",
            )
        if len(sample) == 0 or np.any(np.diff(sample) <= 0) or sample[0] <= 0 or sample[-1] > time[-1] * (1 + 1e-12):
            raise InputError(
                "sample times must be positive, increasing and within the history", remedy="correct the times"
            )
        shortest = min(np.diff(time).min(), np.diff(sample).min(initial=np.inf))
        if shortest < LEAST_STEP * time[-1]:
            raise InputError(
                f"a step of {shortest:.3g} s in a test of {time[-1]:.3g} s is too short to be resolved",
                remedy="leave the shortest segment out, or let it last longer",
                place="protocol",
            )

    @property
    def max_load(self) -> float:
        """Largest load [mN]."""
        return float(self.knot_load.max())

    @property
    def sample_load(self) -> np.ndarray:
        """Load at the sampling times [mN], shape (n,)."""
        return self.load_at(self.sample_time)

    def load_at(self, time: np.ndarray) -> np.ndarray:
        """Load at any times [mN]."""
        return np.interp(time, self.knot_time, self.knot_load)


def trapezoid(
    max_load: float, loading_time: float, hold_time: float, unloading_time: float, points: int = 100
) -> Protocol:
    """Linear loading, hold and linear unloading to zero, sampled evenly in time within each segment.

    Points are shared among the segments in proportion to their durations, at least two each; the ends of all
    segments are sampled, so the peak and the end of the hold are never missed.

    Parameters
    ----------
    max_load
        [mN]
    loading_time, hold_time, unloading_time
        [s]; `hold_time` may be zero.
    points
        Number of samples; time zero is not one of them.
    """
    if max_load <= 0 or loading_time <= 0 or unloading_time <= 0 or hold_time < 0:
        raise InputError(
            "max_load, loading_time and unloading_time must be positive and hold_time not negative",
            remedy="correct the protocol",
        )
    durations = [d for d in (loading_time, hold_time, unloading_time) if d > 0]
    ends = np.cumsum(durations)
    loads = [max_load] * (len(durations) - 1) + [0.0]
    return Protocol(np.concatenate([[0.0], ends]), np.concatenate([[0.0], loads]), sampled(ends, points))


def sampled(ends: Sequence[float] | np.ndarray, points: int) -> np.ndarray:
    """Return sampling times (points,) [s], even within each segment, for segments that end at `ends` [s].

    Raises
    ------
    InputError
        When there are fewer than two points for each segment.
    """
    durations = np.diff(ends, prepend=0.0)
    counts = np.maximum(2, np.round(durations / durations.sum() * points)).astype(int)
    counts[int(np.argmax(counts))] += points - counts.sum()
    if counts.min() < 2:
        raise InputError(f"points = {points} is too few", remedy="use at least two a segment", place="points")
    starts = np.concatenate([[0.0], ends[:-1]])
    return np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b, n in zip(starts, ends, counts, strict=True)])


def recorded(time: np.ndarray, load: np.ndarray, points: int = 100, tolerance: float = 1e-3) -> Protocol:
    """Load history taken from a recording, sampled at `points` times.

    They are spread evenly in t/T + s/S, with s(t) the way that the load has gone up and down by then; so that neither a
    hold of many minutes nor a load that grows exponentially is left without points. The first sample is where the load
    reaches a hundredth of its maximum: below, contact lies on too few elements to count.

    The history is thinned to the corners that keep it within `tolerance` of the largest load everywhere (Douglas and
    Peucker's rule, with the distance measured along the load), so that a long recording costs no more steps than its
    shape deserves. Where the load's own noise is larger, six of its standard deviations are allowed instead, up to 2 %
    of the largest load; they are estimated from second differences, which a smooth history leaves near zero.

    Parameters
    ----------
    time, load : ndarray, shape (n,)
        Recorded times [s] and loads [mN] from contact on; loads below zero (noise) count as zero.
    tolerance
        Largest departure, as a fraction of the largest load.

    Raises
    ------
    InputError
        When the load is never above zero, the history does not begin at zero load (within `tolerance`), or needs more
        than 500 corners.
    """
    time, load = np.asarray(time, dtype=float) - time[0], np.clip(np.asarray(load, dtype=float), 0.0, None)
    if load.max() == 0.0:
        raise InputError(
            "the load of the recording to follow is never above zero, as if its sign were wrong",
            remedy="turn it (`palpate read --columns ... --units load=-mN`)",
            place="load_mN",
        )
    if load[0] > tolerance * load.max():
        raise InputError(
            f"the load history begins at {load[0]:.4g} mN", remedy="begin it at contact, at zero load", place="load_mN"
        )
    load[0] = 0.0
    noise = np.median(np.abs(np.diff(load, 2))) / (0.6745 * np.sqrt(6)) if len(load) > 2 else 0.0
    allowed = max(tolerance * load.max(), min(6 * noise, MOST_NOISE * load.max()))
    keep = corners(time, load, allowed)
    if keep.sum() > MOST_KNOTS:
        raise InputError(
            f"the load history has {keep.sum()} corners, {MOST_KNOTS} at most can be simulated",
            remedy="smooth the recorded load",
            place="load_mN",
        )
    time, load = time[keep], load[keep]
    way = np.append(0.0, np.cumsum(np.abs(np.diff(load))))
    progress = 0.5 * (time / time[-1] + way / way[-1])
    rising = int(np.argmax(load >= ONSET * load.max()))
    onset = np.interp(ONSET * load.max(), load[: rising + 1], progress[: rising + 1])
    return Protocol(time, load, np.interp(np.linspace(onset, 1.0, points), progress, time))


def corners(time: np.ndarray, load: np.ndarray, allowed: float) -> np.ndarray:
    """Return which points (n,) a piecewise linear history must keep to stay within `allowed` of all others."""
    keep = np.zeros(len(time), dtype=bool)
    keep[[0, -1]] = True
    pending = [(0, len(time) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        chord = np.interp(time[first : last + 1], time[[first, last]], load[[first, last]])
        distance = np.abs(load[first : last + 1] - chord)
        worst = first + int(np.argmax(distance))
        if distance.max() > allowed:
            keep[worst] = True
            pending += [(first, worst), (worst, last)]
    return keep
