"""What a parameter is: declared once, with its name, symbol, unit, physical range and meaning."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeGuard

from palpate.errors import InputError


def in_words(name: str) -> str:
    """Return a parameter's name as people write it: ``youngs_modulus`` is Young's modulus."""
    return name.replace("_", " ").replace("youngs", "Young's").replace("poisson ratio", "Poisson's ratio")


def is_finite_number(value: object) -> TypeGuard[float]:
    """Return whether a value of a YAML file is a number that fits a float; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


@dataclass(frozen=True)
class Parameter:
    """A named physical quantity with its admissible range.

    Parameters
    ----------
    name
        Word used at every interface, such as ``steady_exponent``.
    symbol
        Symbol used inside formulas and on figures, such as ``m_s`` (mathtext without dollars).
    unit
        Unit as printed, such as ``GPa``; ``-`` for a pure number.
    lower, upper
        Open or closed physical range: values must lie in [lower, upper].
    meaning
        One line for people.
    default
        Value taken when none is given; ``None`` means the value is required.
    whole
        Whether it counts something: a whole number that no grid varies.
    """

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    meaning: str
    default: float | None = None
    whole: bool = False

    def check(self, value: object) -> float:
        """Return `value` as a float, or raise `InputError` naming the parameter and its range."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(
                f"{self.name} is {value!r}, expected a number",
                remedy="give a number" + ("" if self.unit == "-" else f" in {self.unit}"),
                place=self.name,
            )
        number = float(value) if is_finite_number(value) else math.inf
        if not math.isfinite(number) or not self.lower <= number <= self.upper:
            given = f"{number:g}" if self.unit == "-" else f"{number:g} {self.unit}"
            raise InputError(
                f"{self.name} = {given} is outside its range {self.lower:g} to {self.upper:g}",
                remedy="correct the value" + ("" if self.unit == "-" else " or its unit"),
                place=self.name,
            )
        if self.whole and number != int(number):
            raise InputError(f"{self.name} = {number:g} is no whole number", remedy="round it", place=self.name)
        return number


def check_values(declared: Iterable[Parameter], values: Mapping[str, object], owner: str) -> dict[str, float]:
    """Check `values` against `declared` and fill in defaults.

    Returns
    -------
    dict
        Every declared parameter by name, in the declared order.

    Raises
    ------
    InputError
        On anything but a table, an unknown name, a missing required parameter, or a value outside its range.
    """
    declared = tuple(declared)
    names = [parameter.name for parameter in declared]
    if not isinstance(values, Mapping):
        raise InputError(
            f"{owner} is {values!r}, expected a table of its parameters",
            remedy=f"write {{{', '.join(f'{name}: ...' for name in names)}}}",
        )
    for name in values:
        if name not in names:
            raise InputError(
                f"{owner} has no parameter {name!r}", remedy=f"use one of: {', '.join(names)}", place=str(name)
            )
    checked = {}
    for parameter in declared:
        if parameter.name in values:
            checked[parameter.name] = parameter.check(values[parameter.name])
        elif parameter.default is not None:
            checked[parameter.name] = parameter.default
        else:
            raise InputError(
                f"{owner} has no value for its parameter {parameter.name!r}",
                remedy=f"give {parameter.meaning} in {parameter.unit}",
                place=parameter.name,
            )
    return checked
