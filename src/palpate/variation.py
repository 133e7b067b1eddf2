"""What a parameter changes: the inputs of the solver a little below and above its value.

The inputs are simple functions of the parameters (moduli, weights of a law, the slope of a cone), smooth within their
ranges, so central differences give their derivatives to about nine digits; nothing that is simulated is differenced.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palpate.displaced import through_instrument
from palpate.errors import InputError
from palpate.fem.clock import Shift
from palpate.fem.directions import Directions
from palpate.materials import LAWS
from palpate.mechanisms import MECHANISMS
from palpate.parameters import Parameter
from palpate.protocol import DISPLACEMENT
from palpate.specification import Specification

STEP = 1e-6
SMALL = 1e-3  # below this a value counts as that much; a time of zero as the test


def acting(specification: Specification) -> Specification:
    """Return what is simulated: the specification as its mechanisms change it.

    Under displacement control what the instrument adds to the depth is taken from what the body feels.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    for key, values in specification.mechanisms.items():
        specification = MECHANISMS[key].simulate(specification, values)
    if specification.protocol.control == DISPLACEMENT:
        for key, values in specification.mechanisms.items():
            protocol = through_instrument(specification.protocol, MECHANISMS[key], values)
            specification = replace(specification, protocol=protocol)
    return specification


def recorded(specification: Specification, depth: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return what the instrument writes at a true `depth` (n,) [nm] under a `load` (n,) [mN]."""
    time = specification.protocol.sample_time
    for key, values in specification.mechanisms.items():
        depth = MECHANISMS[key].record(time, load, depth, values)
    return depth


@dataclass(frozen=True, eq=False)
class Variation:
    """A specification with one parameter a little below and a little above its value.

    Parameters
    ----------
    low, high : Specification
    width
        Distance between the two values, in the unit of the parameter.
    """

    low: Specification
    high: Specification
    width: float

    @classmethod
    def of(cls, specification: Specification, name: str) -> Variation:
        """Vary one parameter, a material's by its name, a mechanism's as ``key.name``; one-sided at its bounds.

        Raises
        ------
        InputError
            When the specification has no such parameter.
        """
        parameter, value = _find(specification, name)
        without = specification.protocol.knot_time[-1] if parameter.unit == "s" and value == 0.0 else SMALL
        reach = STEP * max(abs(value), without)
        low, high = max(value - reach, parameter.lower), min(value + reach, parameter.upper)
        return cls(_with(specification, name, low), _with(specification, name, high), high - low)


def _find(specification: Specification, name: str) -> tuple[Parameter, float]:
    key, _, own = name.rpartition(".")
    declared: Sequence[Parameter]
    values: Mapping[str, float]
    if key:
        if key not in specification.mechanisms:
            raise InputError(
                f"parameter {name!r} belongs to no mechanism of the specification",
                remedy=f"add the mechanism {key!r}, or use one of: {', '.join(specification.mechanisms) or 'none'}",
                place="parameters",
            )
        declared, values = MECHANISMS[key].parameters, specification.mechanisms[key]
    else:
        declared, values = LAWS[specification.model].declared(specification.parameters), specification.parameters
    for parameter in declared:
        if parameter.name == own:
            return parameter, values[own]
    raise InputError(
        f"there is no parameter {name!r}",
        remedy=f"use one of: {', '.join(f'{key}.{p.name}' if key else p.name for p in declared)}",
        place="parameters",
    )


def _with(specification: Specification, name: str, value: float) -> Specification:
    key, _, own = name.rpartition(".")
    if not key:
        return replace(specification, parameters={**specification.parameters, own: value})
    mechanisms = {**specification.mechanisms, key: {**specification.mechanisms[key], own: value}}
    return replace(specification, mechanisms=mechanisms)


def directions(variations: Mapping[str, Variation]) -> Directions:
    """Return the derivatives of the solver's inputs by the parameters varied, in their order.

    Raises
    ------
    InputError
        With adhesion, and for the thickness of a film, on which a mesh depends by jumps.
    """
    columns: list[list[Any]] = []
    shifts = []
    for name, variation in variations.items():
        low, high = acting(variation.low), acting(variation.high)
        if high.adhesion > 0.0:
            raise InputError(
                f"{name}: derivatives do not know adhesion, whose contact changes by jumps",
                remedy="leave adhesion out, or take the difference of two simulations",
                place="parameters",
            )
        if low.film_thickness != high.film_thickness:
            raise InputError(
                f"{name}: the depth has no derivative by the thickness of a film, whose elements change by eighths",
                remedy="leave it out, or take the difference of two simulations well apart",
                place="parameters",
            )
        change = [
            (after - before) / variation.width
            for before, after in (
                (low.specimen.coefficients[None], high.specimen.coefficients[None]),
                (low.indenter.slope, high.indenter.slope) if low.indenter.half_angle else (0.0, 0.0),
                (1e-3 * low.indenter.radius, 1e-3 * high.indenter.radius),
                (low.indenter.friction, high.indenter.friction),
                (low.size_length, high.size_length),
            )
        ]
        if low.protocol is not high.protocol:
            shifts.append(Shift(len(columns), low.protocol, high.protocol, variation.width))
        columns.append(change)
    laws, slope, radius, friction, size_length = (np.stack(column, axis=-1) for column in zip(*columns, strict=True))
    return Directions(laws, slope, radius, friction, size_length, tuple(shifts))
