"""Why a table gives no test: what is missing in a sheet or a workbook."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Sequence

from indentation_files.bounded_process import MEMORY
from indentation_files.errors import InputError
from indentation_files.readers.column_map import ColumnMap, called, columns_of
from indentation_files.readers.headings import channel_of
from indentation_files.readers.tables import Table, header_of
from indentation_files.readers.units import CHANNELS
from indentation_files.readers.vendor import Unreadable

# cells of a program that leaves it to a spreadsheet program to reckon its formulas
FORMULA = rb"(?:</(?:\w+:)?f>|<(?:\w+:)?f\b[^>]*/>)"
NO_VALUE = rb"(?:<(?:\w+:)?v\s*/>|<(?:\w+:)?v>\s*</(?:\w+:)?v>)?"
WITHOUT_VALUE = re.compile(FORMULA + rb"\s*" + NO_VALUE + rb"\s*</(?:\w+:)?c>")


def nothing_found(tables: Sequence[Table], columns: ColumnMap) -> InputError:
    """Return the error of a file none of whose tables holds numbers in the columns."""
    unsaved = [error for table in tables if (error := _unsaved(table, columns))]
    if unsaved:
        return unsaved[0]
    named = any(not columns.names[key].isdecimal() for key in CHANNELS)
    if named and any(columns_of(table, columns) is not None for table in tables):
        return InputError(
            f"has the columns {_named(columns)}, but no row with a number in each{_row_with_digits(tables, columns)}",
            remedy="export it again, or leave it out",
            file=tables[0].source.path,
        )
    problem = f"holds no table with numbers in the columns {_named(columns)}{_row_with_digits(tables, columns)}"
    remedy = f"name columns of its header ({header_of(tables)}), or give their numbers from 1"
    return InputError(problem, remedy=remedy, file=tables[0].source.path if tables else None)


def left_out(table: Table, columns: ColumnMap) -> Unreadable | None:
    """Return what is wrong with a workbook's sheet that gave no test; None for one without a table, such as notes.

    A sheet with the columns has a table, be it empty; another has one where two rows fill three cells or more.
    """
    has_columns = columns_of(table, columns) is not None
    named = any(not columns.names[key].isdecimal() for key in CHANNELS)
    if not (has_columns and named) and sum(_filled(row) >= len(CHANNELS) for row in table.rows) < 2:
        return None
    problem = f"holds no row of numbers in the columns {_named(columns)}{_row_with_digits([table], columns)}"
    empty = InputError(problem, remedy="export it again, or name other columns for it", place=f"sheet {table.name}")
    error = _unsaved(table, columns) or (empty if has_columns else _other_header(table, columns))
    return Unreadable(table.name, error.located(file=table.source.path), sought=False)


def _unsaved(table: Table, columns: ColumnMap) -> InputError | None:
    """Return the error of columns with empty cells in a workbook whose formulas hold no values."""
    found = columns_of(table, columns)
    if found is None or not _without_values(table.source.content):
        return None
    if all(_filled(row) == len(CHANNELS) for row in table.body(*found).rows):
        return None
    problem = f"the columns {_named(columns)} hold formulas without stored values"
    remedy = "open the workbook in a spreadsheet program and save it there first"
    return InputError(problem, remedy=remedy, file=table.source.path, place=f"sheet {table.name}")


def _other_header(table: Table, columns: ColumnMap) -> InputError:
    """Return the error of a sheet whose header lacks some of the columns."""
    rows = [{called(cell) for cell in row} for row in table.rows]
    wanted = [columns.names[key] for key in CHANNELS]
    absent = min(([name for name in wanted if called(name) not in row] for row in rows), key=len)
    named = max(len({channel_of(cell) for cell in row if isinstance(cell, str)} & {*CHANNELS}) for row in table.rows)
    remedy = "it is no test, unless it holds these under other names"
    if named == len(CHANNELS):
        remedy = f"if it is a test, read it in a call of its own by its own names ({header_of([table])})"
    return InputError(
        f"has no column{'s' if len(absent) > 1 else ''} {', '.join(absent)}", remedy=remedy, place=f"sheet {table.name}"
    )


def _named(columns: ColumnMap) -> str:
    return ", ".join(columns.names[key] for key in CHANNELS)


def _filled(row: Sequence[object]) -> int:
    return sum(bool(str(cell).strip()) for cell in row)


def _row_with_digits(tables: Sequence[Table], columns: ColumnMap) -> str:
    """Return, for a message, the first row with digits of a table that has the columns but no numbers in them."""
    for table in tables:
        found = columns_of(table, columns)
        body = table.body(*found) if found else None
        for k, row in enumerate(body.rows if body else ()):
            cells = ", ".join(str(cell) for cell in row)
            if body and all(map(str, row)) and re.search(r"\d", cells):
                return f" ({body.place(k)}: {cells!r})"
    return ""


def _without_values(content: bytes) -> bool:
    """Return whether a sheet of the workbook holds a cell with a formula and no value, which reads as empty."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            small = [member.filename for member in archive.infolist() if member.file_size <= MEMORY]
            sheets = [name for name in small if re.fullmatch(r"xl/worksheets/\w+\.xml", name)]
            return any(WITHOUT_VALUE.search(archive.read(name)) for name in sheets)
    except zipfile.BadZipFile:
        return False
