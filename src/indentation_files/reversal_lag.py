r"""The lag of the depth behind the load, from the corners of the load history, without a model of the material.

Where the load's rate jumps, so does that of the depth, at once, by the instantaneous compliance; what creeps answers
later and without a corner. About a corner at t_0, with s = t - t_0,

    h = b_0 + b_1 s + b_2 s^2 + a P(t - lag) + c max(s - lag, 0)^(3/2),

with the recorded load P itself, so that a rounded corner does no harm, and with c for the creep that the new rate
begins. The beginning of loading is no such corner: under a sharp tip the depth has an infinite rate there, and a lag
found from it would stick at the first row where the load rises. Corners below a tenth of the largest load are left out.

A solid whose creep begins steeply (as a power of time) moves the corner a little. The estimate is therefore made in
windows of three widths, and the interval is the hull of the three.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import ndtri, stdtrit

from indentation_files.correlated_errors import Series, shared_coefficient
from indentation_files.errors import InputError
from indentation_files.recording import Recording
from indentation_files.segments import segments

LEAST_LOAD = 0.1  # of the largest load, below which a corner does not count; chosen, like all that follow
WIDTHS = (0.25, 0.4, 0.6)  # of the shorter of the two segments at a corner, on each side of it
MAIN = 0.4  # the one of them that gives the estimate
FEWEST = 7  # points on each side of a corner: two more than the terms
TRIALS = 25  # lags, or times of a corner, before the minimum is refined
FURTHEST = 0.5  # of the narrowest window's side, the largest lag
STEEP = 1.5  # power of the time by which creep answers a new rate, between 1 (at once) and 2 (a Voigt element)
ROUNDS = 4  # of Gauss and Newton
MOST = 12  # corners of a test, those between the longest segments: noise of a load makes many short ones
NORMAL_95 = float(ndtri(0.975))


@dataclass(frozen=True)
class ReversalLag:
    """A lag of the depth behind the load [s]: estimate, 95 % interval, and on how many corners it rests."""

    lag: float
    lower: float
    upper: float
    corners: int


@dataclass(frozen=True, eq=False)
class _Corner:
    """The recording about one corner: times since it, depths (n,), and its load at any time."""

    since: np.ndarray
    depth: np.ndarray
    load_time: np.ndarray
    load: np.ndarray

    def terms(self, lag: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the terms (n, 5) at a lag, and their derivatives by it."""
        step = float(np.median(np.diff(self.since)))
        earlier, at, later = (np.interp(self.since - lag + d, self.load_time, self.load) for d in (-step, 0.0, step))
        after, none = np.maximum(self.since - lag, 0.0), np.zeros_like(at)
        own = np.column_stack([none + 1.0, self.since, self.since**2, at, after**STEEP])
        return own, np.column_stack(
            [none, none, none, (earlier - later) / (2.0 * step), -STEEP * after ** (STEEP - 1.0)]
        )

    def left(self, lag: float) -> float:
        """Return the logarithm of the sum of squares that is left at a lag."""
        own = self.terms(lag)[0]
        rest = self.depth - own @ np.linalg.lstsq(own, self.depth, rcond=None)[0]
        return len(rest) * float(np.log(max(rest @ rest, 1e-20 * float(self.depth @ self.depth))))


def reversal_lag(recordings: Iterable[Recording]) -> ReversalLag | None:
    """Return the lag that tests on one instrument show; None where no corner has enough points on both sides.

    Tests count by the precision of their own estimates; the interval grows by the Birge ratio where these scatter more
    than they should (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
    """
    every = [corner for corner in map(_corners, recordings) if corner]
    found = {width: _estimate([_within(test, width) for test in every]) for width in WIDTHS}
    main = found[MAIN] or found[WIDTHS[-1]]
    if main is None:
        return None
    lower, upper = zip(*((lag - half, lag + half) for lag, half, _ in filter(None, found.values())), strict=True)
    return ReversalLag(main[0], min(lower), max(upper), main[2])


