"""Anton Paar column exports, as text or in a workbook: tests side by side, a time before each channel or for all.

Where the columns are called ``Time [s]``, ``Pd [nm]``, ``Fn [mN]`` alone, the table is one test.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.decimals import numbers
from indentation_files.readers.numbers_in_text import require_tabs, table
from indentation_files.readers.source import Source
from indentation_files.readers.units import scale
from indentation_files.readers.vendor import (
    Reader,
    Unreadable,
    VendorTest,
    read_or_report,
    unfinished,
    usable,
    vendor_test,
)

NAMES = {  # in English, French and German
    "time": ("Time", "Temps", "Zeit"),
    "load": ("Fn", "Normal force", "Force normale", "Force", "Normalkraft", "Kraft"),
    "depth": ("Pd", "Penetration depth", "Profondeur de pénétration", "Profondeur", "Eindringtiefe"),
}
KEYS = {name.casefold(): key for key, names in NAMES.items() for name in names}
HEADING = re.compile(
    rf"(?:[XY]_(.+?)[_ ]+)?({'|'.join(KEYS).replace(' ', '[ _]')})[_ ]*[\[({{<](.+)[\])}}>]", re.IGNORECASE
)
GAP = 10
HEAD = 10  # rows of a sheet in which its headings are sought
Series = tuple[np.ndarray, np.ndarray]
Columns = Sequence[tuple[str, np.ndarray]]


def matches(source: Source) -> bool:
    """Return whether the first line, or a row on a sheet, names columns X_..._Time_[s], Y_..._Fn_[mN]."""
    return (
        _names(source.first.split("\t"))
        or (source.first.startswith("X_") and "_Time_[" in source.first)
        or any(_header(source, sheet) is not None for sheet in source.sheets)
    )


def read(source: Source) -> list[VendorTest | Unreadable]:
    """Read all tests; depth is brought to the times of the load.

    A channel's time is the only one, or the last one named before it. The instrument writes the last point of a segment
    again as the first of the next; the repetition is dropped. Sheets of a workbook with another table come last, with
    what is wrong with them.
    """
    if not source.workbook:
        return _tests(source, "", _of_text(source))
    found = {sheet: read_or_report(source.path, sheet, _of_sheet, source, sheet) for sheet in source.sheets}
    tests: list[VendorTest | Unreadable] = []
    for sheet, columns in found.items():
        if not isinstance(columns, Unreadable):
            tests += _tests(source, sheet, columns, {test.name for test in tests})
    others = [replace(columns, sought=False) for columns in found.values() if isinstance(columns, Unreadable)]
    return [*tests, *(sheet for sheet in others if source.sheet(sheet.name))]


def _tests(source: Source, sheet: str, columns: Columns, known: Collection[str] = ()) -> list[VendorTest | Unreadable]:
    """Return the tests in columns, each with its heading; the sheet's name comes before a test's that is `known`."""
    headed = [(found, values) for heading, values in columns if (found := HEADING.fullmatch(heading.strip()))]
    for found, values in headed:
        values *= scale(key_of(found), found[3])
    channels = [(key_of(found), found[1] or sheet or source.path.stem, values) for found, values in headed]
    times = [values for key, _, values in channels if key == "time"]
    time = times[0] if len(times) == 1 else np.full(len(columns[0][1]), np.nan)
    tests: dict[str, dict[str, list[Series]]] = {}
    for key, name, values in channels:
        if key == "time":
            time = values
        else:
            tests.setdefault(name, {"load": [], "depth": []})[key].append((time, values))
    named = {f"{sheet} {name}" if name in known else name: both for name, both in tests.items()}
    return [
        read_or_report(source.path, name, _test, source, name, both["load"], both["depth"])
        for name, both in named.items()
    ]


def key_of(heading: re.Match[str]) -> str:
    """Return the channel that a heading names."""
    return KEYS[heading[2].casefold().replace("_", " ")]


def _names(cells: Sequence[Any]) -> bool:
    """Return whether cells name the time and the other channels of a test, one of them where it is called by name."""
    found = [named for cell in cells if (named := HEADING.fullmatch(str(cell).strip()))]
    keys = {key_of(named) for named in found}
    return "time" in keys and len(keys) > (1 if any(named[1] for named in found) else 2)


def _header(source: Source, sheet: str) -> int | None:
    """Return the row of a sheet that names the columns of tests; None where none does."""
    return next((k for k, row in enumerate(source.sheet(sheet)[:HEAD]) if _names(row)), None)


def _of_text(source: Source) -> Columns:
    """Return the columns of a text file, each with its heading."""
    require_tabs(source.first)
    start = next(k for k, line in enumerate(source.lines) if line.strip())
    headings = source.lines[start].rstrip().split("\t")
    values = table(source.lines[start + 1 :], len(headings))
    return list(zip(headings, values.T, strict=True))


def _of_sheet(source: Source, sheet: str) -> Columns:
    """Return the columns of a workbook's sheet, each with its heading."""
    header = _header(source, sheet)
    if header is None:
        raise InputError(
            "has no columns X_..._Time_[s], Y_..._Fn_[mN]", remedy="read it by --columns, if it holds tests"
        )
    first, rows = source.placed_sheet(sheet)
    names = [str(cell) for cell in rows[header]]
    wanted = [k for k, name in enumerate(names) if HEADING.fullmatch(name.strip())]
    cells = [[row[k] for k in wanted] for row in rows[header + 1 :]]
    if not cells:
        raise InputError("holds no measured values", remedy="export the test again")
    values = numbers(cells, lambda row: f"sheet {sheet}, row {first + header + 1 + row}")
    words = np.argwhere(np.isnan(values))
    if len(words):
        row, column = (int(k) for k in words[0])
        raise InputError(
            f"{str(cells[row][column])[:40]!r} is no number", remedy="export the test again",
            place=f"sheet {sheet}, row {first + header + 1 + row}",
        )  # fmt: skip
    return list(zip((names[k] for k in wanted), np.where(np.isfinite(values), values, np.nan).T, strict=True))


