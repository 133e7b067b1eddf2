"""Any table, text or Excel, by a map of its columns that the user gives: no format is guessed, none is assumed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.column_map import ColumnMap, columns_of
from indentation_files.readers.column_warnings import column_warnings
from indentation_files.readers.headings import OF_UNITS, channel_of, in_prose, is_row_of_units, is_word, stated
from indentation_files.readers.left_out import left_out, nothing_found
from indentation_files.readers.rising_time import increasing, stands_still
from indentation_files.readers.several_tests import Channels, Part, ends, taken, whole
from indentation_files.readers.source import Source
from indentation_files.readers.table_body import TableBody, body_of, is_numeric, parts_of
from indentation_files.readers.tables import NAME_WITH_UNIT, OnDemand, Table, tables_of
from indentation_files.readers.units import CHANNELS, scale
from indentation_files.readers.vendor import MOST_LEFT_OUT, Unreadable, VendorTest, read_or_report, unfinished
from indentation_files.recording import Recording, spaced

LONG_AGO = 1e6  # of a test's duration, chosen: what counts from longer ago is a calendar's time
UNLIKE = 0.05  # of the range of loads, by which those of one time differ where tests are mixed
EPOCH = (1e9, 4.2e9)  # seconds since 1970, in the years 2001 to 2103


def read_columns(source: Source, columns: ColumnMap) -> list[VendorTest | Unreadable]:
    """Read the table of a text file, or one from each sheet of a workbook that holds the columns.

    A table may hold several tests below one another (`indentation_files.readers.several_tests`). Sheets that give none,
    and hold a table, come last, with what is wrong with them: so the tests keep their numbers.

    The header is the first row with all names; where columns are given by their numbers it gives nothing but units.
    Rows without any number, of units and remarks, do no harm before and after the numbers, nor do rows that are written
    twice or zeros at the end; other rows without three, or with a time that does not increase, are left out with a
    warning.

    Raises `InputError` when no table has the columns, or none that has them can be read: it has several of a name, more
    than a twentieth of its rows would be left out, cells do not fit the header, or a unit is not known.
    """
    tables = tables_of(source)
    found = [_tests(table, columns) for table in tables]
    tests = [test for of_table in found for test in of_table]
    if not tests:
        raise nothing_found(tables, columns)
    unused = [table for table, of_table in zip(tables, found, strict=True) if source.workbook and not of_table]
    without = [left_out(table, columns) for table in unused]
    return [*tests, *(sheet for sheet in without if sheet)]


def holds_columns(source: Source, columns: ColumnMap) -> bool:
    """Return whether a table of a file has the columns."""
    return any(columns_of(table, columns) is not None for table in tables_of(source))


def missing_channel(source: Source) -> str | None:
    """Return the channel that a table lacks whose header, with numbers below, names the others; None without such."""
    parted = re.compile(r"[\t;,]")
    lines = source.lines
    text = OnDemand(
        len(lines), lambda k: parted.split(line) if parted.search(line := lines[k]) else NAME_WITH_UNIT.findall(line)
    )
    tables: list[tuple[Sequence[Any], Sequence[int]]] = [(text, lines.worded.tolist())]
    if source.workbook:
        tables = [(rows, range(len(rows))) for rows in map(source.sheet, source.sheets)]
    for rows, places in tables:
        for place in places:
            row, below = rows[place], rows[place + 1 : place + 3]
            named = {key: k for k, cell in enumerate(row) if isinstance(cell, str) and (key := channel_of(cell))}
            if len(named) == len(CHANNELS) - 1 and any(is_numeric(cells, named.values()) for cells in below):
                return next(key for key in CHANNELS if key not in named)
    return None


def _tests(table: Table, columns: ColumnMap) -> list[VendorTest | Unreadable]:
    """Return the tests in a table: one, several below one another, or none without the columns or numbers in them."""
    path = table.source.path
    body = read_or_report(path, table.name, body_of, table, columns)
    if body is None or isinstance(body, Unreadable):
        return [] if body is None else [body]
    parts = read_or_report(path, table.name, parts_of, body)
    if isinstance(parts, Unreadable):
        return [parts]
    names = [f"{table.name}_{number}" for number in range(1, len(parts) + 1)] if len(parts) > 1 else [table.name]
    return [
        read_or_report(path, name, _test, name, body, part, columns) for name, part in zip(names, parts, strict=True)
    ]


def _test(name: str, body: TableBody, part: Part, columns: ColumnMap) -> VendorTest:
    """Return the test of a name from its part of a table."""
    table, skipped = body.table, len(body.table.rows) - len(body.cells.rows)
    begin, filled = skipped + part.rows.start, whole(part.channels)
    if body.named is not None or table.delimiter == ",":
        _check_width(table, body.header, begin, filled)
    kept, messages = _kept(body.cells, part, 0 if body.named is not None or body.header is None else body.header + 1)
    units, assumed = _units(columns, body.above, body.header, clock_unit="s" if body.of_clock else None)
    messages = (*body.messages, *part.messages, *messages)
    if assumed:
        _check_assumed(table, columns, assumed, part.channels[0][kept])
        messages += (f"no unit is stated: {', '.join(f'{key} taken as {CHANNELS[key]}' for key in assumed)} (--units)",)
    time, load, depth = (
        channel[kept] * scale(key, units[key]) for channel, key in zip(part.channels, CHANNELS, strict=True)
    )
    messages += column_warnings(body, kept + begin)
    facts = {"columns": ", ".join(f"{key} {columns.names[key]} [{units[key]}]" for key in CHANNELS)}
    recording = Recording(time - time[0], load, depth, name, (f"from {table.source.path.name}",))
    at_end = part.rows.stop == len(body.cells.rows)
    messages += unfinished(load) if at_end and _breaks_off(part.channels, ends(filled)[1]) else ()
    return VendorTest(name, recording, facts, messages, marked=False)


def _breaks_off(channels: Channels, end: int) -> bool:
    """Return whether rows from the `end` on, which lack three numbers, are no words."""
    rest = np.array([channel[end:] for channel in channels])
    return bool((np.isfinite(rest).any(axis=0) | np.isinf(rest).all(axis=0)).any())


def _units(
    columns: ColumnMap, above: Sequence[Sequence[str]], header: int | None, clock_unit: str | None
) -> tuple[dict[str, str], list[str]]:
    """Return the unit of each channel and the channels whose unit nobody states, which is taken as s, mN or nm.

    It is as given, else as the rows `above` the numbers state it. A row holds the cells of time, load and depth. Above
    the header it counts if it is of units, below it if of words. `clock_unit` is that of times on a clock.
    """
    alone = [row for row in above[:header] if is_row_of_units(row)]
    if header is not None:
        alone += [row for row in above[header + 1 :] if all(is_word(cell) for cell in row if cell)]
    units = {}
    for k, key in enumerate(CHANNELS):
        heading = "" if header is None else above[header][k]
        beside = [row[k] for row in alone if row[k] and not OF_UNITS.search(row[k])]
        given = clock_unit if clock_unit and key == "time" else columns.units.get(key)
        units[key] = given or stated(key, columns.names[key], heading, beside)
    assumed = [key for key, unit in units.items() if unit is None]
    return {key: unit or CHANNELS[key] for key, unit in units.items()}, assumed


def _check_assumed(table: Table, columns: ColumnMap, assumed: Sequence[str], time: np.ndarray) -> None:
    """Refuse a unit that would be assumed where the file says another, or where a calendar gives the `time` (n,)."""
    for row in table.aside:
        line = ", ".join(str(cell) for cell in table.rows[row] if is_word(str(cell)))
        for key, unit in in_prose(line).items():
            if key in assumed and unit != CHANNELS[key]:
                problem = f"column {columns.names[key]} has no unit beside it, and {line[:60]!r} says {unit}"
                remedy = f"state it by --units {key}=UNIT (in a study by source.units)"
                raise InputError(problem, remedy=remedy, place=table.place(row))
    begin, duration = abs(float(time[0])), float(np.ptp(time))
    if "time" in assumed and begin > LONG_AGO * duration and not EPOCH[0] <= begin < EPOCH[1]:
        raise InputError(
            f"has no unit beside it; it begins at {begin:.12g} and lasts {duration:.3g}, as days or milliseconds of a "
            "calendar do",
            remedy="state the unit by --units time=UNIT (in a study by source.units), such as d or ms",
            place=f"column {columns.names['time']}",
        )


def _check_width(table: Table, header: int | None, begin: int, filled: np.ndarray) -> None:
    """Refuse rows of numbers where a separator within a number, or within a name, has torn the cells apart.

    These are the rows `filled` (n,) from the one `begin` on. They have more numbers than the header has cells; or where
    there is none, more than three, and not one with a decimal sign. In a table split at blanks they have fewer than a
    header whose names hold blanks.
    """
    width = len(CHANNELS) if header is None else len(table.rows[header])
    if table.core:  # whose rows are all as wide
        filled = filled.copy()
        inside = filled[max(table.core.first - begin, 0) : max(table.core.end - begin, 0)]
        inside &= np.cumsum(inside, dtype=np.int32) == 1
    rows = [begin + int(row) for row in np.flatnonzero(filled)]
    if header is None and any(re.search("[.,]", str(cell)) for row in rows for cell in table.rows[row]):
        return
    wider = next((row for row in rows if any(is_numeric([cell], [0]) for cell in table.rows[row][width:])), None)
    if table.delimiter == " " and len(table.rows[rows[0]]) < width:
        row, remedy = rows[0], "give the columns by their numbers, from 1"
    elif wider is not None:
        row, remedy = wider, "export it with semicolons or tabs between the columns"
        remedy += ", or write their names above" if header is None else ", or put numbers with commas in quotes"
    else:
        return
    problem = "and no number a decimal sign" if header is None else f"its header {width}"
    raise InputError(f"has {len(table.rows[row])} cells, {problem}", remedy=remedy, place=table.place(row))


def _kept(cells: Table, part: Part, below: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the rows of a `part` of the `cells` that make a test, and what is left out in words.

    Idle rows count for nothing. Empty cells before the first and after the last whole row are no damage: a channel may
    begin later or end earlier. Three cells with digits that are no numbers are damage from the row `below` a header on.
    """
    channels, idle = part.channels, part.idle
    filled = whole(channels) & ~idle
    partly = np.logical_or.reduce([np.isfinite(channel) for channel in channels]) & ~idle
    begin, end = ends(filled)
    between = ~idle
    between[:begin] = between[end:] = False
    for row in cells.aside:
        k = row - part.rows.start
        if row >= below and row in part.rows and not (begin <= k < end or idle[k]):
            unread = all(np.isnan(channel[k]) for channel in channels)
            between[k] = unread and all(re.search(r"\d", str(cell)) for cell in cells.rows[row])
    late = np.zeros(len(idle), dtype=bool)
    late[filled] = ~increasing(taken(channels[0], filled))
    spoilt = ~filled & (between | partly)
    counted = between.copy()
    counted[end:] |= spoilt[end:] & np.logical_or.reduce([np.isnan(channel[end:]) for channel in channels])
    damaged, kept = np.flatnonzero(counted & (spoilt | late)), np.flatnonzero(filled & ~late)
    if len(damaged) > MOST_LEFT_OUT * counted.sum():
        raise _too_many(cells, part, damaged, late, int(counted.sum()))
    if len(kept) < 2:
        raise InputError(
            "is the only row of numbers", remedy="export the test again", place=cells.place(part.rows[kept[0]])
        )
    causes = [
        f"{cause} ({cells.place(*np.flatnonzero(rows) + part.rows.start)})"
        for cause, rows in (("no three numbers", spoilt), ("time does not increase", late))
        if rows.any()
    ]
    left_out = int((spoilt | late).sum())
    messages = [f"{left_out} of {left_out + len(kept)} rows left out: {', '.join(causes)}"] if causes else []
    if late[begin]:
        first = part.rows[begin]
        written = ", ".join(str(cell) for cell in cells.rows[first])
        messages.append(
            f"{written!r} ({cells.place(first)}) is no value; if these are factors, --units must count them"
        )
    kept, thinned = spaced(kept)
    return kept, (*messages, *thinned)


def _too_many(cells: Table, part: Part, damaged: np.ndarray, late: np.ndarray, count: int) -> InputError:
    """Return the error of a test of which so many rows, `damaged`, of `count` would be left out."""
    first, filled = int(damaged[0]), whole(part.channels) & ~part.idle
    row = part.rows[first]
    written = ", ".join(str(cell) for cell in cells.rows[row])
    what = "is out of order in time" if late[first] else "is not three numbers"
    remedy = "correct them, export the test again, or write each of several tests to a file of its own"
    if late[damaged].all() and stands_still(taken(part.channels[0], filled), ~late[filled])[late[filled]].all():
        what, remedy = "has the time of the row before", "export the time with more digits, as fractions of a second"
        load = part.channels[1]
        if np.abs(np.diff(load[filled])[late[filled][1:]]).mean() > UNLIKE * np.ptp(load[filled]):
            what, remedy = f"{what} and another load", "write each of several tests to a file of its own"
    problem = f"{written!r} {what}; {len(damaged)} of {count} rows cannot be used"
    return InputError(problem, remedy=remedy, place=cells.place(row))
