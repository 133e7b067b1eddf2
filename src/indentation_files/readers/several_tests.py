"""Where a table's rows part: into tests below one another, or into segments of one test, each with a clock of its own.

Time does not distinguish them. Where load and depth go on while time begins anew, the rows are the next segment of the
same test; where they begin as the test did, they are another one. So they are under a clock that goes on after a pause.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

SAME = 0.02  # of a channel's range: how far load and depth may step where they go on
LIKE = 0.05  # of a channel's range: how near another test begins to where the first one began
TWICE = 2.0  # of the step before it: a longer one to zero is a jump; of the usual step in time: a longer one is a pause
BESIDE = 5  # steps on either side of a cut that show how far load and depth step there anyway
OFTEN = 200  # of the usual step in time: what begins anew goes on with steps such as these
ALIKE = 0.1  # of a step in time: segments that differ less are sampled at one rate
FEW, VARIED = 0.2, 10  # of the rows, and values: how rare a stand-in is, and how many others there are
Channels = Sequence[np.ndarray]  # the time first, each of shape (n,)


@dataclass(frozen=True)
class Part:
    """The rows of one test.

    `rows` are their numbers in the table, `channels` time, load and depth; time goes on over segments. `idle` (n,)
    marks rows that are no damage and hold nothing new: written twice, or zeros at the end. The `messages` are for the
    user.
    """

    rows: range
    channels: Channels
    idle: np.ndarray
    messages: tuple[str, ...] = ()


def parted(channels: Channels, broken: np.ndarray, place: Callable[..., str]) -> list[Part]:
    """Return the tests in the `channels` of a table, which are not finite where a row holds no number.

    `broken` (n,) says whether a blank row or a repeated header comes before a row, `place` where rows are in the file.
    """
    time, *others = channels
    idle = written_twice(channels) | padding(channels)
    filled = whole(channels) & ~idle
    kept = np.flatnonzero(filled).astype(np.int32)
    if len(kept) < 3:
        return [Part(range(len(time)), channels, idle, _messages(idle, channels, place))]
    apart = np.zeros(len(kept), dtype=bool)
    after = np.searchsorted(kept, np.flatnonzero(broken).astype(np.int32))
    apart[after[(after > 0) & (after < len(kept))]] = True
    cuts = _cuts(channels, filled, kept, apart)
    goes_on = time.copy() if "segment" in cuts.values() else time
    begins, segments, unmarked = [0], dict[int, list[int]](), list[int]()
    for k, kind in cuts.items():
        row = int(kept[k])
        if kind == "segment":
            near = kept[k - 2 : k + 2]
            begin = float(goes_on[kept[k - 1]]) + _until_next(time[near], np.array([other[near] for other in others]))
            goes_on[row + 1 :] += begin - goes_on[row]
            goes_on[row] = begin
            segments.setdefault(len(begins), []).append(row)
        else:
            first = np.flatnonzero(broken[kept[k - 1] + 1 : row + 1])
            begins.append(int(kept[k - 1] + 1 + first[-1]) if len(first) else row)
            if not len(first):
                unmarked.append(len(begins))
    channels = [goes_on, *others]
    idle |= written_twice(channels) if segments else False
    parts = []
    for number, (begin, end) in enumerate(zip(begins, [*begins[1:], len(time)], strict=True), 1):
        own, unused = [channel[begin:end] for channel in channels], idle[begin:end]
        messages = _messages(unused, own, lambda *rows, begin=begin: place(*(begin + row for row in rows)))
        if number in segments:
            where = place(*segments[number])
            messages += (f"time begins anew where load and depth go on ({where}): joined as segments of one test",)
        if number in unmarked:
            messages += (f"begins at {place(begin)}, where load and depth begin anew as in the test before",)
        parts.append(Part(range(begin, end), own, unused, messages))
    return parts


def whole(channels: Channels) -> np.ndarray:
    """Return which rows hold a number in each channel."""
    return np.logical_and.reduce([np.isfinite(channel) for channel in channels])


def taken(channel: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return some `rows` (n,) of a channel, without a copy where they lie side by side."""
    if not rows.any():
        return channel[:0]
    first, end = ends(rows)
    return channel[first:end] if rows[first:end].all() else channel[rows]


