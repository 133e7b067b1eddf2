"""Any table, text or Excel, by a map of its columns that the user gives: no format is guessed, none is assumed."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from palpate.errors import InputError
from palpate.readers.clock import seconds
from palpate.readers.decimals import numbers
from palpate.readers.headings import channel_of, is_row_of_units, is_word, stated
from palpate.readers.source import Source
from palpate.readers.units import CHANNELS, plain, scale
from palpate.readers.vendor import MOST_LEFT_OUT, PLACES, Unreadable, VendorTest, attempt, increasing, unless_all_fail
from palpate.recording import Recording

DELIMITERS = ("\t", ";", ",")
WORD = re.compile(r"[^\W\d_]")
LISTED = 12
NUMBER = r"[-+]?(?:\d+\.?|\d*[.,]\d+)(?:[eE][-+]?\d+)?"
NUMBERS_AT_BLANKS = re.compile(rf" *{NUMBER}(?: +{NUMBER})+ *")
NAME_WITH_UNIT = re.compile(r"\S+(?: +[(\[][^\d()\[\]]+[)\]](?!\S))?")


@dataclass(frozen=True)
class ColumnMap:
    """Which columns hold what.

    Parameters
    ----------
    names
        Name of the column, or its number from 1, for each of ``time``, ``load`` and ``depth``.
    units
        Their units, where the table states none or wrong ones; ``-mN`` turns the sign. s, mN and nm where neither
        says more.
    """

    names: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for key in CHANNELS:
            if key not in self.names:
                raise InputError(
                    f"no column is named for {key}",
                    remedy=f"add {key}=NAME; if the table has none, export it with {key}, which cannot be guessed",
                    place="columns",
                )
        for given, place in ((self.names, "columns"), (self.units, "units")):
            for key in given:
                if key not in CHANNELS:
                    raise InputError(f"{key!r} is no channel", remedy="use time, load and depth", place=place)
        owners: dict[str, str] = {}
        for key, name in self.names.items():
            if name in owners:
                raise InputError(
                    f"{owners[name]} and {key} are both {name!r}", remedy="name a column for each", place="columns"
                )
            owners[name] = key
        for key, unit in self.units.items():
            scale(key, unit)


@dataclass(frozen=True)
class Table:
    """Rows of cells, and where they stand.

    Parameters
    ----------
    source, name
        The file, and the table's name: its sheet's, or the file's own.
    rows, numbers
        Cells, as text or as a workbook's values, and the number of each row in the file or the sheet.
    delimiter
        What parts the cells of a text, where a blank stands for any number of them; None in a workbook.
    """

    source: Source
    name: str
    rows: Sequence[Sequence[Any]]
    numbers: Sequence[int]
    delimiter: str | None = None

    def place(self, *rows: int) -> str:
        """Return where the first few of `rows` stand, and how many more there are."""
        named = ", ".join(str(self.numbers[row]) for row in rows[:PLACES])
        more = f" and {len(rows) - PLACES} more" if len(rows) > PLACES else ""
        return (f"sheet {self.name}, row " if self.source.workbook else "line ") + named + more

    def at(self, kept: Sequence[int]) -> Table:
        """Return the table of some of its rows."""
        return replace(self, rows=[self.rows[k] for k in kept], numbers=[self.numbers[k] for k in kept])

    def body(self, header: int | None, indices: Sequence[int]) -> Table:
        """Return some columns of the rows below the header, or of all rows where there is none."""
        start = 0 if header is None else header + 1
        rows = [[row[k] if k < len(row) else "" for k in indices] for row in self.rows[start:]]
        return Table(self.source, self.name, rows, self.numbers[start:])


def read_columns(source: Source, columns: ColumnMap) -> list[VendorTest | Unreadable]:
    """Read the table of a text file, or one from each sheet of a workbook that holds the columns.

    A table that repeats its header, and begins its time anew there, holds several tests.

    The header is the first row with all names; where columns are given by their numbers it tells nothing but units.
    Rows without any number, of units and remarks, do no harm before and after the numbers; other rows without three, or
    with a time that does not increase, are left out with a warning.

    Raises
    ------
    InputError
        When no table has the columns, or none that has them can be read: it has several of a name, more than a
        twentieth of its rows would be left out, cells do not fit the header, or a unit is not known.
    """
    tables = _tables(source)
    found = [test for table in tables for test in _tests(table, columns)]
    tests = [test for test in found if test is not None]
    if not tests:
        raise InputError(
            f"holds no table with numbers in the columns {', '.join(columns.names[key] for key in CHANNELS)}"
            f"{_no_numbers(tables, columns)}",
            remedy=f"name columns of its header ({_header(tables)}), or give their numbers from 1",
            file=source.path,
        )
    return unless_all_fail(tests)


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
    found = _columns_of(table.rows, columns)
    if found is None or found[0] is None:
        return [table]
    header, indices = found[0], found[1]
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


def _test(name: str, table: Table, columns: ColumnMap) -> VendorTest | None:
    """Return the test of a name in a table, or None when it has no such columns or no numbers in them."""
    found = _columns_of(table.rows, columns)
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
    return VendorTest(name, recording, facts, warnings)


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


def _tables(source: Source) -> list[Table]:
    """Return a workbook's sheets, or the one table of a text file.

    Lines are split at tabs, semicolons or commas, whichever most of them hold more than one of, but not at the decimal
    commas of numbers between blanks; else at blanks.
    """
    if source.workbook:
        sheets = [(name, *source.placed_sheet(name)) for name in source.sheets]
        return [Table(source, name, rows, range(first, first + len(rows))) for name, first, rows in sheets]
    lines = {number: line for number, line in enumerate(source.lines, 1) if line.strip()}
    at_blanks = {number: len(line.split()) for number, line in lines.items() if NUMBERS_AT_BLANKS.fullmatch(line)}
    for delimiter in DELIMITERS:
        holding = {number for number, line in lines.items() if line.count(delimiter) >= 2}
        if len(holding - at_blanks.keys()) > len(lines) / 2:
            split = [_cells(line, delimiter) for line in lines.values()]
            return [Table(source, source.path.stem, split, list(lines), delimiter)]
    width = max(at_blanks.values(), default=0)
    split = [_at_blanks(line, width) for line in lines.values()]
    return [Table(source, source.path.stem, split, list(lines), " ")]


def _at_blanks(line: str, width: int) -> list[str]:
    """Return the cells of a line without # before it; units in brackets join their names where that gives `width`."""
    cells = NAME_WITH_UNIT.findall(line.removeprefix("#"))
    return cells if len(cells) == width else line.removeprefix("#").split()


