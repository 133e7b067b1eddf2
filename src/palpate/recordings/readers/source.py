"""A vendor's file, opened as bytes, as lines of text or as a workbook, whichever its reader asks for."""

from __future__ import annotations

import codecs
import io
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.decimals import numbers
from palpate.recordings.readers.units import SCALES, STIFFNESS, plain

if TYPE_CHECKING:
    from python_calamine import CalamineWorkbook

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

    @cached_property
    def workbook(self) -> CalamineWorkbook | None:
        """The Excel workbook, old or new, or None; raises `InputError` on one that is damaged."""
        if not self.content.startswith(WORKBOOKS):
            return None
        from python_calamine import CalamineWorkbook

        with self._opened("is no whole Excel workbook"):
            return CalamineWorkbook.from_filelike(io.BytesIO(self.content))

    @property
    def sheets(self) -> list[str]:
        """Names of the workbook's sheets; empty for another file."""
        return self.workbook.sheet_names if self.workbook else []

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
        if self.workbook is None:
            return 1, []
        if name not in self._opened_sheets:
            with self._opened("is damaged", f"sheet {name}"):
                sheet = self.workbook.get_sheet_by_name(name)
                self._opened_sheets[name] = (sheet.start or (0, 0))[0] + 1, sheet.to_python()
        return self._opened_sheets[name]

    @cached_property
    def _opened_sheets(self) -> dict[str, tuple[int, list[list[Any]]]]:
        """What `placed_sheet` has read, which takes a while."""
        return {}

    @contextmanager
    def _opened(self, problem: str, place: str | None = None) -> Iterator[None]:
        """Turn what the library says of a damaged workbook into one `InputError`.

        On some damage it panics: it writes to the process's standard error by itself, which is closed to it meanwhile,
        and raises what is no `Exception`.
        """
        from python_calamine import CalamineError

        standard_error = os.dup(2)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        try:
            yield
        except BaseException as error:
            if not isinstance(error, CalamineError) and type(error).__name__ != "PanicException":
                raise
            raise InputError(
                f"{problem} ({error})", remedy="copy or export it again", file=self.path, place=place
            ) from error
        finally:
            os.dup2(standard_error, 2)
            os.close(standard_error)
            os.close(nowhere)

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
