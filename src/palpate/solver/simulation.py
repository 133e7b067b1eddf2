"""Specification in, simulated curve out: material, contact, and whatever else the mechanisms add."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from palpate.errors import InputError, PalpateError, part_of
from palpate.mechanisms import MECHANISMS, checked_mechanisms
from palpate.observables import OBSERVABLES, response_to
from palpate.solver.axisymmetric.discretisation import FEW_SECTORS, RESOLUTIONS, SAME
from palpate.solver.axisymmetric.fields import Fields, Moment
from palpate.solver.axisymmetric.history import History
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch, run_lanes
from palpate.solver.axisymmetric.similar import free_lanes, indent_distinct, length_ratio
from palpate.solver.pyramid.fields_3d import fields_of
from palpate.solver.pyramid.indent_3d import RESOLUTIONS as RESOLUTIONS_3D
from palpate.solver.pyramid.indent_3d import indent_3d
from palpate.solver.variation import Variation, applied_to_body, applied_to_signal
from palpate.study.indenter import Indenter
from palpate.study.load_history import protocol_from
from palpate.study.protocol import LOAD, Protocol
from palpate.study.specification import KINEMATICS, Specification, axisymmetric_only

SECTIONS = {
    "material": "{model: elastic, youngs_modulus: 3.0, poisson_ratio: 0.3}",
    "indenter": "{shape: cone, half_angle: 70.3}",
    "protocol": "{max_load: 1.0, loading_time: 30, unloading_time: 30}",
}
KEYS = (*SECTIONS, "kinematics", "mechanisms", "accuracy")


def specification_from(values: Mapping[str, Any]) -> Specification:
    """Build from the keys of a SPEC.yaml; `protocol` may also be a `Protocol`; raises `InputError` with the place."""
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
    with part_of("indenter"):
        indenter = Indenter.from_mapping(values["indenter"])
    protocol = values["protocol"]
    if not isinstance(protocol, Protocol):
        protocol = protocol_from(protocol)
    mechanisms = checked_mechanisms(values.get("mechanisms"))
    for key in [key for key in mechanisms if MECHANISMS[key].tip]:
        raise InputError(
            f"{key}: a single test has one tip", remedy="leave the brackets out", place=f"mechanisms.{key}"
        )
    return Specification(
        str(model),
        material,
        indenter,
        protocol,
        kinematics=str(values.get("kinematics", KINEMATICS[0])),
        accuracy=str(values.get("accuracy", "standard")),
        mechanisms=mechanisms,
    )


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated curve.

    Attributes
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm]; from a failure on the response is NaN, under displacement control load and depth.
    status
        ``ok`` or ``failed``.
    reason
        Why it failed; empty otherwise.
    solver_seconds
        Wall time spent in the solver [s].
    quantity
        Name of the observable that is its response.
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
        """Response to the drive (n,), in the unit of its observable."""
        return OBSERVABLES[self.quantity].of_simulation(self)


def simulate(specification: Specification, radii: np.ndarray | None = None) -> Simulation:
    """Simulate one indentation with its mechanisms; a solver failure is reported in the result, never raised.

    Parameters
    ----------
    radii : ndarray, optional
        Rings of one mesh [um], in place of those that suit the specification, see
        `palpate.solver.axisymmetric.discretisation.mesh_radii`.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    solid = applied_to_body(specification)
    if solid.indenter.of_revolution:
        return _simulation(specification, indent_batch([_case(solid, radii)])[0])
    return _simulation(specification, _pyramid(solid, radii))


def _pyramid(
    solid: Specification, radii: np.ndarray | None = None, observe: Callable[[Any, Any], None] | None = None
) -> History:
    if solid.protocol.control != LOAD:
        raise axisymmetric_only("displacement control", "indenter.shape")
    resolution, large = RESOLUTIONS_3D[solid.accuracy], solid.kinematics == "large"
    return indent_3d(solid.specimen, solid.indenter, solid.protocol, resolution, large, radii, observe)