def _cells(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line; one in double quotes may hold the delimiter."""
    try:
        (cells,) = csv.reader([line], delimiter=delimiter, skipinitialspace=True)
    except csv.Error:
        return line.split(delimiter)
    return [cell.strip() for cell in cells]


def _columns_of(rows: Sequence[Sequence[Any]], columns: ColumnMap) -> tuple[int | None, list[int]] | None:
    """Return the header's row, None for columns by number, and the index of each channel; None without the columns."""
    given = [columns.names[key].strip() for key in CHANNELS]
    if all(name.isdecimal() and int(name) > 0 for name in given):
        return None, [int(name) - 1 for name in given]
    wanted = [plain(name) for name in given]
    for number, row in enumerate(rows):
        cells = [plain(str(cell)) for cell in row]
        if all(name in cells for name in wanted):
            for name in wanted:
                if cells.count(name) > 1:
                    raise InputError(
                        f"several columns are called {name!r}", remedy="give the columns by their numbers, from 1"
                    )
            return number, [cells.index(name) for name in wanted]
    return None


def _no_numbers(tables: Sequence[Table], columns: ColumnMap) -> str:
    """Return, for a message, the first row with digits of a table that has the columns but no numbers in them."""
    for table in tables:
        found = _columns_of(table.rows, columns)
        body = table.body(*found) if found else None
        for k, row in enumerate(body.rows if body else ()):
            cells = ", ".join(str(cell) for cell in row)
            if body and all(map(str, row)) and re.search(r"\d", cells):
                return f" ({body.place(k)}: {cells!r})"
    return ""


def _header(tables: Sequence[Table]) -> str:
    """Return the names in the row that looks most like a header: the first with most words."""
    rows = [[cell for cell in row if isinstance(cell, str) and WORD.search(cell)] for t in tables for row in t.rows]
    names = max(rows, key=len, default=[])
    return ", ".join(names[:LISTED]) + (", ..." if len(names) > LISTED else "") if names else "none is found"
