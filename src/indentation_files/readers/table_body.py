"""The rows of time, load and depth in a table: what is above them, their numbers, and how they divide into tests.

The last row may be no point of a test: totals of the columns, or a number that is cut off.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.clock import seconds
from indentation_files.readers.column_map import ColumnMap, columns_of
from indentation_files.readers.decimals import numbers
from indentation_files.readers.headings import is_row_of_units, is_word
from indentation_files.readers.several_tests import Channels, Part, parted, whole, without_stand_ins
from indentation_files.readers.tables import Table

JUMP = 5.0  # of the largest of the steps before, chosen: no point of a test follows so far from the last
BEFORE = 5  # steps before the last row that show how far a channel goes in one
LOOKED_AT = 1000  # rows at the end, among which these are


@dataclass(frozen=True)
class TableBody:
    """A table's rows of time, load and depth.

    `places` are those of the three columns in the rows of the whole `table`, `cells` its cells of these, below the
    header where the columns are given by their names. `named` is the row that holds these names; `header` the same, or,
    where the columns are given by their numbers, the first row of words above the numbers. None where there is none.
    `above` are the cells in the rows before the first number.

    `channels` are the numbers in the cells: NaN for text, infinite for an empty or invalid cell. `repeated` (n,) says
    whether a row is the header again, `broken` (n,) whether that or a blank row comes before it. `of_clock` says
    whether the times are read off a clock, in seconds; the `messages` are on that, and on the last row.
    """

    table: Table
    places: Sequence[int]
    cells: Table
    named: int | None
    header: int | None
    above: list[list[str]]
    channels: Channels
    repeated: np.ndarray
    broken: np.ndarray
    of_clock: bool
    messages: tuple[str, ...]


def body_of(table: Table, columns: ColumnMap) -> TableBody | None:
    """Return the rows of a table that has the columns and numbers in them; None for another."""
    found = columns_of(table, columns)
    if found is None:
        return None
    cells = table.body(*found)
    aside, core = {k: cells.rows[k] for k in cells.aside}, cells.core
    numeric = [k for k, row in aside.items() if is_numeric(row, (1, 2))]
    if not numeric and not core:
        return None
    begin = min([*numeric[:1], *([core.first] if core else [])])
    heading = " ".join(str(row[found[1][0]]) for row in table.rows[: begin + 1] if len(row) > found[1][0])
    shown, messages = seconds([aside[k][0] for k in numeric], heading)
    clock = dict(zip(numeric, shown, strict=True))
    channels = _channels(cells, {k: [clock.get(k, time), *others] for k, (time, *others) in aside.items()})
    channels, at_end = _without_odd_end(without_stand_ins(channels), cells)
    filled = whole(channels)
    if not filled.any():
        return None
    first = int(np.argmax(filled))
    above = words_of(table.body(None, found[1]).rows[: first + len(table.rows) - len(cells.rows)])
    header = next((k for k, row in enumerate(above) if _is_header(row)), None) if found[0] is None else found[0]
    rows = table.rows[-len(cells.rows) :]
    repeated, blank = np.zeros(len(rows), dtype=bool), np.append(False, np.diff(cells.numbers) > 1)
    for k in aside:
        repeated[k] = header is not None and [*rows[k]] == [*table.rows[header]]
        blank[k] |= not any(map(str, rows[k]))
    of_clock = clock.get(first, cells.rows[first][0]) != cells.rows[first][0]
    messages += at_end
    return TableBody(
        table, found[1], cells, found[0], header, above, channels, repeated, repeated | blank, of_clock, messages
    )


def _channels(cells: Table, aside: Mapping[int, Sequence[Any]]) -> Channels:
    """Return the numbers in a table's core with those in the rows beside it, given by their numbers, filled in."""
    places, core = list(aside), cells.core
    channels = list(core.columns if core else np.empty((3, len(cells.rows))))
    if places:
        found = numbers(list(aside.values()), lambda row: cells.place(places[row]), core.sign if core else "")
        for channel, values in zip(channels, found.T, strict=True):
            channel[places] = values
    return channels


def parts_of(body: TableBody) -> list[Part]:
    """Return the tests below one another in a table; raises `InputError` where one has other names or units."""
    parts = parted(body.channels, body.broken, body.cells.place)
    filled = whole(body.channels)
    for part in parts[1:]:
        begin = part.rows[int(np.argmax(filled[part.rows.start :]))]
        last = int(np.flatnonzero(filled[:begin])[-1])
        between = range(last + 1, begin)
        others = [
            k
            for k, row in zip(between, words_of(body.cells.rows[last + 1 : begin]), strict=True)
            if (_is_header(row) and not body.repeated[k]) or (is_row_of_units(row) and row not in body.above)
        ]
        if others:
            problem = f"{', '.join(map(str, body.cells.rows[others[0]]))!r} are no names and units of the test before"
            remedy = "write each of several tests to a file of its own"
            raise InputError(problem, remedy=remedy, place=body.cells.place(others[0]))
    return parts


def _is_header(row: Sequence[str]) -> bool:
    """Return whether the cells of a row are three words that are no units."""
    return all(map(is_word, row)) and not is_row_of_units(row)


def is_numeric(row: Sequence[Any], indices: Iterable[int]) -> bool:
    """Return whether cells of a row hold digits and no words."""
    cells = [str(row[k]) if k < len(row) else "" for k in indices]
    return all(re.search(r"\d", cell) and not is_word(cell) for cell in cells)


def words_of(rows: Sequence[Sequence[Any]]) -> list[list[str]]:
    """Return the cells of rows as text without blanks around it."""
    return [[str(cell).strip() for cell in row] for row in rows]


def _without_odd_end(channels: Channels, cells: Table) -> tuple[list[np.ndarray], tuple[str, ...]]:
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
