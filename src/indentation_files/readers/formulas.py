"""Formulas of an Excel workbook: a program that only writes them leaves it to a spreadsheet program to reckon them."""

from __future__ import annotations

import io
import re
import zipfile

from indentation_files.bounded_process import MEMORY

FORMULA = rb"(?:</(?:\w+:)?f>|<(?:\w+:)?f\b[^>]*/>)"
NO_VALUE = rb"(?:<(?:\w+:)?v\s*/>|<(?:\w+:)?v>\s*</(?:\w+:)?v>)?"
WITHOUT_VALUE = re.compile(FORMULA + rb"\s*" + NO_VALUE + rb"\s*</(?:\w+:)?c>")


def without_values(content: bytes) -> bool:
    """Return whether a sheet of the workbook holds a cell with a formula and no value, which reads as empty."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            small = [member.filename for member in archive.infolist() if member.file_size <= MEMORY]
            sheets = [name for name in small if re.fullmatch(r"xl/worksheets/\w+\.xml", name)]
            return any(WITHOUT_VALUE.search(archive.read(name)) for name in sheets)
    except zipfile.BadZipFile:
        return False
