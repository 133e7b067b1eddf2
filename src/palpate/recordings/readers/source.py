"""A vendor's file, opened as bytes, as lines of text or as a workbook, whichever its reader asks for."""

from __future__ import annotations

import codecs
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.bounded_workbook import Workbook, read_workbook
from palpate.errors import InputError
from palpate.recordings.readers.decimals import numbers
from palpate.recordings.readers.units import SCALES, STIFFNESS, plain

WORKBOOKS = (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"PK\x03\x04")
TEST = re.compile(r"Test (\d+)\b")
PADDING = "\0\x1a"
WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
UNITS = {**SCALES, "stiffness": STIFFNESS}


@dataclass(frozen=True)
class Source:
    """A vendor's file.

    Parameters
    ----------
    path
        Where it lies; its ending means nothing.
    content
        Its bytes.
    """

    path: Path
    content: bytes = field(repr=False)

    @cached_property
    def lines(self) -> list[str]:
        """Lines of text, whatever ends them; a workbook has none.

        UTF-16 where it is marked or every other byte is zero, UTF-8 where that fits, Latin-1 otherwise. What pads the
        end of the file (zero bytes, DOS's end of text) is dropped.
        """
        if self.content.startswith(WORKBOOKS):
            return []
        try:
            text = self.content.decode(self._encoding)
        except UnicodeDecodeError:
            text = self.content.decode("latin-1")
        return re.split(r"\r\n|\r|\n", text.rstrip(PADDING))

    @property
    def _encoding(self) -> str:
        """The encoding that the first bytes speak for."""
        if self.content.startswith(WIDE):
            return "utf-16"
        first, second, third, fourth = self.content[:4].ljust(4, b"x")
        if first and third and not second and not fourth:
            return "utf-16-le"
        if second and fourth and not first and not third:
            return "utf-16-be"
        return "utf-8-sig"

    @property
    def first(self) -> str:
        """The first line that holds more than blanks; empty where there is none."""
        return next((line.strip() for line in self.lines if line.strip()), "")

    @property
    def workbook(self) -> bool:
        """Whether the file is an Excel workbook, old or new, by its first bytes."""
        return self.content.startswith(WORKBOOKS)

    @property
    def sheets(self) -> list[str]:
        """Names of the workbook's sheets; empty for another file; raises `InputError` on one that is damaged."""
        return [*self._cells.sheets, *self._cells.damaged]

    @property
    def tests(self) -> dict[str, str]:
        """Names of the sheets ``Test 001``, in the order of their numbers, each with its number as ``1``."""
        numbers = {name: number for name in self.sheets if (number := number_of(name)) is not None}
        return {name: str(number) for name, number in sorted(numbers.items(), key=lambda item: item[1])}

    def has_test_with(self, wanted: set[str]) -> bool:
        """Return whether a sheet of a test names all columns `wanted` in its first row."""
        return any(
            wanted <= {str(cell).strip() for cell in rows[0]} for name in self.tests if (rows := self.sheet(name))
        )

    def sheet(self, name: str) -> list[list[Any]]:
        """Return the rows of a sheet, empty for another file; raises `InputError` when it is damaged."""
        return self.placed_sheet(name)[1]

    def placed_sheet(self, name: str) -> tuple[int, list[list[Any]]]:
        """Return the rows of a sheet from the first that holds anything, and the number of that row, from 1."""
        if name in self._cells.damaged:
            raise InputError(
                f"is damaged ({self._cells.damaged[name]})", remedy="copy or export it again", file=self.path,
                place=f"sheet {name}",
            )  # fmt: skip
        return self._cells.sheets.get(name, (1, []))

    @cached_property
    def _cells(self) -> Workbook:
        """The cells of all sheets; raises `InputError` on a workbook that is damaged."""
        found = read_workbook(self.content) if self.workbook else Workbook()
        if found.problem:
            problem = f"is no whole Excel workbook ({found.problem})"
            raise InputError(problem, remedy="copy or export it again, or as text", file=self.path)
        return found

    def columns(self, sheet: str, wanted: Mapping[str, str]) -> dict[str, np.ndarray]:
        """Return columns of a sheet whose first row holds names and whose second holds units.

        Values are in s, nm, mN and N/m, be they numbers or text; empty cells, words and the 1.8e308 that stands for
        "invalid" are NaN.

        Parameters
        ----------
        wanted
            For each column what it holds: ``time``, ``load``, ``depth`` or ``stiffness``.

        Raises
        ------
        InputError
            When a column is missing or has a unit that is none of what it holds.
        """
        first, rows = self.placed_sheet(sheet)
        names = [str(cell).strip() for cell in rows[0]] if rows else []
        found = {}
        for name, quantity in wanted.items():
            if name not in names or len(rows) < 3:
                raise InputError(
                    f"lacks the column {name!r} or its values", remedy="export it too", file=self.path,
                    place=f"sheet {sheet}",
                )  # fmt: skip
            index = names.index(name)
            unit, known = plain(str(rows[1][index])), UNITS[quantity]
            if unit not in known:
                raise InputError(
                    f"{name} is in {unit!r}", remedy=f"export it in one of: {', '.join(known)}", file=self.path,
                    place=f"sheet {sheet}",
                )  # fmt: skip
            cells = [[row[index]] for row in rows[2:]]
            (values,) = numbers(cells, lambda row: f"sheet {sheet}, row {first + 2 + row}").T
            found[name] = known[unit] * np.where(np.isfinite(values), values, np.nan)
        return found

    def by_test(self, sheet: str) -> dict[str, dict[str, str]]:
        """Return a sheet of results or inputs (names, units, one row a test) as text, by the number of the test."""
        if sheet not in self.sheets:
            return {}
        rows = self.sheet(sheet)
        names = _headings(rows[0][1:]) if rows else []
        entries = {}
        for row in rows[2:]:
            entries[_text(row[0])] = {
                f"{name} [{_text(unit)}]" if _text(unit) else name: _text(cell)
                for name, unit, cell in zip(names, rows[1][1:], row[1:], strict=False)
                if name and _text(cell)
            }
        return entries


def number_of(name: str) -> int | None:
    """Return the number of a sheet such as ``Test 010``, or None for another name."""
    found = TEST.match(name)
    return int(found[1]) if found else None


def _headings(cells: Sequence[Any]) -> list[str]:
    """Return headings as text; one that the vendor tore at a comma, ``On? (1-Y`` and ``0-N)``, counts as one."""
    headings: list[str] = []
    for text in map(_text, cells):
        if headings and "(" in headings[-1].rpartition(")")[2] and ")" in text.partition("(")[0]:
            headings[-1] += f", {text}"
        else:
            headings.append(text)
    return headings


def _text(cell: Any) -> str:
    return f"{cell:.9g}" if isinstance(cell, float) else " ".join(str(cell).split())
