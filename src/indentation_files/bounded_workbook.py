"""Cells of an Excel workbook, read in a process of its own whose memory and time are bounded."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from typing import Any

from indentation_files.bounded_process import BEYOND, parsed, serve


@dataclass(frozen=True)
class Workbook:
    """What a workbook holds.

    `sheets` has the rows of each sheet by its name, behind the numbers of its first row and first column that hold
    anything, from 1; `damaged` what is wrong with those that cannot be read. `hidden` names the sheets that a
    spreadsheet program does not show. `problem` says what is wrong with the whole workbook; empty where nothing is.
    """

    sheets: dict[str, tuple[int, int, list[list[Any]]]] = field(default_factory=dict)
    damaged: dict[str, str] = field(default_factory=dict)
    hidden: list[str] = field(default_factory=list)
    problem: str = ""


def read_workbook(content: bytes) -> Workbook:
    """Return what the bytes of a workbook hold."""
    found = parsed(__file__, content)
    return Workbook(problem=BEYOND) if found is None else Workbook(*found)


def _read(content: bytes) -> tuple[dict[str, tuple[int, int, list[list[Any]]]], dict[str, str], list[str], str]:
    """Return what a `Workbook` holds."""
    from python_calamine import CalamineWorkbook, SheetVisibleEnum

    sheets, damaged = {}, {}
    try:
        workbook = CalamineWorkbook.from_filelike(io.BytesIO(content))
    except MemoryError:
        raise
    except BaseException as error:  # on some damage the library panics, which is no Exception
        return {}, {}, [], str(error)
    for name in workbook.sheet_names:
        try:
            sheet = workbook.get_sheet_by_name(name)
            row, column = sheet.start or (0, 0)
            sheets[name] = row + 1, column + 1, sheet.to_python()
        except MemoryError:
            raise
        except BaseException as error:
            damaged[name] = str(error)
    hidden = [sheet.name for sheet in workbook.sheets_metadata if sheet.visible != SheetVisibleEnum.Visible]
    return sheets, damaged, hidden, ""


if __name__ == "__main__":
    serve(_read)