def _simulation(specification: Specification, history: History) -> Simulation:
    """Return what is recorded of one simulated indentation."""
    protocol = specification.protocol
    time, depth, reason = protocol.sample_time, history.depth, history.reason
    load = protocol.sample_load if protocol.control == LOAD else history.load
    indenter = specification.indenter
    sunk = np.fmax.accumulate(depth) > indenter.radius
    if indenter.shape == "sphere" and sunk.any():
        reason = (
            f"the sphere sinks in beyond its radius after {time[sunk.argmax()]:.4g} s; press less, or a larger sphere"
        )
        depth = np.where(sunk, np.nan, depth)
        load = load if protocol.control == LOAD else np.where(sunk, np.nan, load)
    depth = applied_to_signal(specification, depth, load)
    return Simulation(
        time, load, depth, "failed" if reason else "ok", reason, history.seconds, response_to(protocol).name
    )


def differentiated(
    specifications: Sequence[Specification],
    perturbed: Sequence[Sequence[Variation]],
    radii: np.ndarray | None = None,
    few_sectors: bool = False,
) -> list[tuple[Simulation, np.ndarray]]:
    """Simulate several indentations together with the derivatives by what their neighbours vary.

    They are the derivatives of the simulated curves on their meshes, see `palpate.solver.axisymmetric.neighbours`. What
    changes the instrument alone costs no simulation; those that differ in size alone are simulated once.

    Parameters
    ----------
    specifications
        The indentations.
    perturbed
        Neighbours of each indentation, as many as there are derivatives.
    radii : ndarray, optional
        As for `simulate`.
    few_sectors
        As for `simulate_batch`.

    Returns
    -------
    list of (Simulation, ndarray of shape (n, p))
        Derivatives of the recorded depth, under displacement control of the load, by each parameter [nm or mN per unit
        of the parameter]; NaN from a failure on.

    Raises
    ------
    InputError
        When the indenter is a pyramid.
    """
    if not all(specification.indenter.of_revolution for specification in specifications):
        raise axisymmetric_only("derivatives of the curve", "indenter.shape")
    solids = [applied_to_body(specification) for specification in specifications]
    bodies = [[applied_to_body(variation.neighbour) for variation in row] for row in perturbed]
    changes_body = [
        [k for k, other in enumerate(row) if not _same_body(solid, other)]
        for solid, row in zip(solids, bodies, strict=True)
    ]
    histories = indent_distinct(
        [_case(solid, radii, few_sectors) for solid in solids],
        [[_case(row[k], radii, few_sectors) for k in places] for row, places in zip(bodies, changes_body, strict=True)],
    )
    outcomes = []
    for specification, history, row, places in zip(specifications, histories, perturbed, changes_body, strict=True):
        simulation, columns = _simulation(specification, history), []
        for k, variation in enumerate(row):
            neighbour = history
            if k in places:
                place = places.index(k)
                neighbour = replace(history, depth=history.perturbed_depths[place], load=history.perturbed_loads[place])
            varied = _simulation(variation.neighbour, neighbour)
            columns.append((varied.response - simulation.response) / variation.step)
        outcomes.append((simulation, np.stack(columns, axis=1)))
    return outcomes


def _same_body(solid: Specification, other: Specification) -> bool:
    """Return whether two indentations differ in nothing that changes the body."""
    body = [f.name for f in fields(Specification) if f.init and f.name not in ("protocol", "mechanisms")]
    return solid.protocol is other.protocol and all(getattr(solid, name) == getattr(other, name) for name in body)


def fields_at(specification: Specification, times: Iterable[float]) -> list[Fields]:
    """Simulate one indentation for displacement and stress at some times [s]; errors are those of `states_at`."""
    if not specification.indenter.of_revolution:
        problem, states = states_at(specification, times)
        return [fields_of(problem, state) for state in states]
    solid, wanted = _sampled_at(specification, times)
    moments: list[Moment] = []
    for case in _case(solid).and_merged:
        moments.clear()
        history = run_lanes([case], observe=moments.append)[0]
        if not history.reason:
            break
    if history.reason:
        raise PalpateError(f"the simulation failed: {history.reason}")
    return [Fields.of(moment) for moment in moments if _among(moment.time, wanted, solid.protocol)]


