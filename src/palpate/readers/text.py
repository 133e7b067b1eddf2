"""Numbers in instruments' text files: decimal comma or point, tabs between columns."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.readers.decimals import LARGEST


def number(cell: str) -> float:
    """Return the number in `cell`, written with a decimal comma or point; NaN for an empty cell and for "invalid"."""
    cell = cell.strip()
    value = float(cell.replace(",", ".")) if cell else float("nan")
    return value if abs(value) <= LARGEST else float("nan")


def table(lines: list[str], first_line: int, columns: int, path: Path) -> np.ndarray:
    """Return tab-separated numbers (n, columns); blank lines are passed over.

    Parameters
    ----------
    first_line
        Number of the first of `lines` in the file, for messages.
    """
    rows = []
    for number_of_line, line in enumerate(lines, first_line):
        if not line.strip():
            continue
        cells = line.rstrip("\r\n").split("\t")
        try:
            row = [number(cell) for cell in cells[:columns]]
        except ValueError as error:
            raise InputError(
                f"{line.strip()[:40]!r} is not a row of numbers",
                remedy="export the test again",
                file=path,
                place=f"line {number_of_line}",
            ) from error
        if len(row) < columns:
            raise InputError(
                f"{len(row)} columns where {columns} were announced; the file is cut off",
                remedy="export the test again",
                file=path,
                place=f"line {number_of_line}",
            )
        rows.append(row)
    if not rows:
        raise InputError("holds no measured values", remedy="export the test again", file=path)
    return np.array(rows)


def counted(lines: list[str], first_line: int, columns: int, path: Path, announced: str) -> np.ndarray:
    """Return a `table` that has as many rows as the file's header announces, as ``5304`` or ``5,304``."""
    count = re.sub(r"(?<=\d)[,.](?=\d{3})", "", announced.strip())
    if not count.isdecimal():
        raise InputError(
            f"announces {announced.strip()[:40]!r} points, expected a whole number",
            remedy="copy or export it again",
            file=path,
        )
    values = table(lines, first_line, columns, path)
    if len(values) != int(count):
        raise InputError(
            f"holds {len(values)} points, {int(count)} were announced; the file is cut off",
            remedy="copy or export it again",
            file=path,
        )
    return values
