"""Columns of a table that may not be what the user takes them for, by their names: the piezo's way, other clocks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.recordings.readers.decimals import numbers
from palpate.recordings.readers.headings import channel_of, words_in
from palpate.recordings.readers.table_body import TableBody
from palpate.recordings.readers.units import CHANNELS

OF_PIEZO = {"piezo", "ramp", "height", "stage", "zsensor", "zsnsr", "lvdt"}
APART = 1e-6  # of a test's duration: clocks that differ less are one


def column_warnings(body: TableBody, rows: np.ndarray) -> tuple[str, ...]:
    """Return warnings on the columns of a table; `rows` are those of it that make the test."""
    if body.header is None:
        return ()
    headings = [str(cell).strip() for cell in body.table.rows[body.header]]
    return _of_piezo(headings, body.places) + _apart(body, headings, rows)


def _of_piezo(headings: list[str], chosen: Sequence[int]) -> tuple[str, ...]:
    """Return a warning where the column of the depth has the name of a drive."""
    name = headings[chosen[2]] if chosen[2] < len(headings) else ""
    if not words_in(name) & OF_PIEZO:
        return ()
    return (f"{name!r} is the way of the drive, by its name: the bending of a cantilever or a spring is in the depth",)


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
