"""Specification in, simulated curve out: material, contact, and whatever else the mechanisms add."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palpate.errors import InputError, PalpateError
from palpate.fem.batch import Case, indent_batch
from palpate.fem.directions import Directions
from palpate.fem.discretisation import RESOLUTIONS
from palpate.fem.fields import Fields
from palpate.fem.indent import History, indent
from palpate.fem.similar import indent_distinct, length_ratio
from palpate.fem3d.fields import fields_of
from palpate.fem3d.indent import RESOLUTIONS as RESOLUTIONS_3D
from palpate.fem3d.indent import indent_3d
from palpate.indenters import Indenter
from palpate.load_history import protocol_from
from palpate.mechanisms import checked_mechanisms
from palpate.protocol import LOAD, Protocol
from palpate.specification import Specification, axisymmetric_only
from palpate.variation import Variation, acting, directions, recorded

SECTIONS = {
    "material": "{model: elastic, youngs_modulus: 3.0, poisson_ratio: 0.3}",
    "indenter": "{shape: cone, half_angle: 70.3}",
    "protocol": "{max_load: 1.0, loading_time: 30, unloading_time: 30}",
}
KEYS = (*SECTIONS, "kinematics", "mechanisms", "accuracy")


def specification_from(values: Mapping[str, Any]) -> Specification:
    """Build from the keys of a SPEC.yaml; `protocol` may also be a `Protocol`."""
    if not isinstance(values, Mapping):
        raise InputError("the specification is not a table of keys", remedy=f"give {', '.join(SECTIONS)}")
    for key in values:
        if key not in KEYS:
            raise InputError(f"unknown key {key!r}", remedy=f"use one of: {', '.join(KEYS)}", place=str(key))
    for key, example in SECTIONS.items():
        if not isinstance(values.get(key), Mapping | Protocol):
            problem = f"is {values[key]!r}, expected a table of keys" if key in values else "is missing"
            raise InputError(f"{key} {problem}", remedy=f"write such as {key}: {example}", place=key)
    material = dict(values["material"])
    model = material.pop("model", None)
    try:
        indenter = Indenter.from_mapping(values["indenter"])
    except InputError as error:
        place = f"indenter.{error.place}" if error.place else "indenter"
        raise InputError(error.problem, remedy=error.remedy, place=place) from None
    protocol = values["protocol"]
    if not isinstance(protocol, Protocol):
        protocol = protocol_from(protocol)
    return Specification(
        str(model),
        material,
        indenter,
        protocol,
        kinematics=str(values.get("kinematics", "small")),
        accuracy=str(values.get("accuracy", "standard")),
        mechanisms=checked_mechanisms(values.get("mechanisms")),
    )


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated curve.

    Attributes
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm]; what answers is NaN from a failure on, under displacement control load and depth.
    status
        ``ok`` or ``failed``.
    reason
        Why it failed; empty otherwise.
    solver_seconds
        Wall time spent in the solver [s].
    quantity
        What answers to the drive: ``depth`` or ``load``.
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    status: str
    reason: str
    solver_seconds: float
    quantity: str = "depth"

    @property
    def response(self) -> np.ndarray:
        """What answers to the drive (n,): the depth [nm], or under displacement control the load [mN]."""
        return self.load if self.quantity == LOAD else self.depth


def simulate(specification: Specification, radii: np.ndarray | None = None) -> Simulation:
    """Simulate one indentation with its mechanisms; a solver failure is reported in the result, never raised.

    Parameters
    ----------
    radii : ndarray, optional
        Rings of one mesh [um], in place of those that suit the specification, see
        `palpate.fem.discretisation.mesh_radii`.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    return _simulation(specification, _indent(acting(specification), radii))


def _indent(
    solid: Specification,
    radii: np.ndarray | None = None,
    directions: Directions | None = None,
    observe: Callable[[Any, Any], None] | None = None,
) -> History:
    large = solid.kinematics == "large"
    if solid.protocol.control != LOAD:
        return _under_displacement(solid, radii, directions, observe)
    if not solid.indenter.of_revolution:
        if directions:
            raise axisymmetric_only("derivatives of the depth", "indenter.shape")
        resolution = RESOLUTIONS_3D[solid.accuracy]
        return indent_3d(solid.specimen, solid.indenter, solid.protocol, resolution, large, radii, observe)
    resolution = RESOLUTIONS[solid.accuracy]
    return indent(solid.specimen, solid.indenter, solid.protocol, resolution, large, radii, directions, observe)


def _under_displacement(
    solid: Specification,
    radii: np.ndarray | None,
    directions: Directions | None,
    observe: Callable[[Any, Any], None] | None,
) -> History:
    """Simulate one indentation whose displacement is prescribed, in the lanes of many.

    Raises
    ------
    InputError
        When anything but its curve is asked for.
    """
    wanted = {"a mesh of its own": radii, "derivatives": directions, "the fields in the body": observe}
    for words, given in wanted.items():
        if given is not None:
            raise InputError(
                f"displacement control does not go with {words}", remedy="prescribe the load", place="protocol.drive"
            )
    if not solid.indenter.of_revolution:
        raise axisymmetric_only("displacement control", "indenter.shape")
    return indent_batch([_case(solid)])[0]


