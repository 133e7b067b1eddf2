"""Columns of a table that may not be what the user takes them for, by their names or the kinds of their cells."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from indentation_files.readers.decimals import numbers
from indentation_files.readers.headings import CHANNEL_WORDS, channel_of, words_in
from indentation_files.readers.table_body import TableBody
from indentation_files.readers.units import CHANNELS

OF_PIEZO = {"piezo", "ramp", "height", "stage", "zsensor", "zsnsr", "lvdt"}
NUMBERED = re.compile(r"[ ._-]*\(?\d+\)?$")  # at the end of a name that was there before
APART = 1e-6  # of a test's duration: clocks that differ less are one


def column_warnings(body: TableBody, rows: np.ndarray) -> tuple[str, ...]:
    """Return warnings on the columns of a table; `rows` are those of it that make the test."""
    mixed = _mixed(body, rows) if body.table.source.workbook else ()
    if body.header is None:
        return mixed
    headings = [str(cell).strip() for cell in body.table.rows[body.header]]
    names = [headings[place] if place < len(headings) else "" for place in body.places]
    again = _again(headings, names, body.places) if body.named is not None else ()
    of_another = tuple(
        f"{name!r} is taken as the {key}, and has the name of a {other}: look whether columns are exchanged"
        for key, name in zip(CHANNELS, names, strict=True)
        if (other := channel_of(name)) and not words_in(name) & CHANNEL_WORDS[key]
    )
    of_piezo: tuple[str, ...] = ()
    if words_in(names[2]) & OF_PIEZO:
        drive = f"{names[2]!r} is the way of the drive, by its name"
        of_piezo = (f"{drive}: the bending of a cantilever or a spring is in the depth",)
    return of_another + of_piezo + again + mixed + _apart(body, headings, rows)


def _again(headings: list[str], names: list[str], chosen: Sequence[int]) -> tuple[str, ...]:
    """Return a warning where columns beside the chosen ones have the names of all three again."""
    wanted, others = (
        [NUMBERED.sub("", name).strip() for name in some]
        for some in (names, [name for k, name in enumerate(headings) if k not in chosen])
    )
    if not all(name and name in others for name in wanted):
        return ()
    return (f"columns called {', '.join(wanted)} stand there again: of several tests side by side one is read",)


def _mixed(body: TableBody, rows: np.ndarray) -> tuple[str, ...]:
    """Return a warning for each column of a workbook that holds numbers, and texts with a sign that are read as such.

    A spreadsheet program that takes a decimal point for one that parts thousands makes a number of ``387.298``, a
    thousand times as large, and leaves ``500.5`` as a text.
    """
    found = []
    for key, place in zip(CHANNELS, body.places, strict=True):
        cells = {int(k): body.table.rows[k][place] for k in rows if place < len(body.table.rows[k])}
        texts = [k for k, cell in cells.items() if isinstance(cell, str) and re.search(r"\d[.,]\d", cell)]
        count = sum(not isinstance(cell, str) for cell in cells.values())
        if texts and count:
            found.append(
                f"the {key} is a number in {count} cells and a text in {len(texts)} ({body.table.place(*texts)}): a "
                "spreadsheet program may have taken decimal signs for those of thousands"
            )
    return tuple(found)


def _apart(body: TableBody, headings: list[str], rows: np.ndarray) -> tuple[str, ...]:
    """Return a warning where load and depth follow columns of times, in this order of columns, that differ."""
    chosen = body.places
    clocks = {chosen[0], *(k for k, name in enumerate(headings) if channel_of(name) == "time")}
    own = [max((k for k in clocks if k < column), default=chosen[0]) for column in chosen[1:]]
    if own[0] == own[1]:
        return ()
    cells = [[row[k] if k < len(row) else "" for k in own] for row in (body.table.rows[k] for k in rows)]
    times = numbers(cells, lambda row: body.table.place(int(rows[row])))
    times = times[np.isfinite(times).all(axis=1)]
    differ = float(np.abs(times[:, 0] - times[:, 1]).max()) if len(times) else 0.0
    if differ <= APART * float(np.ptp(times)):
        return ()
    names = " and ".join(f"{key} behind {headings[k]!r}" for key, k in zip([*CHANNELS][1:], own, strict=True))
    return (f"{names} may have times of their own, which differ by up to {differ:.3g}; only the chosen ones count",)
