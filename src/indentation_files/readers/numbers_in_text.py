"""Numbers in instruments' text files: decimal comma or point, tabs between columns."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.decimals import LARGEST, numbers
from indentation_files.readers.headings import is_word
from indentation_files.readers.lines import Lines
from indentation_files.readers.plain_numbers import plain_numbers


def number(cell: str) -> float:
    """Return the number in `cell`, written with a decimal comma or point; NaN for no number and for "invalid"."""
    try:
        value = float(cell.strip().replace(",", "."))
    except ValueError:
        return math.nan
    return value if abs(value) <= LARGEST else math.nan


def require_tabs(headings: str) -> None:
    """Raise `InputError` on a line of headings without tabs: another program has saved the vendor's file anew."""
    if "\t" not in headings:
        remedy = "export it again with tabs, or name its columns (--columns time=...,load=...,depth=...)"
        raise InputError(f"has no tabs between its columns {headings.strip()[:40]!r}: it was saved anew", remedy=remedy)


def table(lines: Lines, columns: int, delimiter: str = "\t") -> np.ndarray:
    """Return the numbers (n, columns) in lines; NaN for empty cells and "invalid"; blank lines are passed over.

    The table has one decimal sign, as `numbers` finds it; the other one may part thousands: ``1,001.9436``. A blank as
    the `delimiter` of cells means any number of blanks and tabs. Raises `InputError` when a cell is no number, a row is
    too short, there is none, or a point and a comma are equally likely to be the decimal sign.
    """
    found = plain_numbers(lines, delimiter)
    if found and len(found[0]) >= columns:
        values = found[0].T
    else:
        values = _one_by_one(lines, columns, delimiter)
    values[~np.isfinite(values)] = np.nan
    return values[:, :columns]


def column(values: np.ndarray, place: int, factor: float) -> np.ndarray:
    """Return the column at a place of a table's `values`, multiplied in place: a long one is not copied."""
    found: np.ndarray = values[:, place]
    found *= factor
    return found


def _one_by_one(lines: Lines, columns: int, delimiter: str) -> np.ndarray:
    """Return the numbers of a `table`, infinite for empty cells and for "invalid"."""
    filled = {f"line {place}": line for place, line in enumerate(lines.one_by_one(), lines.first) if line.strip()}
    if not filled:
        raise InputError("holds no measured values", remedy="export the test again")
    rows = [line.split(None if delimiter == " " else delimiter)[:columns] for line in filled.values()]
    places = list(filled)
    short = next((k for k, row in enumerate(rows) if len(row) < columns), len(rows))
    values = numbers(rows[:short], lambda row: places[row])
    words = [int(k) for k in np.flatnonzero(np.isnan(values).any(axis=1))]
    if short < len(rows) and any(map(is_word, rows[short])):
        words.append(short)
    if words:
        problem = f"{filled[places[words[0]]].strip()[:40]!r} is not a row of numbers"
        remedy = "export each test to a file of its own, or name its columns (--columns time=...,load=...,depth=...)"
        raise InputError(problem, remedy=remedy, place=places[words[0]])
    if short < len(rows):
        problem = f"{len(rows[short])} columns where {columns} were announced; the file is cut off"
        raise InputError(problem, remedy="export the test again", place=places[short])
    return values


def refuse_unlike(headings: str, known: Callable[[str], Iterable[str]], values: np.ndarray) -> None:
    """Raise `InputError` where a line of headings names one channel twice, with other `values` (n, k) below.

    `known` gives the channel that a heading names; empty for another.
    """
    first: dict[str, int] = {}
    cells = headings.rstrip().split("\t")
    for k, heading in enumerate(cells):
        for channel in known(heading):
            before = first.setdefault(channel, k)
            if not np.array_equal(values[:, before], values[:, k], equal_nan=True):
                names = [" ".join(cell.split()) for cell in (cells[before], heading)]
                raise several_of(" or ".join(dict.fromkeys(names)))


def several_of(name: str) -> InputError:
    """Return the error of a file in which several columns with different numbers have the same name."""
    remedy = "give the columns by their numbers, from 1 (--columns time=...,load=...,depth=...)"
    return InputError(f"several columns are called {name!r}", remedy=remedy)


def counted(lines: Lines, columns: int, announced: str) -> np.ndarray:
    """Return a `table` that has as many rows as the file's header announces, as ``5304`` or ``5,304``."""
    count = re.sub(r"(?<=\d)[,.](?=\d{3})", "", announced.strip())
    if not count.isdecimal():
        problem = f"announces {announced.strip()[:40]!r} points, expected a whole number"
        raise InputError(problem, remedy="copy or export it again")
    values = table(lines, columns)
    if len(values) != int(count):
        odd = "the file is cut off" if len(values) < int(count) else "more than one test may be in it"
        problem = f"holds {len(values)} points, {int(count)} were announced; {odd}"
        raise InputError(problem, remedy="copy or export it again")
    return values
