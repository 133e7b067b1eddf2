"""Mechanisms applied to the body and to the recorded signal; a specification with one parameter changed a little."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.materials import law_of
from palpate.mechanisms import MECHANISMS
from palpate.solver.instrument_drive import through_instrument
from palpate.study.protocol import DISPLACEMENT, LOAD, Protocol
from palpate.study.specification import Specification

STEP = 3e-5  # of the value, or of one unit, or of the test where a time is zero: derivatives err by about as much


def applied_to_body(specification: Specification) -> Specification:
    """Return the specification that is simulated, after its mechanisms have changed it.

    Under displacement control, what the instrument adds to the depth is subtracted from the displacement of the body.

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


def applied_to_signal(specification: Specification, depth: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the recorded depth (n,) [nm] at a true `depth` (n,) [nm] under a `load` (n,) [mN]."""
    return _written(specification.mechanisms, specification.protocol.sample_time, load, depth)


def added_by_instrument(mechanisms: Mapping[str, Mapping[str, float]], protocol: Protocol) -> np.ndarray:
    """Return what mechanisms add to the recorded depth (n_points,) [nm].

    Zero where a displacement is prescribed: there it changes the displacement of the body.
    """
    none = np.zeros(len(protocol.sample_time))
    return none if protocol.control != LOAD else _written(mechanisms, protocol.sample_time, protocol.sample_load, none)


def _written(
    mechanisms: Mapping[str, Mapping[str, float]], time: np.ndarray, load: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    for key, values in mechanisms.items():
        depth = MECHANISMS[key].record(time, load, depth, values)
    return depth


@dataclass(frozen=True, eq=False)
class Variation:
    """A specification beside another one, with one parameter changed a little.

    Parameters
    ----------
    neighbour : Specification
    step
        By how much the parameter is changed, in its unit.
    """

    neighbour: Specification
    step: float

    @classmethod
    def of(cls, specification: Specification, name: str) -> Variation:
        """Vary one parameter, a material's by its name, a mechanism's as ``key.name``; upwards where it may grow.

        Raises
        ------
        InputError
            When the specification has no such parameter.
        """
        parameter, value = _find(specification, name)
        without = specification.protocol.knot_time[-1] if parameter.unit == "s" else 1.0
        step = STEP * (abs(value) or without)
        step = step if value + step <= parameter.upper else -step
        return cls(_with(specification, name, value + step), step)


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
        declared, values = law_of(specification.model).declared(specification.parameters), specification.parameters
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
