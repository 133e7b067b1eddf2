"""What vendors' files say of the tip and the sample beside their curves, by the names that the vendors give it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from palpate.errors import InputError
from palpate.recordings.readers.numbers_in_text import number
from palpate.study.indenter import Indenter

COEFFICIENTS = {"Area Coefficient {}": 1, "Tip C{}": 0}  # MTS/Agilent XP, Hysitron; number of the first
OF_SAMPLE = re.compile(r"(?!.*(indenter|tip|probe|diamond)).*poisson['’]?s? ratio", re.IGNORECASE)
Value = TypeVar("Value")


@dataclass(frozen=True)
class Stated:
    """What all tests of a draft say alike.

    Parameters
    ----------
    area
        Coefficients of the tip's area function [nm], see `palpate.study.area_function`; none where files state no tip
        or an ideal one, or a tip that cannot be simulated.
    poisson_ratio
        Of the sample; None where it is not stated.
    """

    area: tuple[float, ...] = ()
    poisson_ratio: float | None = None

    @classmethod
    def by_all(cls, metadata: Sequence[Mapping[str, Any]]) -> Stated:
        """Return what the metadata of tests, one mapping each, agree on."""
        ratios = [ratio if ratio is not None and 0.0 < ratio < 0.5 else None for ratio in map(poisson_ratio, metadata)]
        return cls(_shared([_area(each) for each in metadata], ()), _shared(ratios, None))


def _shared(values: Sequence[Value], otherwise: Value) -> Value:
    return values[0] if len(set(values)) == 1 else otherwise


def _area(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the coefficients of a tip that is not ideal and can be simulated."""
    area = coefficients(metadata)
    if len(area) > 1:
        with suppress(InputError):
            return Indenter.from_mapping({"shape": "area_function", "area": list(area)}).area
    return ()


def coefficients(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the coefficients of an area function as a file states them, without zeros at the end."""
    for name, first in COEFFICIENTS.items():
        area: list[float] = []
        while (value := _number(metadata.get(name.format(first + len(area))))) is not None:
            area.append(value)
        while area and area[-1] == 0.0:
            area.pop()
        if area:
            return tuple(area)
    return ()


def poisson_ratio(metadata: Mapping[str, Any]) -> float | None:
    """Return what a file states as its sample's Poisson's ratio, whatever that is; None where it states none."""
    said = [_number(value) for name, value in metadata.items() if OF_SAMPLE.match(name)]
    return next((value for value in said if value is not None), None)


def _number(said: object) -> float | None:
    """Return the number with which an entry begins, before its unit; None where there is none."""
    try:
        value = number(str(said).split()[0])
    except (ValueError, IndexError):
        return None
    return value if math.isfinite(value) else None
