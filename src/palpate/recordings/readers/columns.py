"""Any table, text or Excel, by a map of its columns that the user gives: no format is guessed, none is assumed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.clock import seconds
from palpate.recordings.readers.column_map import ColumnMap, columns_of
from palpate.recordings.readers.decimals import numbers
from palpate.recordings.readers.headings import channel_of, is_row_of_units, is_word, stated
from palpate.recordings.readers.left_out import left_out, nothing_found
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.tables import NAME_WITH_UNIT, Table, tables_of
from palpate.recordings.readers.units import CHANNELS, scale
from palpate.recordings.readers.vendor import (
    MOST_LEFT_OUT,
    Unreadable,
    VendorTest,
    attempt,
    increasing,
    unless_all_fail,
)
from palpate.recordings.recording import Recording


def read_columns(source: Source, columns: ColumnMap) -> list[VendorTest | Unreadable]:
    """Read the table of a text file, or one from each sheet of a workbook that holds the columns.

    A table that repeats its header, and begins its time anew there, holds several tests. Sheets that give none, and
    hold a table, come last, with what is wrong with them: so the tests keep their numbers.

    The header is the first row with all names; where columns are given by their numbers it tells nothing but units.
    Rows without any number, of units and remarks, do no harm before and after the numbers; other rows without three, or
    with a time that does not increase, are left out with a warning.

    Raises
    ------
    InputError
        When no table has the columns, or none that has them can be read: it has several of a name, more than a
        twentieth of its rows would be left out, cells do not fit the header, or a unit is not known.
    """
    tables = tables_of(source)
    found = [[test for test in _tests(table, columns) if test is not None] for table in tables]
    tests = [test for of_table in found for test in of_table]
    if not tests:
        raise nothing_found(tables, columns)
    unused = [table for table, of_table in zip(tables, found, strict=True) if source.workbook and not of_table]
    without = [left_out(table, columns) for table in unused]
    return [*unless_all_fail(tests), *(sheet for sheet in without if sheet)]


def lacking(source: Source) -> str | None:
    """Return the channel that a table lacks whose header, with numbers below, names the others; None without such."""
    parted = re.compile(r"[\t;,]")
    text = [parted.split(line) if parted.search(line) else NAME_WITH_UNIT.findall(line) for line in source.lines]
    for rows in [source.sheet(name) for name in source.sheets] or [text]:
        for row, *below in zip(rows, rows[1:], rows[2:], strict=False):
            named = {key: k for k, cell in enumerate(row) if isinstance(cell, str) and (key := channel_of(cell))}
            if len(named) == len(CHANNELS) - 1 and any(_numeric(cells, named.values()) for cells in below):
                return next(key for key in CHANNELS if key not in named)
    return None


def _numeric(row: Sequence[Any], indices: Iterable[int]) -> bool:
    """Return whether cells of a row hold digits and no words."""
    cells = [str(row[k]) if k < len(row) else "" for k in indices]
    return all(re.search(r"\d", cell) and not is_word(cell) for cell in cells)


def _tests(table: Table, columns: ColumnMap) -> list[VendorTest | Unreadable | None]:
    """Return the tests in a table: one, or several below one another, each under the same row of names."""
    path = table.source.path
    parts = attempt(path, table.name, _parts, table, columns)
    if isinstance(parts, Unreadable):
        return [parts]
    names = [f"{table.name}_{number}" for number in range(1, len(parts) + 1)] if len(parts) > 1 else [table.name]
    return [attempt(path, name, _test, name, part, columns) for name, part in zip(names, parts, strict=True)]


def _parts(table: Table, columns: ColumnMap) -> list[Table]:
    """Return the table, cut where its header is repeated and time does not go on; each has what stands above it.

    Where time goes on, the header is repeated within a test.
    """
    found = columns_of(table.rows, columns)
    if found is None:
        return [table]
    indices = found[1]
    header = _header_above(table, indices) if found[0] is None else found[0]
    if header is None:
        return [table]
    repeated = [k for k, row in enumerate(table.rows) if k > header and [*row] == [*table.rows[header]]]
    if not repeated:
        return [table]
    body = table.body(None, indices)
    time = numbers([[seconds(clock), *others] for clock, *others in body.rows], body.place)[:, 0]
    cuts = [header]
    for k in repeated:
        past, coming = (part[np.isfinite(part)] for part in (time[cuts[-1] : k], time[k:]))
        if len(past) and len(coming) and coming[0] <= past[-1]:
            cuts.append(k)
    return [table.at([*range(header), *range(*part)]) for part in pairwise([*cuts, len(table.rows)])]


def _header_above(table: Table, indices: Sequence[int]) -> int | None:
    """Return the header's row of columns that are given by their numbers; None where numbers come before any."""
    first = next((k for k, row in enumerate(table.rows) if _numeric(row, indices)), 0)
    rows = table.body(None, indices).rows[:first]
    return _names([[str(cell).strip() for cell in row] for row in rows])


