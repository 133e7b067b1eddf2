"""Tables of cells: the sheets of a workbook, or the one table of a text whose separators are detected."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from indentation_files.readers.decimals import PARTING
from indentation_files.readers.plain_numbers import is_long, plain_numbers
from indentation_files.readers.source import Source
from indentation_files.sentences import first_few

DELIMITERS = ("\t", ";", "|", ",")
WORD = re.compile(r"[^\W\d_]")
LISTED, LONGEST_NAME = 12, 40  # names of columns in a message, and letters of each
SPANNED = 4  # lines, at most, that one pair of double quotes spans
SHORTEST = 2  # bytes of an empty line at most; those of three cells have more
NUMBER = rf"[-+]?(?:(?:\d+\.?|\d*[.,]\d+)(?:[eE][-+]?\d+)?|\d{{1,3}}(?:[{PARTING}]\d{{3}})+(?:[.,]\d*)?)"
NUMBERS_AT_BLANKS = re.compile(rf" *{NUMBER}(?: +{NUMBER})+ *")
BLANKS, GAPS = re.compile("[ \t]+"), re.compile(" {2,}")
HALF_OF_DAY = re.compile(r"(?<=:\d\d)([.,]\d+)? +([ap]\.?m\.?)(?= |$)", re.IGNORECASE)
NAME_WITH_UNIT = re.compile(r"\S+(?: +[(\[][^\d()\[\]]+[)\]](?!\S))?")


@dataclass(frozen=True, eq=False)
class Core:
    """Rows of a table that are nothing but numbers, from the `first` up to the `end`.

    `columns` are the table's (n,), with room for the rows beside; infinite there and where a cell is empty or invalid.
    `sign` is the decimal sign; empty where no cell needs one.
    """

    first: int
    end: int
    columns: Sequence[np.ndarray]
    sign: str

    def picked(self, start: int, indices: Sequence[int]) -> Core:
        """Return what a table holds of it that begins at the row `start` and has some of the columns."""
        width, rest = len(self.columns), len(self.columns[0]) - start
        columns = [self.columns[k][start:] if k < width else np.full(rest, np.inf) for k in indices]
        return Core(max(self.first - start, 0), max(self.end - start, 0), columns, self.sign)


@dataclass(frozen=True)
class OnDemand(Sequence[Any]):
    """Items of a sequence of a `length`; `make` returns that of a number when it is asked for."""

    length: int
    make: Callable[[int], Any]

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, wanted: Any) -> Any:
        chosen = range(self.length)[wanted]
        return OnDemand(len(chosen), lambda k: self.make(chosen[k])) if isinstance(chosen, range) else self.make(chosen)


@dataclass(frozen=True)
class Table:
    """Rows of cells, and where they are.

    `source` is the file, `name` the sheet's, or the file's own. `rows` are cells, as text or as a workbook's values,
    `numbers` those of the rows in the file or the sheet. The `delimiter` parts the cells of a text, where a blank means
    any number of them; None in a workbook. `core` is the longest run of rows of nothing but numbers in a long text;
    None in another table.
    """

    source: Source
    name: str
    rows: Sequence[Sequence[Any]]
    numbers: Sequence[int] | np.ndarray
    delimiter: str | None = None
    core: Core | None = None

    @property
    def aside(self) -> list[int]:
        """The rows outside the core, in which alone words are."""
        inside = range(self.core.first, self.core.end) if self.core else range(0)
        return [*range(inside.start), *range(inside.stop, len(self.rows))]

    def place(self, *rows: int) -> str:
        """Return where the first few of `rows` are, and how many more there are."""
        named = first_few([self.numbers[row] for row in rows])
        return (f"sheet {self.name}, row " if self.source.workbook else "line ") + named

    def body(self, header: int | None, indices: Sequence[int]) -> Table:
        """Return some columns of the rows below the header, or of all rows where there is none."""
        start = 0 if header is None else header + 1
        rows = OnDemand(len(self.rows) - start, lambda row: _picked(self.rows[start + row], indices))
        core = self.core and self.core.picked(start, indices)
        return Table(self.source, self.name, rows if core else list(rows), self.numbers[start:], core=core)


def tables_of(source: Source) -> list[Table]:
    """Return a workbook's sheets, or the one table of a text file.

    Lines are split at tabs, semicolons, bars or commas, whichever most of them hold more than one of, but not at the
    decimal commas of numbers between blanks; else at blanks.
    """
    if source.workbook:
        sheets = [(name, source.empty_before(name), *source.placed_sheet(name)) for name in source.sheets]
        whole = [
            (name, first, [[""] * empty + row for row in rows] if empty else rows)
            for name, empty, first, rows in sheets
        ]
        return [Table(source, name, rows, range(first, first + len(rows))) for name, first, rows in whole]
    long = _with_core(source)
    if long:
        return [long]
    lines = _joined({number: line for number, line in enumerate(source.lines.one_by_one(), 1) if line.strip()})
    delimiter, split = _parting(list(lines.values()))
    return [Table(source, source.path.stem, [split(line) for line in lines.values()], list(lines), delimiter)]


def _with_core(source: Source) -> Table | None:
    """Return the table of a text most of which is one run of numbers; None for another."""
    lines = source.lines
    if not is_long(lines):
        return None
    bounds = np.concatenate([[-1], lines.worded, [len(lines)]])
    widest = int(np.argmax(np.diff(bounds)))
    first, last = int(bounds[widest]) + 1, int(bounds[widest + 1])
    first = next((k for k in range(first, last) if lines[k].strip()), last)
    if last - first <= len(lines) / 2:
        return None
    aside = _joined({k: line for k in (*range(first), *range(last, len(lines))) if (line := lines[k]).strip()})
    delimiter, split = _parting([lines[first]] * (len(aside) + 1) + list(aside.values()))
    before, after = ([k + 1 for k in aside if (k < first) == earlier] for earlier in (True, False))
    found = plain_numbers(lines[first:last], delimiter, room=(len(before), len(after)))
    filled = first + 1 + np.flatnonzero(np.diff(lines.starts[first : last + 1]) > SHORTEST).astype(np.int32)
    numbers = np.concatenate([before, filled, after], dtype=np.int32, casting="unsafe")
    if found is None or found[0].shape[1] != len(numbers):
        return None
    columns, sign = found
    rows = OnDemand(len(numbers), lambda k: split(lines[int(numbers[k]) - 1]))
    core = Core(len(before), len(before) + len(filled), list(columns), sign)
    return Table(source, source.path.stem, rows, numbers, delimiter, core)


def _joined(lines: Mapping[int, str]) -> dict[int, str]:
    """Return lines by their numbers; those that a pair of double quotes spans, as a heading may, are one."""
    found, numbers = dict(lines), list(lines)
    for place, number in enumerate(numbers):
        if number not in found or found[number].count('"') % 2 == 0:
            continue
        for last in range(place + 1, min(place + SPANNED, len(numbers))):
            together = numbers[place : last + 1]
            if sum(found[k].count('"') for k in together) % 2 == 0:
                found[number] = " ".join(found.pop(k) for k in together)
                break
    return {number: found[number] for number in numbers if number in found}


def _parting(lines: Sequence[str]) -> tuple[str, Callable[[str], list[str]]]:
    """Return what parts the cells of most lines, and what makes cells of a line."""
    at_blanks = [len(BLANKS.split(line.strip())) if NUMBERS_AT_BLANKS.fullmatch(line) else 0 for line in lines]
    for delimiter in DELIMITERS:
        holding = [line.count(delimiter) >= 2 and not cells for line, cells in zip(lines, at_blanks, strict=True)]
        if sum(holding) > len(lines) / 2:
            return delimiter, partial(_cells, delimiter=delimiter)
    usual = Counter(len(HALF_OF_DAY.sub(r"\1\2", line).split()) for line in lines)
    width = max(at_blanks, default=0) or max(usual, key=lambda count: usual[count], default=0)
    return " ", partial(_at_blanks, width=width)


def _picked(row: Sequence[Any], indices: Sequence[int]) -> list[Any]:
    """Return some cells of a row; those that it lacks are empty."""
    return [row[k] if k < len(row) else "" for k in indices]


def _at_blanks(line: str, width: int) -> list[str]:
    """Return the cells of a line without # before it, as many as `width` where it can be.

    Words of a name stand one blank apart where cells stand more apart, and units in brackets join their names. The half
    of the day behind a clock belongs to it. Blanks that break no line part cells only where no others do: elsewhere
    they may part a number's thousands.
    """
    line = HALF_OF_DAY.sub(r"\1\2", line.removeprefix("#"))
    for cells in (GAPS.split(line.strip()), NAME_WITH_UNIT.findall(line)):
        if len(cells) == width:
            return cells
    apart = [cell for cell in BLANKS.split(line) if cell.strip()]
    return apart if len(apart) > 1 else line.split()


def _cells(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line; one in double quotes may hold the delimiter."""
    try:
        (cells,) = csv.reader([line], delimiter=delimiter, skipinitialspace=True)
    except csv.Error:
        return line.split(delimiter)
    return [cell.strip() for cell in cells]


def header_of(tables: Sequence[Table]) -> str:
    """Return the names in the row that looks most like a header: the first with most words."""
    all_rows = (table.rows[k] for table in tables for k in table.aside)
    rows = [[cell for cell in row if isinstance(cell, str) and WORD.search(cell)] for row in all_rows]
    names = [name[:LONGEST_NAME] for name in max(rows, key=len, default=[])]
    return ", ".join(names[:LISTED]) + (", ..." if len(names) > LISTED else "") if names else "none is found"
