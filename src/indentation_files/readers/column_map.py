"""Which columns of a table hold time, load and depth, as the user says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from indentation_files.errors import InputError
from indentation_files.readers.headings import channel_of, unmistakable
from indentation_files.readers.tables import Table
from indentation_files.readers.units import CHANNELS, plain, scale


@dataclass(frozen=True)
class ColumnMap:
    """Which columns hold what.

    `names` has the name of the column, or its number from 1, for each of ``time``, ``load`` and ``depth``, `units`
    their units, where the table states none or wrong ones; ``-mN`` turns the sign. s, mN and nm where neither says
    more.
    """

    names: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def stated(cls, columns: Any, units: Any = None) -> ColumnMap | None:
        """Return the map that a user states, or None where no columns are named; numbers of columns may be numbers.

        Raises `InputError` when units are given without columns, or either is no mapping.
        """
        for place, given in (("columns", columns), ("units", units)):
            if given is not None and not isinstance(given, Mapping):
                problem = f"{type(given).__name__} is no mapping of channels"
                raise InputError(problem, remedy="name time, load and depth, such as {'load': ...}", place=place)
        if units and not columns:
            raise InputError("units are given without columns", remedy="add columns, or leave units off", place="units")
        names, named = ({key: str(text) for key, text in (given or {}).items()} for given in (columns, units))
        return cls(names, named) if names else None

    def __post_init__(self) -> None:
        for key in CHANNELS:
            if key not in self.names:
                remedy = f"add {key}=NAME; if the table has none, export it with {key}, which cannot be guessed"
                raise InputError(f"no column is named for {key}", remedy=remedy, place="columns")
        for given, place in ((self.names, "columns"), (self.units, "units")):
            for key in given:
                if key not in CHANNELS:
                    raise InputError(f"{key!r} is no channel", remedy="use time, load and depth", place=place)
        owners: dict[str, str] = {}
        for key, name in self.names.items():
            if name in owners:
                raise InputError(
                    f"{owners[name]} and {key} are both {name!r}", remedy="name a column for each", place="columns"
                )
            owners[name] = key
        for key, unit in self.units.items():
            scale(key, unit)


def called(cell: object) -> str:
    """Return a column's name as it is compared: single blanks, and no sign of a comment, ``#`` or ``%``, before it."""
    return " ".join(plain(str(cell)).lstrip("#% ").split())


def columns_of(table: Table, columns: ColumnMap) -> tuple[int | None, list[int]] | None:
    """Return the header's row, None for columns by number, and the index of each channel; None without the columns."""
    given = [columns.names[key].strip() for key in CHANNELS]
    if all(name.isdecimal() and int(name) > 0 for name in given):
        return None, [int(name) - 1 for name in given]
    wanted = [called(name) for name in given]
    for number in table.aside:
        cells = [called(cell) for cell in table.rows[number]]
        if all(name in cells for name in wanted):
            for name in wanted:
                if cells.count(name) > 1:
                    raise InputError(
                        f"several columns are called {name!r}", remedy="give the columns by their numbers, from 1"
                    )
            return number, [cells.index(name) for name in wanted]
    return None


def by_headings(tables: Sequence[Table]) -> ColumnMap | None:
    """Return the map of a table whose headings name time, load and depth with their units, each once; else None.

    A heading that names one of them in another way, such as ``Piezo displacement (nm)``, leaves the choice to the user.
    """
    for table in tables:
        for number in table.aside:
            cells = [called(cell) for cell in table.rows[number]]
            below = [str(cell) for cell in table.rows[number + 1]] if number + 1 < len(table.rows) else []
            padded = [*below, *[""] * (len(cells) - len(below))]
            named = {key: [cell for cell in cells if channel_of(cell) == key] for key in CHANNELS}
            sure = {unmistakable(cell, unit): cell for cell, unit in zip(cells, padded, strict=False)}
            if all(len(named[key]) == 1 and sure.get(key) == named[key][0] for key in CHANNELS):
                return ColumnMap({key: sure[key] for key in CHANNELS})
    return None
