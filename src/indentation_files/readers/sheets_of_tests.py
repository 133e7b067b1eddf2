"""Workbooks with a sheet for each test: names in the first row, units beside them or in the second, then numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.decimals import numbers
from indentation_files.readers.headings import BRACKETED, is_word
from indentation_files.readers.numbers_in_text import several_of
from indentation_files.readers.source import Source, number_of
from indentation_files.readers.units import SCALES, STIFFNESS, plain, unit_of
from indentation_files.readers.vendor import Unreadable, VendorTest, read_or_report

MARKERS = ("markers", "marker", "segment")
SURFACE = "surface"
EVALUATED = re.compile(r"(young'?s )?(modulus|hardness)")  # columns of results
INVALID = 1e300  # beyond it a value means "invalid"


def tests_of(source: Source) -> dict[str, str]:
    """Return names of the sheets ``Test 001``, in the order of their numbers, each with its number as ``1``."""
    numbers = {name: number for name in source.sheets if (number := number_of(name)) is not None}
    return {name: str(number) for name, number in sorted(numbers.items(), key=lambda item: item[1])}


def read_sheets(
    source: Source,
    facts: Mapping[str, Mapping[str, str]],
    channels: Mapping[str, Sequence[str]],
    read: Callable[..., VendorTest],
    *given: object,
) -> list[VendorTest | Unreadable]:
    """Read the sheets ``Test 001``, and after them those of other names that hold a test's channels.

    The latter may be averages or a test that was renamed: they are left out, with a reason, unless somebody names them.

    `facts` are what the workbook, `source`, says of each test, by the number of the test. A test has the columns
    `channels`, of these spellings. `read` is called with the workbook, a sheet's name, what is said of the test, and
    all that is `given`.
    """
    numbered = tests_of(source)
    tests = [
        read_or_report(source.path, sheet, read, source, sheet, facts.get(number, {}), *given)
        for sheet, number in numbered.items()
    ]
    for sheet in (sheet for sheet in source.sheets if sheet not in numbered):
        found: object = read_or_report(source.path, sheet, names_of, source, sheet, channels)
        if isinstance(found, dict) and found:
            found = read_or_report(source.path, sheet, read, source, sheet, {}, *given)
        if isinstance(found, VendorTest):
            reason = "the sheet holds the columns of a test, and is not called 'Test' with a number"
            tests.append(replace(found, uncounted=reason))
        elif isinstance(found, Unreadable):
            tests.append(replace(found, sought=False))
    return tests


def headings_of(source: Source, sheet: str) -> dict[str, int]:
    """Return the columns of a sheet by their names in small letters, without units: ``load`` for ``LOAD (mN)``."""
    found: dict[str, int] = {}
    for index, cell in enumerate([*source.sheet(sheet)[:1], []][0]):
        name = re.sub(r"[_\s]+", " ", BRACKETED.sub(" ", plain(str(cell))))
        found.setdefault(" ".join(name.casefold().split()), index)
    return found


def first_of(names: Collection[str], spellings: Sequence[str]) -> str | None:
    """Return the first of some spellings that is among the names; None where none is."""
    return next((spelling for spelling in spellings if spelling in names), None)


def names_among(names: Collection[str], channels: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return the name of each of the channels, by their spellings, that is among the names; empty where one lacks."""
    found = {key: name for key, spellings in channels.items() if (name := first_of(names, spellings))}
    return found if len(found) == len(channels) else {}


