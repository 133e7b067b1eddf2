"""Numbers in instruments' text files: decimal comma or point, tabs between columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate.errors import InputError


def number(cell: str) -> float:
    """Return the number in `cell`, written with a decimal comma or point; an empty cell is NaN."""
    cell = cell.strip()
    return float(cell.replace(",", ".")) if cell else float("nan")


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
