"""Rows of nothing but numbers, read by columns: most of what a long text holds.

Numbers that are written with a sign between their thousands, and whatever else may mean one, are none here: such rows
are read one by one (`indentation_files.readers.decimals`), as are those whose decimal sign only other rows show.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from indentation_files.readers.decimals import LARGEST, MISSING, OTHER, WRITTEN
from indentation_files.readers.lines import Lines

SHORT = 20_000  # bytes, below which rows are read one by one as fast
SHOWN = 1000  # rows, at most, that show the decimal sign
NO_NUMBER = [form for text in MISSING for form in {text, text.upper(), text.title(), text.replace("nan", "NaN")}]


def is_long(lines: Lines) -> bool:
    """Return whether lines are so long together that reading them by columns is faster."""
    return bool(lines.starts[-1] - lines.starts[0] >= SHORT)


def plain_numbers(lines: Lines, delimiter: str, room: tuple[int, int] = (0, 0)) -> tuple[np.ndarray, str] | None:
    """Return the numbers (k, n) of many lines of k cells, infinite where one is empty or invalid, and the decimal sign.

    The sign is empty where no cell needs one. None where a line holds anything else, or other than k cells, where
    nothing shows the decimal sign, or of a few lines. Empty lines are passed over. A blank as the `delimiter` means any
    number of blanks and tabs. For as many rows as `room` has before and after, numbers are infinite for others to fill
    in.
    """
    if not is_long(lines):
        return None
    first = next((line for line in itertools.islice(map(lines.__getitem__, range(len(lines))), SHOWN) if line), "")
    sign = _decimal_sign(lines, delimiter)
    if sign is None or not first:
        return None
    width = len(first.split() if delimiter == " " else first.split(delimiter))
    values = np.empty((width, sum(room) + len(lines)))
    values[:, : room[0]] = np.inf
    count = room[0]
    for begin, end in lines.blocks():
        columns = _columns(lines.written(begin, end), delimiter, sign, width)
        if columns is None:
            return None
        for k, column in enumerate(columns):
            values[k, count : count + len(column)] = column
        count += len(columns[0])
    values[:, count : count + room[1]] = np.inf
    return values[:, : count + room[1]], sign


def _columns(text: bytes, delimiter: str, sign: str, width: int) -> list[np.ndarray] | None:
    """Return the columns (n,) of numbers in whole lines of `text`; None where they hold anything else."""
    import pyarrow as pa
    from pyarrow import csv

    if delimiter == " ":
        text = _parted_by_one_blank(text)
    names = [str(k) for k in range(width)]
    types: dict[str, Any] = dict.fromkeys(names, pa.float64())
    try:
        found = csv.read_csv(
            pa.BufferReader(text),
            csv.ReadOptions(use_threads=False, column_names=names, block_size=len(text) + 1),
            csv.ParseOptions(delimiter=delimiter, quote_char=False),
            csv.ConvertOptions(column_types=types, null_values=NO_NUMBER, decimal_point=sign or "."),
        )
    except pa.ArrowInvalid:
        return None
    columns = [column.to_numpy() for column in found.columns]
    empty = [~np.isfinite(column) for column in columns]
    if np.all(empty, axis=0).any() or sum(map(np.sum, empty)) > sum(column.null_count for column in found.columns):
        return None
    with np.errstate(invalid="ignore"):
        return [np.where(np.abs(column) <= LARGEST, column, np.inf) for column in columns]


def _parted_by_one_blank(text: bytes) -> bytes:
    """Return lines whose cells any number of blanks and tabs part, with one blank for these, and none at their ends."""
    text = text.replace(b"\t", b" ")
    while b"  " in text:
        text = text.replace(b"  ", b" ")
    for ending in (b"\r", b"\n"):
        text = text.replace(b" " + ending, ending).replace(ending + b" ", ending)
    return text.strip(b" ")


def _decimal_sign(lines: Lines, delimiter: str) -> str | None:
    """Return the decimal sign that lines show beyond doubt, empty where no cell needs one; None for doubt."""
    signs = [sign for sign in OTHER if sign != delimiter]
    for line in itertools.islice(map(lines.__getitem__, range(len(lines))), SHOWN):
        for cell in line.split() if delimiter == " " else line.split(delimiter):
            for sign in signs:
                if sign in cell and not WRITTEN[OTHER[sign]].fullmatch(cell.strip()):
                    return sign
    written = any(sign.encode() in lines.written(*ends) for ends in lines.blocks() for sign in signs)
    return None if written else ""
