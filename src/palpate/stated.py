"""What vendors' files say of the tip and the sample beside their curves, by the names that the vendors give it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from palpate.errors import InputError
from palpate.indenters import Indenter
from palpate.readers.text import number

COEFFICIENTS = {"Area Coefficient {}": 1, "Tip C{}": 0}  # MTS/Agilent XP, Hysitron; number of the first
POISSON_RATIOS = re.compile(r"poisson'?s ratio( of sample)?( \[.*\])?", re.IGNORECASE)
Value = TypeVar("Value")


@dataclass(frozen=True)
class Stated:
    """What all tests of a draft say alike.

    Parameters
    ----------
    area
        Coefficients of the tip's area function [nm], see `palpate.area_function`; none where files state no tip or an
        ideal one, or a tip that cannot be simulated.
    poisson_ratio
        Of the sample; None where it is not stated.
    """

    area: tuple[float, ...] = ()
    poisson_ratio: float | None = None

    @classmethod
    def by_all(cls, metadata: Sequence[Mapping[str, Any]]) -> Stated:
        """Return what the metadata of tests, one mapping each, agree on."""
        return cls(
            _shared([_area(each) for each in metadata], ()), _shared([_poisson(each) for each in metadata], None)
        )


def _shared(values: Sequence[Value], otherwise: Value) -> Value:
    return values[0] if len(set(values)) == 1 else otherwise


def _area(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    for name, first in COEFFICIENTS.items():
        area: list[float] = []
        while (value := _value(metadata.get(name.format(first + len(area))))) is not None:
            area.append(value)
        while area and area[-1] == 0.0:
            area.pop()
        if len(area) > 1:
            with suppress(InputError):
                return Indenter.from_mapping({"shape": "area_function", "area": area}).area
    return ()


def _poisson(metadata: Mapping[str, Any]) -> float | None:
    values = [_value(said) for name, said in metadata.items() if POISSON_RATIOS.fullmatch(name)]
    found = [value for value in values if value is not None and 0.0 < value < 0.5]
    return found[0] if found else None


def _value(said: object) -> float | None:
    """Return the number with which an entry begins, before its unit."""
    try:
        return number(str(said).split()[0])
    except (ValueError, IndexError):
        return None
