"""Any table, text or Excel, by a map of its columns that the user gives: no format is guessed, none is assumed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import LARGEST, UNITS, Source
from palpate.readers.vendor import VendorTest, recording_from

CHANNELS = {"time": "s", "load": "mN", "depth": "nm"}
SCALES = {
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "load": {unit: UNITS[unit] for unit in ("mN", "uN", "µN", "N")} | {"nN": 1e-6},
    "depth": {unit: UNITS[unit] for unit in ("nm", "um", "µm")} | {"mm": 1e6, "m": 1e9, "A": 0.1},
}
DELIMITERS = ("\t", ";", ",")


@dataclass(frozen=True)
class ColumnMap:
    """Which columns hold what.

    Parameters
    ----------
    names
        Name of the column, or its number from 1, for each of ``time``, ``load`` and ``depth``.
    units
        Their units; s, mN and nm where none is given.
    """

    names: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for key in CHANNELS:
            if key not in self.names:
                raise InputError(f"no column is named for {key}", remedy=f"add {key}=NAME", place="columns")
        for given, place in ((self.names, "columns"), (self.units, "units")):
            for key in given:
                if key not in CHANNELS:
                    raise InputError(f"{key!r} is no channel", remedy="use time, load and depth", place=place)
        for key, unit in self.units.items():
            if unit not in SCALES[key]:
                raise InputError(
                    f"{key} in {unit!r} is not known", remedy=f"use one of: {', '.join(SCALES[key])}", place="units"
                )

    def scale(self, key: str) -> float:
        """Return the factor that brings a channel to s, mN or nm."""
        return SCALES[key][self.units.get(key, CHANNELS[key])]


def read_columns(source: Source, columns: ColumnMap) -> list[VendorTest]:
    """Read the one table of a text file, or one from each sheet of a workbook that holds the columns.

    The header is the first row with all names; rows below it count from the first to the last that holds three numbers,
    so a row of units and remarks at the end do no harm. Numbers beyond 1e300 stand for "invalid" and are dropped.

    Raises
    ------
    InputError
        When no table has the columns, or too many of its values are no numbers.
    """
    tables = (
        {name: source.sheet(name) for name in source.sheets} if source.workbook else {source.path.stem: _rows(source)}
    )
    tests = []
    for name, rows in tables.items():
        place = _columns_of(rows, columns)
        if place is None:
            continue
        start, indices = place
        cells = [[_number(row[k]) if k < len(row) else np.nan for k in indices] for row in rows[start:]]
        values = np.array(cells, dtype=float).reshape(-1, 3)
        values[np.abs(values) > LARGEST] = np.nan
        whole = np.flatnonzero(np.isfinite(values).all(axis=1))
        if not len(whole):
            continue
        values = values[whole[0] : whole[-1] + 1]
        time, load, depth = (values[:, k] * columns.scale(key) for k, key in enumerate(CHANNELS))
        tests.append(VendorTest(name, recording_from(source, name, name, time - time[0], load, depth)))
    if not tests:
        raise InputError(
            f"holds no table with numbers in the columns {', '.join(columns.names[key] for key in CHANNELS)}",
            remedy="correct the map of columns; names are those of the header, or numbers from 1",
            file=source.path,
        )
    return tests


def _rows(source: Source) -> list[list[str]]:
    """Split the lines at tabs, semicolons or commas, whichever most lines hold more than one of; else at blanks."""
    lines = [line for line in source.lines if line.strip()]
    for delimiter in DELIMITERS:
        if sum(line.count(delimiter) >= 2 for line in lines) > len(lines) / 2:
            return [[cell.strip().strip('"') for cell in line.split(delimiter)] for line in lines]
    return [line.split() for line in lines]


def _columns_of(rows: list[list[Any]], columns: ColumnMap) -> tuple[int, list[int]] | None:
    """Return the first row below the header and the index of each channel, or None when the columns are not there."""
    wanted = [columns.names[key].strip() for key in CHANNELS]
    for number, row in enumerate(rows):
        cells = [str(cell).strip() for cell in row]
        if all(name in cells for name in wanted):
            return number + 1, [cells.index(name) for name in wanted]
    if all(name.isdigit() and int(name) > 0 for name in wanted):
        return 0, [int(name) - 1 for name in wanted]
    return None


def _number(cell: Any) -> float:
    """Return a cell's number, with decimal comma or point; NaN for anything else."""
    if isinstance(cell, int | float):
        return float(cell)
    text = str(cell).strip().replace(",", ".")
    return float(text) if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text) else np.nan
