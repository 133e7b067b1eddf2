"""Numbers of a table whose decimal sign nobody states: a point or a comma; the other one may part thousands.

So may a blank, narrow, thin or any other, and an apostrophe, straight or curved. The sign of a negative number may be
a minus of Unicode's.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from indentation_files.errors import InputError

LARGEST = 1e20  # in any unit; instruments write 9.91e37 for a missing value (SCPI-1999), others 1e31 or 1e300
MISSING = ("", "nan", "-nan", "inf", "-inf")
OTHER = {".": ",", ",": "."}
THOUSANDS = {sign: re.compile(rf"[-+−]?[1-9]\d{{0,2}}[{other}]\d{{3}}") for sign, other in OTHER.items()}
PARTING = "'\u2019\x92\u2009\u202f\xa0"  # the third is the second of Windows-1252, read as Latin-1
WRITTEN = {
    sign: re.compile(
        rf"[-+−]?(?:(?:\d+[{sign}]?\d*|[{sign}]\d+)(?:[eE][-+]?\d+)?"
        rf"|[1-9]\d{{0,2}}([{other}{PARTING} ])\d{{3}}(?:\1\d{{3}})*(?:[{sign}]\d*)?)"
    )
    for sign, other in OTHER.items()
}


def numbers(rows: Sequence[Sequence[Any]], place: Callable[[int], str], sign: str = "") -> np.ndarray:
    """Return the numbers in `rows` of as many cells each (n, k): NaN for text, infinite for an empty or invalid cell.

    ``1,143.74``, ``1.143,74`` and ``1'143.74`` are one number; ``1,200`` may be two. The sign that makes numbers of
    more of the table's cells is its decimal sign, unless other rows of the table show it (`sign`). ``nan``, ``inf`` and
    numbers beyond 1e20 mean "invalid". A column whose every cell has three digits behind the other sign may hold
    fractions.

    Raises `InputError`, with the `place` of a row in the file, when a point and a comma make numbers of as many cells,
    but not the same numbers, or of a whole column.
    """
    if sign:
        return _by_sign(rows, sign)
    point, comma = (_by_sign(rows, sign) for sign in OTHER)
    more = int(np.isfinite(point).sum()) - int(np.isfinite(comma).sum())
    differ = (point != comma) & (np.isfinite(point) | np.isfinite(comma))
    if more == 0 and differ.any():
        row, column = np.argwhere(differ)[0].tolist()
        raise _unclear(row, column, rows, place)
    sign, found = (".", point) if more >= 0 else (",", comma)
    for column in np.flatnonzero(differ.any(axis=0)).tolist():
        filled = np.flatnonzero(np.isfinite(found[:, column])).tolist()
        if all(THOUSANDS[sign].fullmatch(str(rows[row][column]).strip()) for row in filled):
            raise _unclear(filled[0], column, rows, place)
    return found


def _unclear(row: int, column: int, rows: Sequence[Sequence[Any]], place: Callable[[int], str]) -> InputError:
    """Return the error of a cell whose sign may be the decimal one."""
    problem = f"{rows[row][column]!r} has a decimal sign or parts thousands, the table does not show which"
    remedy = "export the numbers without separators of thousands, or with other than three decimals"
    return InputError(problem, remedy=remedy, place=place(row))


def _by_sign(rows: Sequence[Sequence[Any]], sign: str) -> np.ndarray:
    """Return the numbers in `rows` of as many cells each by a decimal `sign`."""
    return np.array([[_number(cell, sign) for cell in row] for row in rows]).reshape(len(rows), -1)


def _number(cell: Any, sign: str) -> float:
    """Return a cell's number by a decimal `sign`, NaN for text, infinity for a cell that is empty or invalid."""
    if isinstance(cell, int | float) and not isinstance(cell, bool):
        value = float(cell)
    else:
        text = str(cell).strip()
        if text.lower() in MISSING:
            return np.inf
        written = WRITTEN[sign].fullmatch(text)
        if not written:
            return np.nan
        value = float(text.replace(written[1] or "", "").replace(sign, ".").replace("−", "-"))
    return value if abs(value) <= LARGEST else np.inf