def _simulation(specification: Specification, history: History) -> Simulation:
    """Return what is recorded of one simulated indentation."""
    protocol = specification.protocol
    time, depth, reason = protocol.sample_time, history.depth, history.reason
    load = protocol.sample_load if protocol.control == LOAD else history.load
    indenter = specification.indenter
    sunk = np.maximum.accumulate(depth) > indenter.radius
    if indenter.shape == "sphere" and sunk.any() and not reason:
        reason = (
            f"the sphere sinks in beyond its radius after {time[sunk.argmax()]:.4g} s; press less, or a larger sphere"
        )
        depth = np.where(sunk, np.nan, depth)
        load = load if protocol.control == LOAD else np.where(sunk, np.nan, load)
    depth = recorded(specification, depth, load)
    return Simulation(time, load, depth, "failed" if reason else "ok", reason, history.seconds, protocol.response)


def sensitivities(
    specification: Specification, parameters: Iterable[str], radii: np.ndarray | None = None
) -> tuple[Simulation, np.ndarray]:
    """Simulate one indentation together with the derivatives of its depth curve.

    They are the exact derivatives of the simulated curve on its mesh.

    Parameters
    ----------
    parameters
        Parameters of the material by name, of a mechanism of the specification as ``key.name``.
    radii : ndarray, optional
        As for `simulate`.

    Returns
    -------
    simulation : Simulation
    derivatives : ndarray, shape (n, p)
        Of the recorded depth by each parameter [nm per unit of the parameter]; NaN from a failure on.

    Raises
    ------
    InputError
        When there is no such parameter, or the depth has no derivative by it.
    """
    variations = {name: Variation.of(specification, name) for name in parameters}
    history = _indent(acting(specification), radii, directions(variations))
    columns = []
    for column, variation in zip(history.derivatives.T, variations.values(), strict=True):
        half = 0.5 * variation.width * column
        low = recorded(variation.low, history.depth - half, history.load)
        columns.append((recorded(variation.high, history.depth + half, history.load) - low) / variation.width)
    return _simulation(specification, history), np.stack(columns, axis=1)


def fields_at(specification: Specification, times: Iterable[float]) -> list[Fields]:
    """Simulate one indentation for displacement and stress at some times [s]; raises as `states_at`."""
    problem, states = states_at(specification, times)
    of = Fields.of if specification.indenter.of_revolution else fields_of
    return [of(problem, state) for state in states]


def states_at(specification: Specification, times: Iterable[float]) -> tuple[Any, list[Any]]:
    """Simulate one indentation for the states of the body at some times [s].

    Returns
    -------
    problem
        What does not change, such as the mesh: that of `palpate.fem.newton` or of `palpate.fem3d.newton`.
    states
        One for each of the times, which are sorted.

    Raises
    ------
    InputError
        When a time lies outside the test.
    PalpateError
        When the solver fails.
    """
    solid = acting(specification)
    wanted, protocol = np.unique(np.asarray(list(times), dtype=float)), solid.protocol
    if not np.all((wanted > 0) & (wanted <= protocol.knot_time[-1])):
        raise InputError(
            f"a time lies outside the test, which lasts {protocol.knot_time[-1]:g} s",
            remedy="give times above zero, up to its end",
            place="time",
        )
    found: list[tuple[Any, Any]] = []

    def keep(problem: Any, state: Any) -> None:
        if np.abs(wanted - state.time).min() <= 1e-9 * protocol.knot_time[-1]:
            found.append((problem, state))

    samples = np.union1d(protocol.sample_time, wanted)
    history = _indent(replace(solid, protocol=replace(protocol, sample_time=samples)), observe=keep)
    if history.reason:
        raise PalpateError(f"the simulation failed: {history.reason}")
    return found[0][0], [state for _, state in found]


def simulate_batch(specifications: Iterable[Specification], shift: float = 0.0) -> list[Simulation]:
    """Simulate several indentations, those that share the shape of mesh and load history together.

    Those that differ in size alone are simulated once. The curves are those of `simulate`, to rounding as long as both
    converge in the same steps; where one of them divides a step they differ as steps do, which at single points of a
    body that yields was up to 0.2 % of the largest depth. The solver's wall time is shared evenly. Where a pyramid is
    among the indenters, they are simulated one after another.

    Parameters
    ----------
    shift
        Part of the spacing of rings [-] by which all nodes lie further out: another mesh of the same accuracy, for
        curves that must not share the mesh of a fit. A pyramid keeps its mesh.
    """
    specifications = list(specifications)
    if not all(specification.indenter.of_revolution for specification in specifications):
        return [simulate(specification) for specification in specifications]
    histories = indent_distinct([replace(_case(acting(each)), shift=shift) for each in specifications])
    return [_simulation(*pair) for pair in zip(specifications, histories, strict=True)]


def alike(specification: Specification, other: Specification) -> bool:
    """Return whether two indentations differ in size at most, so that `simulate_batch` solves them once."""
    if specification is other:
        return True
    if not (specification.indenter.of_revolution and other.indenter.of_revolution):
        return False
    return length_ratio(_case(acting(specification)), _case(acting(other))) is not None


def _case(solid: Specification) -> Case:
    resolution = RESOLUTIONS[solid.accuracy]
    return Case(solid.specimen, solid.indenter, solid.protocol, resolution, solid.kinematics == "large")
