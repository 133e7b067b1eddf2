"""Where a table's rows part: into tests below one another, or into segments of one test, each with a clock of its own.

Time does not distinguish them. Where load and depth go on while time begins anew, the rows are the next segment of the
same test; where they begin as the test did, they are another one. So they are under a clock that goes on after a pause.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

SAME = 0.02  # of a channel's range: how far load and depth may step where they go on
LIKE = 0.05  # of a channel's range: how near another test begins to where the first one began
TWICE = 2.0  # of the step before it: a longer one to zero is a jump; of the usual step in time: a longer one is a pause
BESIDE = 5  # steps on either side of a cut that show how far load and depth step there anyway
OFTEN = 200  # of the usual step in time: what begins anew goes on with steps such as these
ALIKE = 0.1  # of a step in time: segments that differ less are sampled at one rate
FEW, VARIED = 0.2, 10  # of the rows, and values: how rare a stand-in is, and how many others there are


@dataclass(frozen=True)
class Part:
    """The rows of one test.

    Parameters
    ----------
    rows : ndarray
        Their numbers in the table.
    values : ndarray, shape (n, 3)
        Time, load and depth; time goes on over segments.
    idle : ndarray of bool, shape (n,)
        Rows that are no damage and hold nothing new: written twice, or zeros at the end.
    messages
        What is reported to the user.
    """

    rows: np.ndarray
    values: np.ndarray
    idle: np.ndarray
    messages: tuple[str, ...] = ()


def parted(values: np.ndarray, broken: np.ndarray, place: Callable[..., str]) -> list[Part]:
    """Return the tests in a table's `values`.

    Parameters
    ----------
    values : ndarray, shape (n, 3)
        Time, load and depth; not finite where a row holds no number.
    broken : ndarray of bool, shape (n,)
        Whether a blank row or a repeated header comes before a row.
    place
        Where rows are in the file, for messages.
    """
    idle = written_twice(values) | padding(values)
    kept = np.flatnonzero(np.isfinite(values).all(axis=1) & ~idle)
    if len(kept) < 3:
        return [Part(np.arange(len(values)), values, idle, _messages(idle, values, place))]
    breaks = np.cumsum(broken)
    cuts = _cuts(values[kept], np.diff(breaks[kept], prepend=breaks[kept[0]]) > 0)
    clock, values, begins = values[kept, 0], values.copy(), [0]
    segments: dict[int, list[int]] = {}
    unmarked = []
    for k, kind in cuts.items():
        if kind == "segment":
            goes_on = float(values[kept[k - 1], 0]) + _until_next(clock, values[kept, 1:], k)
            values[kept[k] + 1 :, 0] += goes_on - values[kept[k], 0]
            values[kept[k], 0] = goes_on
            segments.setdefault(len(begins), []).append(int(kept[k]))
        else:
            first = np.flatnonzero(broken[kept[k - 1] + 1 : kept[k] + 1])
            begins.append(int(kept[k - 1] + 1 + first[-1]) if len(first) else int(kept[k]))
            if not len(first):
                unmarked.append(len(begins))
    idle |= written_twice(values)
    parts = []
    for number, (begin, end) in enumerate(zip(begins, [*begins[1:], len(values)], strict=True), 1):
        rows = np.arange(begin, end)
        messages = _messages(idle[rows], values[rows], lambda *each, rows=rows: place(*rows[list(each)]))
        if number in segments:
            where = place(*segments[number])
            messages += (f"time begins anew where load and depth go on ({where}): joined as segments of one test",)
        if number in unmarked:
            messages += (f"begins at {place(begin)}, where load and depth begin anew as in the test before",)
        parts.append(Part(rows, values[rows], idle[rows], messages))
    return parts


def written_twice(values: np.ndarray) -> np.ndarray:
    """Return which rows of `values` (n, k) are whole and equal to the last whole row before them."""
    whole = np.flatnonzero(np.isfinite(values).all(axis=1))
    twice = np.zeros(len(values), dtype=bool)
    twice[whole[1:]] = np.all([(column := channel[whole])[1:] == column[:-1] for channel in values.T], axis=0)
    return twice


def stand_ins(values: np.ndarray) -> np.ndarray:
    """Return which of `values` (n, k), the time first, stand for missing ones, such as -9999.

    Such a value is the same in few rows, and farther from all others of its channel than these are from one another. At
    the end it may be the specimen's: a film that breaks.
    """
    found = np.zeros(values.shape, dtype=bool)
    for k, channel in enumerate(values.T[1:], 1):
        finite = np.isfinite(channel)
        for code in {channel[finite].min(), channel[finite].max()} if finite.any() else ():
            others = np.flatnonzero(finite & (channel != code))
            rest = channel[others]
            if len(rest) < max(VARIED, (1 - FEW) * finite.sum()) or np.abs(rest - code).min() <= np.ptp(rest):
                continue
            if len(np.unique(rest)) >= VARIED:
                found[: others[-1], k] |= channel[: others[-1]] == code
    return found


def padding(values: np.ndarray) -> np.ndarray:
    """Return which rows of `values` (n, k), the time first, are zeros that follow a test: at the end, or before more.

    At the end the time may go on in two rows or more whose other channels jump to zero.
    """
    whole = np.flatnonzero(np.isfinite(values).all(axis=1))
    zeros = [channel[whole] == 0 for channel in values.T]
    zero = np.all(zeros, axis=0)
    padded = np.zeros(len(values), dtype=bool)
    if zero.all():
        return padded
    padded[whole] = zero & np.append(zero[1:], True) & (np.arange(len(whole)) > np.argmin(zero))
    pressed = np.flatnonzero(~np.all(zeros[1:], axis=0))
    last = int(pressed[-1]) if len(pressed) else len(whole)
    if 0 < last < len(whole) - 2:
        others = np.abs(values[whole, 1:])
        step = np.abs(others[last] - others[last - 1])
        if (others[last] > np.maximum(SAME * others.max(axis=0), TWICE * step)).any():
            padded[whole[last + 1 :]] = True
    return padded


def _messages(idle: np.ndarray, values: np.ndarray, place: Callable[..., str]) -> tuple[str, ...]:
    """Return in words which rows count for nothing."""
    zeros = padding(values) & idle
    twice = idle & ~zeros
    return tuple(
        f"{count} row{'s' if count > 1 else ''} {what} ({place(*np.flatnonzero(rows))})"
        for what, rows in (("written twice, counted once", twice), ("of zeros at the end left out", zeros))
        if (count := int(rows.sum()))
    )


def _cuts(values: np.ndarray, apart: np.ndarray) -> dict[int, str]:
    """Return at which of whole rows `values` (m, 3) a ``test`` or a ``segment`` begins.

    `apart` (m,) marks rows after a blank row or a repeated header.
    """
    time, others = values[:, 0], values[:, 1:]
    span = np.ptp(others, axis=0)
    steps = np.abs(np.diff(others, axis=0))
    forward = np.diff(time)[np.diff(time) > 0]
    usual = float(np.median(forward)) if len(forward) else 0.0
    cuts: dict[int, str] = {}
    test = segment = 0
    jumps = np.append(False, (np.diff(others[:, 1]) < -SAME * span[1]) & (np.diff(time) > TWICE * usual))
    for k in np.flatnonzero(apart | jumps | (np.diff(time, prepend=-np.inf) <= 0)):
        if k < segment + 2:
            continue
        back = time[k] <= time[k - 1]
        runs = k + 1 < len(time) and time[k + 1] < time[k - 1] and 0 < time[k + 1] - time[k] <= OFTEN * usual
        anew = back and runs and time[k] - time[segment] <= 2 * usual
        beside = np.concatenate([steps[max(k - 1 - BESIDE, 0) : k - 1], steps[k : k + BESIDE]])
        goes_on = (steps[k - 1] <= np.maximum(SAME * span, 1.5 * beside.max(axis=0, initial=0.0))).all()
        as_first = np.abs(others[k] - others[test]) <= LIKE * span
        unloaded = abs(others[k - 1, 0] - others[test, 0]) <= LIKE * span[0]
        from_first, from_last = abs(others[k, 1] - others[test, 1]), steps[k - 1, 1]
        returned = unloaded and as_first.all() and from_first <= from_last
        if anew and goes_on and not returned:
            cuts[int(k)] = "segment"
        elif (
            (anew and as_first[0])
            or (apart[k] and (back or (returned and from_last > SAME * span[1])))
            or (jumps[k] and returned and others[k:, 0].max() > others[test, 0] + LIKE * span[0])
        ):
            cuts[int(k)] = "test"
        else:
            continue
        segment, test = int(k), test if cuts[int(k)] == "segment" else int(k)
    return cuts


def _until_next(clock: np.ndarray, others: np.ndarray, k: int) -> float:
    """Return how long after the last point before it a segment begins that starts at point `k` of `clock` (n,).

    Not at all where its first point is the last one again; a step where both segments are sampled at one rate, or where
    the clock gives no step; else as long as the clock gives. `others` (n, 2) are load and depth.
    """
    step, following = clock[k - 1] - clock[k - 2], clock[k + 1] - clock[k]
    if clock[k] == 0 and (others[k] == others[k - 1]).all():
        return 0.0
    return float(clock[k] if abs(following - step) > ALIKE * step and 0 < clock[k] <= step else step)