def ends(rows: np.ndarray) -> tuple[int, int]:
    """Return the first of the rows (n,) that are marked, and the one after the last."""
    return int(np.argmax(rows)), len(rows) - int(np.argmax(rows[::-1]))


def written_twice(channels: Channels) -> np.ndarray:
    """Return which rows are whole and equal to the last whole row before them."""
    filled, same = whole(channels), np.array(True)
    for channel in channels:
        column = taken(channel, filled)
        same = same & (column[1:] == column[:-1])
    twice = np.zeros(len(filled), dtype=bool)
    twice[np.flatnonzero(filled)[1:]] = same
    return twice


def without_stand_ins(channels: Channels) -> list[np.ndarray]:
    """Return channels that are infinite where a value stands for a missing one, such as -9999 or a zero that drops out.

    Such a value is the same in few rows, and farther from all others of its channel than these are from one another. At
    the end it may be the specimen's: a film that breaks. Zeros with which a test begins are its contact. A zero drops
    out where it stands alone between two values that are far from it and near each other, and that do not lead to it,
    while the other one of load and depth, which come behind the time, is not zero. None is a time's.
    """
    found = list(channels)
    for k, channel in enumerate(channels[1:], 1):
        dropped = _dropped_out(channel, channels[3 - k]) if k < 3 <= len(channels) else ()
        if len(dropped):
            found[k] = channel = channel.copy()
            channel[dropped] = np.inf
        finite = np.isfinite(channel)
        some = taken(channel, finite)
        for code in {float(some.min()), float(some.max())} if len(some) else ():
            others = finite & (channel != code)
            if others.sum() < max(VARIED, (1 - FEW) * finite.sum()):
                continue
            least, largest = taken(channel, others).min(), taken(channel, others).max()
            if min(abs(least - code), abs(largest - code)) <= largest - least:
                continue
            if len(np.unique(channel[others])) >= VARIED:
                first, last = np.flatnonzero(others)[[0, -1]]
                rows = np.arange(len(channel))
                inside = (rows < last) & ((rows > first) | (code != 0.0))
                found[k] = np.where(inside & (channel == code), np.inf, found[k])
    return found


