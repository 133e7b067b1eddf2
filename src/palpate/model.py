"""Specification in, simulated curve out: material, contact, and whatever else the mechanisms add."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palpate.errors import InputError, PalpateError
from palpate.fem.indent import RESOLUTIONS, History, indent
from palpate.fem.newton import Problem, State
from palpate.indenters import Indenter
from palpate.load_history import protocol_from
from palpate.mechanisms import MECHANISMS
from palpate.protocol import Protocol
from palpate.specification import Specification

KEYS = ("material", "indenter", "protocol", "kinematics", "mechanisms", "accuracy")


def specification_from(values: Mapping[str, Any]) -> Specification:
    """Build from the keys of a SPEC.yaml; `protocol` may also be a `Protocol`."""
    if not isinstance(values, Mapping):
        raise InputError("the specification is not a table of keys", remedy=f"give {', '.join(KEYS[:3])}")
    for key in values:
        if key not in KEYS:
            raise InputError(f"unknown key {key!r}", remedy=f"use one of: {', '.join(KEYS)}", place=str(key))
    for key in KEYS[:3]:
        if key not in values or (key != "protocol" and not isinstance(values[key], Mapping)):
            raise InputError(f"{key} is missing or not a table of keys", remedy=f"add a {key} section", place=key)
    material = dict(values["material"])
    model = material.pop("model", None)
    try:
        indenter = Indenter.from_mapping(values["indenter"])
    except InputError as error:
        place = f"indenter.{error.place}" if error.place else "indenter"
        raise InputError(error.problem, remedy=error.remedy, place=place) from None
    protocol = values["protocol"]
    if not isinstance(protocol, Protocol):
        if not isinstance(protocol, Mapping):
            raise InputError("protocol is not a table of keys", remedy="give max_load and times", place="protocol")
        protocol = protocol_from(protocol)
    return Specification(
        str(model),
        material,
        indenter,
        protocol,
        kinematics=str(values.get("kinematics", "small")),
        accuracy=str(values.get("accuracy", "standard")),
        mechanisms=_mechanisms(values.get("mechanisms") or {}),
    )


def _mechanisms(given: Any) -> dict[str, dict[str, float]]:
    if not isinstance(given, Mapping):
        raise InputError("mechanisms is not a table of keys", remedy="give key: {parameter: value}", place="mechanisms")
    checked = {}
    for key, values in given.items():
        if key not in MECHANISMS:
            raise InputError(
                f"mechanism {key!r} is not known", remedy=f"use one of: {', '.join(MECHANISMS)}", place="mechanisms"
            )
        try:
            checked[key] = MECHANISMS[key].check(values or {})
        except InputError as error:
            raise InputError(error.problem, remedy=error.remedy, place=f"mechanisms.{key}.{error.place}") from None
    return checked


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated curve.

    Attributes
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm]; the depth is NaN from a failure on.
    status
        ``ok`` or ``failed``.
    reason
        Why it failed; empty otherwise.
    solver_seconds
        Wall time spent in the solver [s].
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    status: str
    reason: str
    solver_seconds: float


def simulate(specification: Specification) -> Simulation:
    """Simulate one indentation with its mechanisms; a solver failure is reported in the result, never raised.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    history = _indent(_acting(specification))
    time, load = specification.protocol.sample_time, specification.protocol.sample_load
    depth = history.depth
    for key, values in specification.mechanisms.items():
        depth = MECHANISMS[key].record(time, load, depth, values)
    return Simulation(time, load, depth, "failed" if history.reason else "ok", history.reason, history.seconds)


def _acting(specification: Specification) -> Specification:
    """Return what is simulated, with the mechanisms at work."""
    for key, values in specification.mechanisms.items():
        specification = MECHANISMS[key].simulate(specification, values)
    return specification


def _indent(acting: Specification, observe: Callable[[Problem, State], None] | None = None) -> History:
    return indent(
        acting.specimen,
        acting.indenter,
        acting.protocol,
        RESOLUTIONS[acting.accuracy],
        large=acting.kinematics == "large",
        observe=observe,
    )


def states_at(specification: Specification, times: Iterable[float]) -> tuple[Problem, list[State]]:
    """Simulate one indentation for the states of the body at some times [s].

    Returns
    -------
    problem
        What does not change, such as the mesh.
    states
        One for each of the times, which are sorted.

    Raises
    ------
    InputError
        When a time lies outside the test.
    PalpateError
        When the solver fails.
    """
    acting = _acting(specification)
    wanted, protocol = np.unique(np.asarray(list(times), dtype=float)), acting.protocol
    if not np.all((wanted > 0) & (wanted <= protocol.knot_time[-1])):
        raise InputError(
            f"a time lies outside the test, which lasts {protocol.knot_time[-1]:g} s",
            remedy="give times above zero, up to its end",
            place="time",
        )
    found: list[tuple[Problem, State]] = []

    def keep(problem: Problem, state: State) -> None:
        if np.abs(wanted - state.time).min() <= 1e-9 * protocol.knot_time[-1]:
            found.append((problem, state))

    samples = np.union1d(protocol.sample_time, wanted)
    history = _indent(replace(acting, protocol=replace(protocol, sample_time=samples)), keep)
    if history.reason:
        raise PalpateError(f"the simulation failed: {history.reason}")
    return found[0][0], [state for _, state in found]


def simulate_batch(specifications: Iterable[Specification]) -> list[Simulation]:
    """Simulate several indentations, one after the other."""
    return [simulate(specification) for specification in specifications]
