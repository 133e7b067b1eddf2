"""Levels of the parameters of a study, checked against the law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import prod
from typing import Any

from palpate.configuration.checked_file import suggestion
from palpate.errors import InputError, part_of
from palpate.materials import law_of

MOST_MATERIALS = 200_000  # of a grid; more are simulated for days, and planned for minutes


def checked_levels(
    model: str, material: Mapping[str, Any], given: Mapping[str, Sequence[float]], kind: str
) -> dict[str, tuple[float, ...]]:
    """Return the levels of each parameter, after fixed values and levels have been checked against the law.

    Parameters
    ----------
    model
        Key of the law.
    material
        Its fixed parameters.
    given
        Levels of the others.
    kind
        Of design; ``factorial`` takes every combination of the levels.

    Raises
    ------
    InputError
        On a parameter that the law does not have, that is missing, given twice or out of its range; on levels that make
        too many materials; and where the law refuses a corner of the ranges.
    """
    declared = {p.name: p for p in law_of(model).declared({**material, **given})}
    for owner, names in (("material", material), ("parameters", given)):
        for name in names:
            if name not in declared:
                raise InputError(
                    f"{name!r} is no parameter of {model}{suggestion(name, declared)}",
                    remedy=f"use one of: {', '.join(declared)}",
                    place=f"{owner}.{name}",
                )
    for name, parameter in declared.items():
        if parameter.default is not None and name not in material and name not in given:
            continue
        if parameter.whole and len(given.get(name, ())) > 1:
            raise InputError(
                f"{name} ({parameter.meaning}) cannot vary", remedy="give one value, under material",
                place=f"parameters.{name}",
            )  # fmt: skip
        if (name in material) == (name in given):
            problem = "given twice" if name in material else "missing"
            raise InputError(
                f"{name} ({parameter.meaning}) is {problem}", remedy="give it once, under material or parameters",
                place="parameters",
            )  # fmt: skip
        owner, values = ("material", [material[name]]) if name in material else ("parameters", given[name])
        for value in values:
            with part_of(owner):
                parameter.check(value)
    for name, levels in given.items():
        if len(set(levels)) != len(levels):
            raise InputError("a level is given twice", remedy="remove it", place=f"parameters.{name}")
        if list(levels) not in (sorted(levels), sorted(levels, reverse=True)):
            raise InputError(
                f"the levels {', '.join(f'{level:g}' for level in levels)} neither rise nor fall",
                remedy="sort them, and write decimals with a point", place=f"parameters.{name}",
            )  # fmt: skip
    if all(len(levels) == 1 for levels in given.values()):
        raise InputError(
            "every parameter is held constant, so that there is nothing to calibrate",
            remedy="give one of them at least two levels, or simulate a single curve with palpate simulate",
            place="parameters",
        )
    if kind == "factorial" and (count := prod(map(len, given.values()))) > MOST_MATERIALS:
        raise InputError(
            f"the levels make {count} materials, more than {MOST_MATERIALS}",
            remedy="give fewer levels, or design: {kind: sobol, points: ...}",
            place="parameters",
        )
    ends = {name: sorted({min(levels), max(levels)}) for name, levels in given.items()}
    for corner in product(*ends.values()):
        with part_of("parameters"):
            law_of(model).coefficients({**material, **dict(zip(ends, corner, strict=True))})
    return {name: tuple(float(level) for level in levels) for name, levels in given.items()}
