"""A vendor's file, opened as bytes, as lines of text or as a workbook, whichever its reader asks for."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.errors import InputError
from palpate.readers.units import SCALES, STIFFNESS, plain

if TYPE_CHECKING:
    from python_calamine import CalamineWorkbook

WORKBOOKS = (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"PK\x03\x04")
WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
LARGEST = 1e300
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
        """Lines of text, whatever ends them; UTF-16 where it is marked, UTF-8 where that fits, Latin-1 otherwise."""
        try:
            text = self.content.decode("utf-16" if self.content.startswith(WIDE) else "utf-8-sig")
        except UnicodeDecodeError:
            text = self.content.decode("latin-1")
        return re.split(r"\r\n|\r|\n", text)

    @cached_property
    def workbook(self) -> CalamineWorkbook | None:
        """The Excel workbook, old or new, or None; raises `InputError` on one that is damaged."""
        if not self.content.startswith(WORKBOOKS):
            return None
        from python_calamine import CalamineError, CalamineWorkbook

        try:
            return CalamineWorkbook.from_filelike(io.BytesIO(self.content))
        except CalamineError as error:
            raise InputError(
                f"is no whole Excel workbook ({error})", remedy="copy or export it again", file=self.path
            ) from error

    @property
    def sheets(self) -> list[str]:
        """Names of the workbook's sheets; empty for another file."""
        return self.workbook.sheet_names if self.workbook else []

    def sheet(self, name: str) -> list[list[Any]]:
        """Return the rows of a sheet, empty for another file; raises `InputError` when it is damaged."""
        return self.placed_sheet(name)[1]

    def placed_sheet(self, name: str) -> tuple[int, list[list[Any]]]:
        """Return the rows of a sheet from the first that holds anything, and the number of that row, from 1."""
        from python_calamine import CalamineError

        if self.workbook is None:
            return 1, []
        try:
            sheet = self.workbook.get_sheet_by_name(name)
            return (sheet.start or (0, 0))[0] + 1, sheet.to_python()
        except CalamineError as error:
            raise InputError(
                f"is damaged ({error})", remedy="copy or export it again", file=self.path, place=f"sheet {name}"
            ) from error

    def columns(self, sheet: str, wanted: Mapping[str, str]) -> dict[str, np.ndarray]:
        """Return columns of a sheet whose first row holds names and whose second holds units.

        Values are in s, nm, mN and N/m; empty cells, text and the 1.8e308 that stands for "invalid" are NaN.

        Parameters
        ----------
        wanted
            For each column what it holds: ``time``, ``load``, ``depth`` or ``stiffness``.

        Raises
        ------
        InputError
            When a column is missing or has a unit that is none of what it holds.
        """
        rows = self.sheet(sheet)
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
            cells = [row[index] if isinstance(row[index], int | float) else np.nan for row in rows[2:]]
            values = np.array(cells, dtype=float)
            found[name] = known[unit] * np.where(np.abs(values) < LARGEST, values, np.nan)
        return found

    def by_test(self, sheet: str) -> dict[str, dict[str, str]]:
        """Return a sheet of results or inputs (names, units, one row a test) as text, by the number of the test."""
        if sheet not in self.sheets:
            return {}
        rows = self.sheet(sheet)
        entries = {}
        for row in rows[2:]:
            entries[_text(row[0])] = {
                f"{_text(name)} [{_text(unit)}]" if _text(unit) else _text(name): _text(cell)
                for name, unit, cell in zip(rows[0][1:], rows[1][1:], row[1:], strict=False)
                if _text(name) and _text(cell)
            }
        return entries


def _text(cell: Any) -> str:
    return f"{cell:.9g}" if isinstance(cell, float) else " ".join(str(cell).split())