def _test(source: Source, name: str, load: list[Series], depth: list[Series]) -> VendorTest:
    """Return the test of a name, from its one column of load and its one column of depth."""
    warnings: list[str] = []
    clean: list[Series] = []
    for key, found in (("load", load), ("depth", depth)):
        if len(found) != 1:
            problem = f"has {len(found)} columns of {key}"
            raise InputError(problem, remedy="export both channels once, under a name of its own for each test")
        kept, messages = usable(f"{name}, {key}", *found[0])
        warnings += [f"{key}: {message}" for message in messages]
        clean.append((found[0][0][kept], found[0][1][kept]))
    (time, force), (moments, path) = clean
    common = _common(time, moments)
    if not common.all():
        warnings.append(f"{(~common).sum()} of {len(time)} points of the load left out: the depth has none there")
    time, force = time[common], force[common]
    channels = time, force, np.interp(time, moments, path)
    return vendor_test(source, name, channels, {}, (*warnings, *unfinished(force)))


def _common(time: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """Return which times of the load (n,) lie within the depth's (m,).

    Raises `InputError` when fewer than two do, or many more than elsewhere lie between two points of the depth.
    """
    rounding = 1e-9 * np.ptp(time)
    common = (time > moments[0] - rounding) & (time < moments[-1] + rounding)
    if common.sum() < 2:
        raise InputError("load and depth have no time in common", remedy="export the test again")
    between = np.bincount(np.searchsorted(moments, time[common] - rounding), minlength=len(moments))
    widest = int(np.argmax(between))
    if between[widest] > GAP * max(1.0, float(np.median(between))):
        raise InputError(
            f"the depth has no point from {moments[widest - 1]:.5g} to {moments[widest]:.5g} s, the load has "
            f"{between[widest]}",
            remedy="export the test again",
        )
    return common


READER = Reader("anton_paar_columns", "Anton Paar export in columns", matches, read)
