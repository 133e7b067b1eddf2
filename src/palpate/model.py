"""Material, indenter and protocol in, simulated recording out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palpate.errors import InputError
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.parameters import Parameter, check_values
from palpate.protocol import Protocol, trapezoid

ACCURACIES = ("standard", "fine")
KINEMATICS = ("small", "large")
PROTOCOL = (
    Parameter("max_load", "P", "mN", 1e-9, 1e6, "largest load"),
    Parameter("loading_time", "t_l", "s", 1e-6, 1e9, "duration of loading"),
    Parameter("hold_time", "t_h", "s", 0.0, 1e9, "duration of the hold at the largest load", default=0.0),
    Parameter("unloading_time", "t_u", "s", 1e-6, 1e9, "duration of unloading"),
    Parameter("points", "n", "-", 4, 100000, "number of points on the curve", default=100.0),
)
KEYS = ("material", "indenter", "protocol", "kinematics", "mechanisms", "accuracy")


@dataclass(frozen=True, eq=False)
class Specification:
    """Everything that decides a simulated curve.

    Parameters
    ----------
    model
        Key of the constitutive law.
    parameters
        Its parameters by name.
    indenter, protocol
        What presses, and how.
    kinematics
        ``small`` or ``large`` strains.
    accuracy
        ``standard`` or ``fine``.

    Raises
    ------
    InputError
        On anything unknown, missing or outside its physical range.
    """

    model: str
    parameters: Mapping[str, float]
    indenter: Indenter
    protocol: Protocol
    kinematics: str = "small"
    accuracy: str = "standard"
    coefficients: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.model not in LAWS:
            raise InputError(
                f"material model {self.model!r} is not known", remedy=f"use one of: {', '.join(LAWS)}", place="model"
            )
        for key, value, known in (
            ("accuracy", self.accuracy, ACCURACIES),
            ("kinematics", self.kinematics, KINEMATICS),
        ):
            if value not in known:
                raise InputError(f"{key} is {value!r}", remedy=f"use one of: {', '.join(known)}", place=key)
        if self.indenter.friction:
            raise InputError(
                f"friction = {self.indenter.friction:g} is not available yet", remedy="use 0", place="indenter.friction"
            )
        object.__setattr__(self, "parameters", LAWS[self.model].check(self.parameters))
        object.__setattr__(self, "coefficients", LAWS[self.model].coefficients(self.parameters))

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> Specification:
        """Build from the keys of a SPEC.yaml; `protocol` may also be a `Protocol`."""
        if not isinstance(values, Mapping):
            raise InputError("the specification is not a table of keys", remedy=f"give {', '.join(KEYS[:3])}")
        for key in values:
            if key not in KEYS:
                raise InputError(f"unknown key {key!r}", remedy=f"use one of: {', '.join(KEYS)}", place=str(key))
        for key in KEYS[:3]:
            if key not in values or (key != "protocol" and not isinstance(values[key], Mapping)):
                raise InputError(f"{key} is missing or not a table of keys", remedy=f"add a {key} section", place=key)
        if values.get("mechanisms"):
            raise InputError("mechanisms are not available yet", remedy="remove the key", place="mechanisms")
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
            checked = check_values(PROTOCOL, protocol, "protocol")
            points = int(checked.pop("points"))
            protocol = trapezoid(**checked, points=points)
        return cls(
            str(model),
            material,
            indenter,
            protocol,
            kinematics=str(values.get("kinematics", "small")),
            accuracy=str(values.get("accuracy", "standard")),
        )


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
    """Simulate one indentation; a solver failure is reported in the result, never raised."""
    from palpate.fem.indent import RESOLUTIONS, indent

    protocol = specification.protocol
    history = indent(
        specification.coefficients,
        specification.indenter,
        protocol,
        RESOLUTIONS[specification.accuracy],
        large=specification.kinematics == "large",
    )
    status = "failed" if history.reason else "ok"
    return Simulation(
        protocol.sample_time, protocol.sample_load, history.depth, status, history.reason, history.seconds
    )


def simulate_batch(specifications: Iterable[Specification]) -> list[Simulation]:
    """Simulate several indentations, one after the other."""
    return [simulate(specification) for specification in specifications]