def _dropped_out(channel: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the rows (m,) of zeros of a channel (n,) that stand alone between values far from them.

    The `other` one, depth or load, is not zero there, as it is where a test begins. The values on neither side lead to
    the zero along a straight line.
    """
    zeros = 1 + np.flatnonzero((channel[1:-1] == 0) & (channel[:-2] != 0) & (channel[2:] != 0))
    if not (0 < len(zeros) <= FEW * len(channel) and np.isfinite(channel).any() and np.isfinite(other).any()):
        return zeros[:0]
    before, after = channel[zeros - 1], channel[zeros + 1]
    spans = [np.ptp(values[np.isfinite(values)]) for values in (channel, other)]
    pressed = np.isfinite(other[zeros]) & (np.abs(other[zeros]) > SAME * spans[1])
    far = (np.abs(before) > LIKE * spans[0]) & np.isfinite(before + after)
    with np.errstate(invalid="ignore"):
        near = np.abs(after - before) <= np.abs(before) / TWICE
        for beside, away in ((before, -2), (after, 2)):
            beyond = channel[np.clip(zeros + away, 0, len(channel) - 1)]
            far &= ~(np.abs(2 * beside - beyond) < np.abs(beside) / TWICE)
    return zeros[pressed & near & far]


def padding(channels: Channels) -> np.ndarray:
    """Return which rows are zeros that follow a test: at the end, or before more.

    At the end the time may go on in two rows or more whose other channels jump to zero.
    """
    filled = whole(channels)
    zeros = [(channel == 0)[filled] for channel in channels]
    zero, pressed = np.logical_and.reduce(zeros), ~np.logical_and.reduce(zeros[1:])
    padded = np.zeros(len(filled), dtype=bool)
    if zero.all():
        return padded
    first = int(np.argmin(zero))
    last = ends(pressed)[1] - 1 if pressed.any() else len(zero)
    zero[:-1] &= zero[1:]
    zero[:first] = False
    if 0 < last < len(zero) - 2:
        rows = np.flatnonzero(filled)[[last - 1, last]]
        for channel in channels[1:]:
            before, end = np.abs(channel[rows])
            largest = max(-taken(channel, filled).min(), taken(channel, filled).max())
            zero[last + 1 :] |= end > max(SAME * largest, TWICE * abs(end - before))
    padded[filled] = zero
    return padded


def _messages(idle: np.ndarray, channels: Channels, place: Callable[..., str]) -> tuple[str, ...]:
    """Return in words which rows count for nothing."""
    zeros = padding(channels) & idle
    twice = idle & ~zeros
    return tuple(
        f"{count} row{'s' if count > 1 else ''} {what} ({place(*np.flatnonzero(rows))})"
        for what, rows in (("written twice, counted once", twice), ("of zeros at the end left out", zeros))
        if (count := int(rows.sum()))
    )


def _cuts(channels: Channels, filled: np.ndarray, kept: np.ndarray, apart: np.ndarray) -> dict[int, str]:
    """Return at which of the whole rows a ``test`` or a ``segment`` begins.

    `filled` (n,) marks these rows, `kept` (m,) are their numbers, and `apart` (m,) marks those of them after a blank
    row or a repeated header.
    """
    time, *others = channels
    span = np.array([np.ptp(taken(other, filled)) for other in others])
    jumps, stands, usual = _jumps(taken(time, filled), taken(others[1], filled), float(span[1]))
    cuts: dict[int, str] = {}
    test = segment = 0
    for k in np.flatnonzero(apart | jumps | stands):
        if k < segment + 2:
            continue
        far = max(int(k) - 1 - BESIDE, 0)
        clock, near = time[kept[k - 1 : k + 2]], kept[far : k + BESIDE + 1]
        steps = np.abs(np.diff([other[near] for other in others]).T)
        step, beside = steps[k - 1 - far], np.delete(steps, k - 1 - far, axis=0)
        before, here, first = np.array([other[kept[[int(k) - 1, int(k), test]]] for other in others]).T
        back = clock[1] <= clock[0]
        runs = k + 1 < len(kept) and clock[2] < clock[0] and 0 < clock[2] - clock[1] <= OFTEN * usual
        anew = back and runs and clock[1] - time[kept[segment]] <= 2 * usual
        goes_on = (step <= np.maximum(SAME * span, 1.5 * beside.max(axis=0, initial=0.0))).all()
        as_first = np.abs(here - first) <= LIKE * span
        unloaded = abs(before[0] - first[0]) <= LIKE * span[0]
        returned = unloaded and as_first.all() and abs(here[1] - first[1]) <= step[1]
        if anew and goes_on and not returned:
            cuts[int(k)] = "segment"
        elif (
            (anew and as_first[0])
            or (apart[k] and ((back and not goes_on) or (returned and (back or step[1] > SAME * span[1]))))
            or (jumps[k] and returned and others[0][kept[k:]].max() > first[0] + LIKE * span[0])
        ):
            cuts[int(k)] = "test"
        else:
            continue
        segment, test = int(k), test if cuts[int(k)] == "segment" else int(k)
    return cuts


def _jumps(time: np.ndarray, depth: np.ndarray, span: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return where the depth, of a range `span`, falls after a pause, where time stands or goes back, and its step."""
    stands = np.diff(time) <= 0
    usual = 0.0 if stands.all() else float(np.median(taken(np.diff(time), ~stands), overwrite_input=True))
    jumps = np.diff(time) > TWICE * usual
    jumps &= np.diff(depth) < -SAME * span
    return np.append(False, jumps), np.append(False, stands), usual


def _until_next(clock: np.ndarray, others: np.ndarray) -> float:
    """Return how long after the last point before it a segment begins that starts at the third of four times `clock`.

    Not at all where its first point is the last one again; a step where both segments are sampled at one rate, or where
    the clock gives no step; else as long as the clock gives. `others` (2, 4) are load and depth.
    """
    step, start, following = clock[1] - clock[0], clock[2], clock[3] - clock[2]
    if start == 0 and (others[:, 2] == others[:, 1]).all():
        return 0.0
    return float(start if abs(following - step) > ALIKE * step and 0 < start <= step else step)
