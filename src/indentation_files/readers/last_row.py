"""The last row of a table, where it is no point of the test: totals of the columns, or a number that is cut off."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from indentation_files.readers.several_tests import Channels, whole
from indentation_files.readers.tables import Table

JUMP = 5.0  # of the largest of the steps before, chosen: no point of a test follows so far from the last
BEFORE = 5  # steps before the last row that show how far a channel goes in one
LOOKED_AT = 1000  # rows at the end, among which these are


def without_odd_end(channels: Channels, cells: Table) -> tuple[list[np.ndarray], tuple[str, ...]]:
    """Return channels (n,) without a last row that is no point, and what is said of it.

    That is one whose load and depth both lie farther from all others than these from one another, under a time that
    jumps, as the sums of the columns do; and one in which a text breaks off within a number. The channels are time,
    load and depth, `cells` their cells in the table.
    """
    filled = whole(channels)
    rows = max(len(filled) - LOOKED_AT, 0) + np.flatnonzero(filled[-LOOKED_AT:])[-BEFORE - 2 :]
    if len(rows) <= BEFORE + 1:
        return list(channels), ()
    values = np.array([channel[rows] for channel in channels])
    steps = np.abs(np.diff(values))
    jumps = steps[:, -1] > JUMP * steps[:, :-1].max(axis=1)
    last = int(rows[-1])
    if jumps.all() and all(_beyond(channel[filled]) for channel in channels[1:]):
        reason = "lies far beyond all others, as totals do"
    elif jumps.any() and _breaks_off(cells, last, jumps):
        reason = "ends within a number: the file is cut off"
    else:
        return list(channels), ()
    found = [channel.copy() for channel in channels]
    for channel in found:
        channel[last] = np.inf
    return found, (f"the last row ({cells.place(last)}) {reason}; it is left out",)


def _beyond(values: np.ndarray) -> bool:
    """Return whether the last of some values (n,) lies farther from the others than these from one another."""
    least, largest = values[:-1].min(), values[:-1].max()
    return bool(max(least - values[-1], values[-1] - largest) > largest - least)


def _breaks_off(cells: Table, last: int, jumps: Sequence[bool] | np.ndarray) -> bool:
    """Return whether a text ends in a row, without a line's end, in a number that is shorter than the one before.

    Of time, load and depth those count that jump there.
    """
    lines = cells.source.lines
    if not len(lines) or cells.numbers[last] != len(lines):
        return False
    end = lines[len(lines) - 1].rstrip()
    before, here = ([str(cell).strip() for cell in cells.rows[row]] for row in (last - 1, last))
    return any(
        jump and end.endswith(cell) and len(cell) < len(earlier)
        for jump, earlier, cell in zip(jumps, before, here, strict=True)
    )
