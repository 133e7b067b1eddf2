"""Tables of cells: the sheets of a workbook, or the one table of a text whose separators are detected."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from palpate.recordings.readers.decimals import PARTING
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.vendor import first_few

DELIMITERS = ("\t", ";", "|", ",")
WORD = re.compile(r"[^\W\d_]")
LISTED = 12
NUMBER = rf"[-+]?(?:(?:\d+\.?|\d*[.,]\d+)(?:[eE][-+]?\d+)?|\d{{1,3}}(?:[{PARTING}]\d{{3}})+(?:[.,]\d*)?)"
NUMBERS_AT_BLANKS = re.compile(rf" *{NUMBER}(?: +{NUMBER})+ *")
BLANKS, GAPS = re.compile("[ \t]+"), re.compile(" {2,}")
HALF_OF_DAY = re.compile(r"(?<=:\d\d)([.,]\d+)? +([ap]\.?m\.?)(?= |$)", re.IGNORECASE)
NAME_WITH_UNIT = re.compile(r"\S+(?: +[(\[][^\d()\[\]]+[)\]](?!\S))?")


@dataclass(frozen=True)
class Table:
    """Rows of cells, and where they are.

    Parameters
    ----------
    source, name
        The file, and the table's name: its sheet's, or the file's own.
    rows, numbers
        Cells, as text or as a workbook's values, and the number of each row in the file or the sheet.
    delimiter
        What parts the cells of a text, where a blank means any number of them; None in a workbook.
    """

    source: Source
    name: str
    rows: Sequence[Sequence[Any]]
    numbers: Sequence[int]
    delimiter: str | None = None

    def place(self, *rows: int) -> str:
        """Return where the first few of `rows` are, and how many more there are."""
        named = first_few([self.numbers[row] for row in rows])
        return (f"sheet {self.name}, row " if self.source.workbook else "line ") + named

    def at(self, kept: Sequence[int]) -> Table:
        """Return the table of some of its rows."""
        return replace(self, rows=[self.rows[k] for k in kept], numbers=[self.numbers[k] for k in kept])

    def body(self, header: int | None, indices: Sequence[int]) -> Table:
        """Return some columns of the rows below the header, or of all rows where there is none."""
        start = 0 if header is None else header + 1
        rows = [[row[k] if k < len(row) else "" for k in indices] for row in self.rows[start:]]
        return Table(self.source, self.name, rows, self.numbers[start:])


def tables_of(source: Source) -> list[Table]:
    """Return a workbook's sheets, or the one table of a text file.

    Lines are split at tabs, semicolons, bars or commas, whichever most of them hold more than one of, but not at the
    decimal commas of numbers between blanks; else at blanks.
    """
    if source.workbook:
        sheets = [(name, *source.placed_sheet(name)) for name in source.sheets]
        return [Table(source, name, rows, range(first, first + len(rows))) for name, first, rows in sheets]
    lines = {number: line for number, line in enumerate(source.lines, 1) if line.strip()}
    at_blanks = {
        number: len(BLANKS.split(line.strip())) for number, line in lines.items() if NUMBERS_AT_BLANKS.fullmatch(line)
    }
    for delimiter in DELIMITERS:
        holding = {number for number, line in lines.items() if line.count(delimiter) >= 2}
        if len(holding - at_blanks.keys()) > len(lines) / 2:
            split = [_cells(line, delimiter) for line in lines.values()]
            return [Table(source, source.path.stem, split, list(lines), delimiter)]
    usual = Counter(len(HALF_OF_DAY.sub(r"\1\2", line).split()) for line in lines.values())
    width = max(at_blanks.values(), default=max(usual, key=lambda count: usual[count], default=0))
    split = [_at_blanks(line, width) for line in lines.values()]
    return [Table(source, source.path.stem, split, list(lines), " ")]


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
    rows = [[cell for cell in row if isinstance(cell, str) and WORD.search(cell)] for t in tables for row in t.rows]
    names = max(rows, key=len, default=[])
    return ", ".join(names[:LISTED]) + (", ..." if len(names) > LISTED else "") if names else "none is found"
