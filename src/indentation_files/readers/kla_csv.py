"""A test of KLA's InView exported as CSV: the columns, the row of units and the markers of a workbook's sheet.

A spreadsheet program may have written it anew, with semicolons or tabs between the columns and decimal commas.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from indentation_files.bounded_process import Workbook
from indentation_files.readers import kla
from indentation_files.readers.sheets_of_tests import MARKERS, names_among
from indentation_files.readers.source import Source
from indentation_files.readers.units import unit_of
from indentation_files.readers.vendor import Reader, VendorTest

HEAD = 2  # rows of names and of units
SEPARATORS = ",;\t"
DECIMAL_COMMA = re.compile(r"\A(\s*[-+]?\d*),(\d+(?:[eE][-+]?\d+)?\s*)\Z")
RESULTS = {"modulus", "hardness"}  # columns by which a table without a marker is KLA's


@dataclass(frozen=True)
class AsSheet(Source):
    """A text of comma-separated values as a workbook with one sheet, called like the file."""

    @cached_property
    def _cells(self) -> Workbook:
        """The cells, each row as long as the row of names."""
        rows = _rows(self.lines)
        width = len(rows[0]) if rows else 0
        return Workbook(sheets={self.path.stem: (1, 1, [[*row, *[""] * width][:width] for row in rows])})


def matches(source: Source) -> bool:
    """Return whether the first line names a marker, or results, and a test's channels, and the second their units."""
    head = [] if source.workbook else _rows(source.lines[:HEAD])
    if len(head) < HEAD or len(head[0]) != len(head[1]):
        return False
    names = [cell.strip().casefold() for cell in head[0]]
    if not any(marker in names for marker in MARKERS) and not set(names) >= RESULTS:
        return False
    units = dict(zip(names, head[1], strict=True))
    found = names_among(names, kla.CHANNELS)
    return bool(found) and all(unit_of(key, units[name].strip()) for key, name in found.items())


def _rows(lines: Iterable[str]) -> list[list[str]]:
    """Return the rows of cells that are not empty, parted by the sign that most often stands in the first line."""
    lines = list(lines)
    sign = max(SEPARATORS, key=lines[0].count) if lines else ","
    rows = [row for row in csv.reader(iter(lines), delimiter=sign) if row]
    return rows if sign == "," else [[DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in row] for row in rows]


def read(source: Source) -> list[VendorTest]:
    """Read the one test."""
    return [kla.test_on_sheet(AsSheet(source.path, source.stream), source.path.stem, {})]


READER = Reader("kla_csv", "KLA CSV", matches, read)