def names_of(source: Source, sheet: str, channels: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return what a sheet calls its channels; empty where it lacks one."""
    return names_among(headings_of(source, sheet), channels)


def values_of(source: Source, sheet: str, channels: Mapping[str, Sequence[str]]) -> dict[str, np.ndarray]:
    """Return the channels of a sheet by their keys, as `channel` does, which refuses a sheet that lacks one."""
    names = names_of(source, sheet, channels) or {key: spellings[0] for key, spellings in channels.items()}
    return {key: channel(source, sheet, name, key) for key, name in names.items()}


def channel(source: Source, sheet: str, name: str, quantity: str) -> np.ndarray:
    """Return a column (n,) of a sheet in s, nm, mN or N/m, be its cells numbers or text.

    Empty cells, words and the 1.8e308 that means "invalid" are NaN. The `sheet` of the workbook `source` and the
    column's `name`, as `headings_of` gives it, say which; the `quantity` is ``time``, ``load``, ``depth`` or
    ``stiffness``. Raises `InputError` when the column is missing or has a unit that is none of what it holds.
    """
    first, rows = source.placed_sheet(sheet)
    index = headings_of(source, sheet).get(name)
    start = 1 + has_row_of_units(source, sheet)
    if index is None or len(rows) < start + 1:
        problem = f"lacks the column {name!r} or its values"
        raise InputError(problem, remedy="export it too", place=f"sheet {sheet}")
    stated, known = stated_unit(source, sheet, name), SCALES.get(quantity, STIFFNESS)
    unit = unit_of(quantity, stated) if quantity in SCALES else stated
    if unit not in known:
        called = BRACKETED.sub("", plain(str(rows[0][index]))).strip()
        raise InputError(
            f"{called} is in {stated!r}" if stated else f"states no unit of {called}, in brackets or in its second row",
            remedy=f"export it in one of: {', '.join(known)}",
            place=f"sheet {sheet}",
        )
    alike = [[row[k] for row in rows[:start]] for k in range(len(rows[0]))]
    twice = [k for k, heading in enumerate(alike) if k != index and heading == alike[index]]
    if any(row[k] != row[index] for row in rows[start:] for k in twice):
        raise several_of(str(rows[0][index]))
    cells = [[row[index]] for row in rows[start:]]
    (values,) = numbers(cells, lambda row: f"sheet {sheet}, row {first + start + row}").T
    return known[unit] * np.where(np.isfinite(values), values, np.nan)


def stated_unit(source: Source, sheet: str, name: str) -> str:
    """Return the unit that a sheet states for a column, in brackets beside its name or in the second row, as it is.

    Both, joined by "and", where they mean different units.
    """
    rows, index = source.sheet(sheet), headings_of(source, sheet)[name]
    below = plain(str(rows[1][index])) if len(rows) > 1 and has_row_of_units(source, sheet) else ""
    both = [*BRACKETED.findall(plain(str(rows[0][index])))[-1:], *([below] if below else [])]
    meant = {next((unit for key in SCALES if (unit := unit_of(key, text))), text): text for text in both}
    return " and ".join(meant.values())


def has_row_of_units(source: Source, sheet: str) -> bool:
    """Return whether the second row of a sheet holds units, not the first numbers."""
    second = [str(cell) for row in source.sheet(sheet)[1:2] for cell in row]
    return not any(re.search(r"\d", cell) and not is_word(cell) for cell in second)


def surface(source: Source, sheet: str) -> int | None:
    """Return the row of numbers, from 0, that the column of markers calls the surface; None where none is."""
    index = headings_of(source, sheet).get(first_of(headings_of(source, sheet), MARKERS) or "")
    if index is None:
        return None
    rows = source.sheet(sheet)[1 + has_row_of_units(source, sheet) :]
    marked = (k for k, row in enumerate(rows) if str(row[index]).strip().casefold().startswith(SURFACE))
    return next(marked, None)


def evaluated(source: Source, sheet: str, kept: np.ndarray, load: np.ndarray) -> dict[str, str]:
    """Return what a test's own columns of modulus and hardness say, as the results of a test are stated.

    It is the value in the row of the largest load, or else the median of those in the upper half of the loading, where
    a continuous stiffness gives one in each row. Of the `sheet` of the workbook `source` the rows of numbers `kept`
    (n,), from 0, make the test, under a `load` (n,) [mN].
    """
    facts: dict[str, str] = {}
    rows = source.sheet(sheet)[1 + has_row_of_units(source, sheet) :]
    peak = int(np.argmax(load))
    upper = np.flatnonzero(load[: peak + 1] >= load[peak] / 2)
    for name, index in headings_of(source, sheet).items():
        if not EVALUATED.fullmatch(name):
            continue
        values = np.array([_value(rows[kept[k]][index]) for k in upper])
        known = values[np.isfinite(values) & (values > 0.0)]
        if len(known):
            value = values[-1] if np.isfinite(values[-1]) and values[-1] > 0.0 else np.median(known)
            facts[f"{name.capitalize()} in its column [{stated_unit(source, sheet, name)}]"] = f"{value:.5g}"
    return facts


def _value(cell: object) -> float:
    """Return the number in a cell; NaN where there is none, or one that means "invalid"."""
    try:
        value = float(str(cell))
    except ValueError:
        return np.nan
    return value if abs(value) < INVALID else np.nan


def facts_of(source: Source, sheets: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return what sheets of results or inputs say of each test, as text, by the number of the test.

    Each has names, units, and one row a test. What a later one says replaces what an earlier one does.
    """
    wanted = {name.casefold(): name for name in (*source.sheets, *source.hidden)}
    facts: dict[str, dict[str, str]] = {}
    for sheet in sheets:
        rows = source.sheet(wanted[sheet.casefold()]) if sheet.casefold() in wanted else []
        names = _headings(rows[0][1:]) if rows else []
        for row in rows[2:]:
            number = re.search(r"\d+", _text(row[0]))
            if number:
                facts.setdefault(str(int(number[0])), {}).update(
                    (f"{name} [{_text(unit)}]" if _text(unit) else name, _text(cell))
                    for name, unit, cell in zip(names, rows[1][1:], row[1:], strict=False)
                    if name and _text(cell)
                )
    return facts


def _headings(cells: Sequence[Any]) -> list[str]:
    """Return headings as text; one that the vendor tore at a comma, ``On? (1-Y`` and ``0-N)``, counts as one."""
    headings: list[str] = []
    for text in map(_text, cells):
        if headings and "(" in headings[-1].rpartition(")")[2] and ")" in text.partition("(")[0]:
            headings[-1] += f", {text}"
        else:
            headings.append(text)
    return headings


def _text(cell: Any) -> str:
    return f"{cell:.9g}" if isinstance(cell, float) else " ".join(str(cell).split())