def _test(name: str, table: Table, columns: ColumnMap) -> VendorTest | None:
    """Return the test of a name in a table, or None when it has no such columns or no numbers in them."""
    found = columns_of(table.rows, columns)
    if found is None:
        return None
    named, indices = found
    body = table.body(named, indices)
    if not body.rows:
        return None
    clock = [seconds(row[0]) for row in body.rows]
    values = numbers([[time, *others] for time, (_, *others) in zip(clock, body.rows, strict=True)], body.place)
    whole = np.isfinite(values).all(axis=1)
    if not whole.any():
        return None
    of_numbers = np.flatnonzero(whole) + len(table.rows) - len(body.rows)
    above = [[str(cell).strip() for cell in row] for row in table.body(None, indices).rows[: of_numbers[0]]]
    header = _names(above) if named is None else named
    if named is not None or table.delimiter == ",":
        _check_width(table, header, of_numbers)
    kept, warnings = _kept(body, values)
    units, assumed = _units(columns, above, header, told="s" if clock[kept[0]] != body.rows[kept[0]][0] else None)
    if assumed:
        warnings += (f"no unit is stated: {', '.join(f'{key} taken as {CHANNELS[key]}' for key in assumed)} (--units)",)
    time, load, depth = (values[kept, k] * scale(key, units[key]) for k, key in enumerate(CHANNELS))
    facts = {"columns": ", ".join(f"{key} {columns.names[key]} [{units[key]}]" for key in CHANNELS)}
    recording = Recording(time - time[0], load, depth, name, (f"from {table.source.path.name}",))
    return VendorTest(name, recording, facts, warnings, marked=False)


def _names(above: Sequence[Sequence[str]]) -> int | None:
    """Return the first row of three words that are no units: the header of columns that are given by their numbers."""
    return next((k for k, row in enumerate(above) if all(map(is_word, row)) and not is_row_of_units(row)), None)


def _units(
    columns: ColumnMap, above: Sequence[Sequence[str]], header: int | None, told: str | None
) -> tuple[dict[str, str], list[str]]:
    """Return the unit of each channel and the channels whose unit nobody states, which is taken as s, mN or nm.

    It is as given, else as the rows `above` the numbers state it. A row holds the cells of time, load and depth. Above
    the header it counts if it is of units, below it if of words. `told` is the unit of times that are read off a clock.
    """
    alone = [row for row in above[:header] if is_row_of_units(row)]
    if header is not None:
        alone += [row for row in above[header + 1 :] if all(is_word(cell) for cell in row if cell)]
    units = {}
    for k, key in enumerate(CHANNELS):
        heading = "" if header is None else above[header][k]
        beside = [row[k] for row in alone if row[k]]
        given = told if told and key == "time" else columns.units.get(key)
        units[key] = given or stated(key, columns.names[key], heading, beside)
    assumed = [key for key, unit in units.items() if unit is None]
    return {key: unit or CHANNELS[key] for key, unit in units.items()}, assumed


def _check_width(table: Table, header: int | None, rows: np.ndarray) -> None:
    """Refuse `rows` of numbers where a separator within a number, or within a name, has torn the cells apart.

    They have more cells than the header; or where there is none, more than three, and not one with a decimal sign.
    In a table split at blanks they have fewer than a header whose names hold blanks.
    """
    width = len(CHANNELS) if header is None else len(table.rows[header])
    if header is None and any(re.search("[.,]", str(cell)) for row in rows for cell in table.rows[row]):
        return
    wider = next((row for row in rows if any(str(cell).strip() for cell in table.rows[row][width:])), None)
    if table.delimiter == " " and len(table.rows[rows[0]]) < width:
        row, remedy = rows[0], "give the columns by their numbers, from 1"
    elif wider is not None:
        row, remedy = wider, "export it with semicolons or tabs between the columns"
        remedy += ", or write their names above" if header is None else ", or put numbers with commas in quotes"
    else:
        return
    problem = "and no number a decimal sign" if header is None else f"its header {width}"
    raise InputError(f"has {len(table.rows[row])} cells, {problem}", remedy=remedy, place=table.place(row))


def _kept(body: Table, values: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the rows of `values` (n, 3) that make a test, and what is left out in words.

    Empty cells before the first and after the last whole row are no damage: a channel may begin later or end earlier.
    """
    whole, partly = np.isfinite(values).all(axis=1), np.isfinite(values).any(axis=1)
    complete = np.flatnonzero(whole)
    row = np.arange(len(values))
    between = (row >= complete[0]) & (row <= complete[-1])
    late = np.zeros(len(values), dtype=bool)
    late[complete[~increasing(values[complete, 0])]] = True
    spoilt = ~whole & (between | partly)
    counted = between | (spoilt & (row > complete[-1]) & np.isnan(values).any(axis=1))
    damaged, kept = np.flatnonzero(counted & (spoilt | late)), np.flatnonzero(whole & ~late)
    if len(damaged) > MOST_LEFT_OUT * counted.sum():
        first = int(damaged[0])
        cells = ", ".join(str(cell) for cell in body.rows[first])
        raise InputError(
            f"{cells!r} {'does not come later than the rows before' if late[first] else 'is not three numbers'}; "
            f"{len(damaged)} of {counted.sum()} rows cannot be used",
            remedy="correct them, export the test again, or write each of several tests to a file of its own",
            place=body.place(first),
        )
    if len(kept) < 2:
        raise InputError("is the only row of numbers", remedy="export the test again", place=body.place(int(kept[0])))
    causes = [
        f"{cause} ({body.place(*np.flatnonzero(rows))})"
        for cause, rows in (("no three numbers", spoilt), ("time does not increase", late))
        if rows.any()
    ]
    left_out = int((spoilt | late).sum())
    return kept, (f"{left_out} of {left_out + len(kept)} rows left out: {', '.join(causes)}",) if causes else ()