def states_at(specification: Specification, times: Iterable[float]) -> tuple[Any, list[Any]]:
    """Simulate the indentation by a pyramid for the states of the body at some times [s].

    Returns
    -------
    problem
        What does not change, such as the mesh, see `palpate.solver.pyramid.problem_3d`.
    states
        One for each of the times, which are sorted.

    Raises
    ------
    InputError
        When a time lies outside the test.
    PalpateError
        When the solver fails.
    """
    solid, wanted = _sampled_at(specification, times)
    found: list[tuple[Any, Any]] = []

    def keep(problem: Any, state: Any) -> None:
        if _among(state.time, wanted, solid.protocol):
            found.append((problem, state))

    history = _pyramid(solid, observe=keep)
    if history.reason:
        raise PalpateError(f"the simulation failed: {history.reason}")
    return found[0][0], [state for _, state in found]


def _sampled_at(specification: Specification, times: Iterable[float]) -> tuple[Specification, np.ndarray]:
    """Return what is simulated, with some times [s] among those of its samples, and these in order."""
    solid = applied_to_body(specification)
    wanted, protocol = np.unique(np.asarray(list(times), dtype=float)), solid.protocol
    if not np.all((wanted > 0) & (wanted <= protocol.knot_time[-1])):
        raise InputError(
            f"a time lies outside the test, which lasts {protocol.knot_time[-1]:g} s",
            remedy="give times above zero, up to its end",
            place="time",
        )
    others = [time for time in protocol.sample_time if not _among(time, wanted, protocol)]
    samples = np.union1d(others, wanted)
    return replace(solid, protocol=replace(protocol, sample_time=samples)), wanted


def _among(time: float, wanted: np.ndarray, protocol: Protocol) -> bool:
    return bool(np.abs(wanted - time).min() <= SAME * protocol.knot_time[-1])


def simulate_batch(
    specifications: Iterable[Specification], shift: float = 0.0, few_sectors: bool = False
) -> list[Simulation]:
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
    few_sectors
        Whether the mesh has few sectors under the indenter, because the curves are to be scaled to others. A pyramid
        keeps its mesh.
    """
    specifications = list(specifications)
    if not all(specification.indenter.of_revolution for specification in specifications):
        return [simulate(specification) for specification in specifications]
    solids = [applied_to_body(each) for each in specifications]
    histories = indent_distinct([replace(_case(solid, None, few_sectors), shift=shift) for solid in solids])
    return [_simulation(*pair) for pair in zip(specifications, histories, strict=True)]


def points_per_batch(specifications: Sequence[Specification], few_sectors: bool = False) -> int:
    """Return how many indentations like each of these run in the time of one; those that differ in size are one."""
    if not all(specification.indenter.of_revolution for specification in specifications):
        return 1
    return free_lanes([_case(applied_to_body(each), None, few_sectors) for each in specifications])


def alike(specification: Specification, other: Specification) -> bool:
    """Return whether two indentations differ in size at most, so that `simulate_batch` solves them once."""
    if specification is other:
        return True
    if not (specification.indenter.of_revolution and other.indenter.of_revolution):
        return False
    return length_ratio(_case(applied_to_body(specification)), _case(applied_to_body(other))) is not None


def _case(solid: Specification, radii: np.ndarray | None = None, few_sectors: bool = False) -> Case:
    resolution = RESOLUTIONS[solid.accuracy]
    if few_sectors:
        resolution = replace(resolution, sectors=FEW_SECTORS)
    large = solid.kinematics == "large"
    return Case(solid.specimen, solid.indenter, solid.protocol, resolution, large, rings=radii)