def _corners(recording: Recording) -> list[tuple[float, float, Recording]]:
    """Return time and shorter neighbour [s] of the corners of a recording, with the recording; may be empty."""
    time, load = recording.time, recording.load
    try:
        parts = segments(time, load)
    except InputError:
        return []
    found = []
    for one, two in pairwise(parts):
        smooth = (one.kind, two.kind) == ("reloading", "loading")
        if not smooth and one.kind != "approach" and load[one.last] > LEAST_LOAD * load.max():
            shorter = min(one.duration, two.duration)
            found.append((_refined(time, load, one.end, MAIN * shorter), shorter, recording))
    return sorted(found, key=lambda corner: corner[1])[-MOST:]


def _refined(time: np.ndarray, load: np.ndarray, corner: float, half: float) -> float:
    """Return the time at which two straight lines through the load meet, near that of a corner [s]."""
    near = np.abs(time - corner) <= half
    trials = corner + np.linspace(-0.5, 0.5, TRIALS) * half
    lines = [np.column_stack([np.ones(near.sum()), time[near], np.maximum(time[near] - t, 0.0)]) for t in trials]
    left = [load[near] - line @ np.linalg.lstsq(line, load[near], rcond=None)[0] for line in lines]
    return float(trials[int(np.argmin([rest @ rest for rest in left]))])


def _within(corners: Sequence[tuple[float, float, Recording]], width: float) -> list[_Corner]:
    """Return what lies within a share of the shorter neighbour on each side of each corner, where it is enough."""
    found = []
    for corner, shorter, recording in corners:
        since = recording.time - corner
        near = np.abs(since) <= width * shorter
        if min((near & (since < 0)).sum(), (near & (since > 0)).sum()) >= FEWEST:
            found.append(_Corner(since[near], recording.depth[near], since, recording.load))
    return found


def _estimate(tests: Sequence[list[_Corner]]) -> tuple[float, float, int] | None:
    """Return the lag, half its 95 % interval, and the number of corners."""
    tests = [test for test in tests if test]
    known = [found for test in tests if (found := _of_test(test))]
    if not known:
        return None
    values, halves = np.array(known).T
    weights = halves**-2.0
    lag = float(weights @ values / weights.sum())
    half, count = float(weights.sum() ** -0.5), sum(map(len, tests))
    if len(known) > 1:
        freedom = len(known) - 1
        birge = np.sqrt(weights @ (values - lag) ** 2 * NORMAL_95**2 / freedom)
        half *= max(1.0, float(birge * stdtrit(freedom, 0.975) / NORMAL_95))
    return lag, half, count


def _of_test(corners: Sequence[_Corner]) -> tuple[float, float] | None:
    """Return the lag of one test, and half its 95 % interval: the least squares on trial, then Gauss and Newton.

    None where a load that never changes beside a corner leaves the lag open.
    """
    side = FURTHEST * min(corner.since[-1] for corner in corners)
    trials = np.linspace(-side, side, TRIALS)
    lag = float(trials[int(np.argmin([sum(corner.left(lag) for corner in corners) for lag in trials]))])
    half, step = np.inf, trials[1] - trials[0]
    for _ in range(ROUNDS):
        series = []
        for corner in corners:
            own, slopes = corner.terms(lag)
            begin = np.linalg.lstsq(own, corner.depth, rcond=None)[0]
            rest = corner.depth - own @ begin
            scale = max(float(np.sqrt(np.mean(rest**2))), 1e-12 * float(np.abs(corner.depth).max()))
            series.append(Series(rest / scale, slopes @ begin / scale, own))
        try:
            found = shared_coefficient(series)
        except np.linalg.LinAlgError:
            return None
        lag, half = lag + float(np.clip(found.value, -step, step)), found.half
    return lag, max(half, 1e-9 * side)
