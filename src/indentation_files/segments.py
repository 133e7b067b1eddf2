r"""The segments of a test, found from load and time alone: approach, loading, hold, unloading, drift hold, reloading.

The load is brought to :math:`y = \operatorname{arsinh}(P / s)`, linear where noise rules and logarithmic above, so that
a first cycle to 0.1 mN counts as much as a last one to 50 mN and a loading of constant strain rate is a straight line.
Its corners (Douglas and Peucker) cut the test into pieces; a piece without a change of load, slow beside what
surrounds it, is a hold, and the sign of their change distinguishes the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from indentation_files.channel_noise import noise_of
from indentation_files.corners import corners
from indentation_files.errors import InputError

KINDS = ("approach", "loading", "hold", "unloading", "reloading", "drift_hold")
LINEAR = 200.0  # standard deviations of the load's noise, s: below it, y is linear in the load
TOLERANCE = 0.02  # of y, by which a segment may depart from a straight line
CHANGE = 0.05  # of y, up to which a piece holds the load
SLOW = 0.1  # of the rate beside it, up to which a piece is a hold
LOW, PRELOAD = 1 / 3, 0.05  # of the largest load: below them a hold shows drift after loading, and before it
FEWEST = 5  # intervals of a piece


@dataclass(frozen=True)
class Segment:
    """A part of a test.

    Its kind is ``approach`` (all before contact), ``loading`` (above any earlier load), ``hold`` (creep),
    ``unloading``, ``reloading`` (below an earlier load) or ``drift_hold`` (a hold at a low load that is not the top of
    a cycle; at one that is reached for the first time the body creeps, and it has to be a preload of a few per cent).
    `first` and `last` are the indices of its end points, which neighbours share, `start` and `end` their times [s].
    """

    kind: str
    first: int
    last: int
    start: float
    end: float

    def __post_init__(self) -> None:
        if self.kind not in KINDS or self.last <= self.first:
            raise InputError(f"no segment: {self.kind} from {self.first} to {self.last}", remedy=f"use {KINDS}")

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.end - self.start


def segments(time: np.ndarray, load: np.ndarray, contact: int = 0) -> list[Segment]:
    """Return the segments of a test, in the order of time, without gaps, of times and loads (n,) [s], [mN].

    What lies before `contact`, the index of the last point before it, is the approach. Raises `InputError` when fewer
    than ten points follow contact, or none of them bears load.
    """
    if len(time) - contact < 2 * FEWEST:
        raise InputError(
            f"only {max(len(time) - contact, 0)} points follow contact", remedy="export the whole test", place="time_s"
        )
    smooth = median_filter(load[contact:], 5, mode="nearest")
    smooth[[0, -1]] = load[[contact, -1]]
    if smooth.max() <= 0.0:
        raise InputError(
            "the load never rises above zero", remedy="subtract what it reads at rest, or export it", place="load_mN"
        )
    scale = LINEAR * max(noise_of(load[contact:]), 1e-4 * smooth.max() / LINEAR)
    level = np.arcsinh(smooth / scale)
    knots = np.flatnonzero(corners(time[contact:], level, TOLERANCE))
    pieces = _merged(_kinds(time[contact:], level, knots), level)
    found = _named(pieces, level, smooth)
    found = [(kind, first + contact, last + contact) for kind, first, last in found]
    if contact > 0:
        found.insert(0, ("approach", 0, contact))
    return [Segment(kind, first, last, float(time[first]), float(time[last])) for kind, first, last in found]


def _kinds(time: np.ndarray, level: np.ndarray, knots: np.ndarray) -> list[tuple[int, int, int]]:
    """Return sign of the change (0 for a hold), first and last index of each piece between corners."""
    change, duration = np.diff(level[knots]), np.diff(time[knots])
    rate = np.abs(change) / duration
    moving = np.abs(change) > CHANGE
    pieces = []
    for k, (first, last) in enumerate(pairwise(knots)):
        beside = [rate[j] for j in (*np.flatnonzero(moving[:k])[-1:], *(k + 1 + np.flatnonzero(moving[k + 1 :])[:1]))]
        still = abs(change[k]) <= CHANGE and (not beside or rate[k] <= SLOW * max(beside))
        pieces.append((0 if still else int(np.sign(change[k])), int(first), int(last)))
    return pieces


def _merged(pieces: list[tuple[int, int, int]], level: np.ndarray) -> list[tuple[int, int, int]]:
    """Join neighbours of one sign, and still pieces of fewer than five intervals with what precedes them."""
    joined: list[tuple[int, int, int]] = []
    for sign, first, last in pieces:
        if joined and (joined[-1][0] == sign or (sign == 0 and last - first < FEWEST)):
            joined[-1] = (joined[-1][0], joined[-1][1], last)
        else:
            joined.append((sign, first, last))
    return joined


def _named(pieces: list[tuple[int, int, int]], level: np.ndarray, load: np.ndarray) -> list[tuple[str, int, int]]:
    """Name the pieces; one that rises past an earlier load is cut there, one without load joins what surrounds it."""
    touching = [piece for piece in pieces if piece[0] or np.median(level[piece[1] : piece[2] + 1]) > CHANGE] or pieces
    named: list[tuple[str, int, int]] = []
    for k, (sign, first, last) in enumerate(touching):
        first = named[-1][2] if named else pieces[0][1]
        last = last if k + 1 < len(touching) else pieces[-1][2]
        before, after = (touching[j][0] if 0 <= j < len(touching) else 0 for j in (k - 1, k + 1))
        if sign < 0:
            named.append(("unloading", first, last))
        elif sign == 0:
            new = before > 0 and np.median(level[first : last + 1]) > level[: first + 1].max() - CHANGE
            low = np.median(load[first : last + 1]) < (PRELOAD if new else LOW) * load.max()
            named.append(("drift_hold" if low and (before, after) != (1, -1) else "hold", first, last))
        else:
            earlier = level[: first + 1].max()
            again = earlier - level[first] > CHANGE
            above = np.flatnonzero(level[first : last + 1] > earlier)
            passed = first + int(above[0]) if len(above) else last
            if again:
                named.append(("reloading", first, passed))
                first = passed
            if last > first:
                named.append(("loading", first, last))
    return named
