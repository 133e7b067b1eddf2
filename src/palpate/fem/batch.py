"""Many indentations at once: those that share the shape of mesh and load history run through the SIMD lanes together.

Under a sharp cone, meshes for different homogeneous materials differ by a factor on all lengths alone, and so do not
differ at all once each is measured in a unit of its own; nor do two meshes for one indentation, whatever it is.

Where the load history has a corner may differ from lane to lane. At large strains each step of the graded onset, and
the one after it, begins where the last one ended: carried on, it could turn an element inside out. A lane that finds no
equilibrium from where its last change carried it tries again from where the last step ended, and then in parts.
"""

from __future__ import annotations

import time as clock
from collections.abc import Iterable, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from palpate.fem.adhesion import nodal_areas
from palpate.fem.batch_drive import Drives
from palpate.fem.batch_element import Body
from palpate.fem.batch_law import Points
from palpate.fem.batch_march import March, States
from palpate.fem.batch_regularisation import contact_of, elastic_excess, first_contact
from palpate.fem.batch_specimens import Specimens
from palpate.fem.batch_trend import Trend
from palpate.fem.batch_vector import LANES
from palpate.fem.contact_size import check_size, contact_range, expected_load
from palpate.fem.discretisation import GRADED_START, mesh_radii, step_times
from palpate.fem.folding import merged, mergings
from palpate.fem.indent import History, attraction, indent_on
from palpate.fem.mesh import Resolution, polar_mesh
from palpate.fem.profile import Profile
from palpate.fem.regions import resolved
from palpate.indenters import Indenter
from palpate.materials.flow.row import structure
from palpate.protocol import LOAD, Protocol
from palpate.specimen import Specimen


@dataclass(frozen=True, eq=False)
class Case:
    """The arguments of `palpate.fem.indent.indent`, and what becomes of its mesh.

    All nodes have a `shift` outwards, in rings; the innermost rings are `merged` so many times.
    """

    specimen: Specimen
    indenter: Indenter
    protocol: Protocol
    resolution: Resolution
    large: bool = False
    shift: float = 0.0
    merged: int = 0

    @property
    def largest(self) -> float:
        """Largest contact radius [um]."""
        return contact_range(self.specimen, self.indenter, self.protocol)[1]

    @property
    def smallest(self) -> float:
        """Smallest contact radius that counts [um]."""
        return contact_range(self.specimen, self.indenter, self.protocol)[0]

    @cached_property
    def radii(self) -> np.ndarray:
        """Radii of the rings of nodes [um]."""
        usual = mesh_radii(self.specimen, self.indenter, self.protocol, self.resolution)
        rings = merged(usual, self.resolution, not self.indenter.sharp, self.merged)
        return rings * self.resolution.growth**self.shift

    @property
    def mergeable(self) -> bool:
        """Whether its innermost rings may be merged once more."""
        return self.merged < mergings(self.specimen, self.large)

    def alone(self) -> History:
        """Simulate it by itself; what the lanes alone can do ends there."""
        if self.protocol.control != LOAD:
            unknown = np.full(len(self.protocol.sample_time), np.nan)
            return History(unknown, unknown, "no equilibrium", 0.0, 0, 0, np.empty((len(unknown), 0)))
        return indent_on(self.radii, self.specimen, self.indenter, self.protocol, self.resolution, self.large)

    @cached_property
    def times(self) -> np.ndarray:
        """Ends of the time steps [s]."""
        return step_times(self.protocol, self.resolution, self.specimen.yields)

    @property
    def carries(self) -> np.ndarray:
        """Whether each step may carry the last change on: not from a corner of the load history, nor at the onset."""
        corners = np.isin(self.times, self.protocol.knot_time)
        steps_loaded = np.cumsum(self.protocol.drive_at(self.times) > 0.0)
        return ~np.append(True, corners[:-1]) & (steps_loaded > (len(GRADED_START) + 2 if self.large else 0))

    @property
    def kind(self) -> tuple:
        """What cases that run together have in common."""
        radii = self.radii
        shape = np.round(np.log(radii / radii[0]), 6).tobytes()
        body = self.large, structure(self.specimen.coefficients), self.specimen.substrate is None
        surface = self.indenter.friction > 0.0, self.specimen.adhesion > 0.0
        return self.resolution, shape, len(self.times), body, surface


def indent_batch(cases: Sequence[Case]) -> list[History]:
    """Simulate several indentations by indenters of revolution: in SIMD lanes those of a kind, others alone.

    A lane that finds no equilibrium in the smallest parts of a step is simulated again: with its innermost rings merged
    where that may help, alone else.

    Raises
    ------
    InputError
        See `palpate.fem.indent.indent`.
    """
    histories: dict[int, History | None] = {}
    kinds: dict[tuple, list[int]] = {}
    for number, case in enumerate(cases):
        kinds.setdefault(case.kind, []).append(number)
    for members in kinds.values():
        for first in range(0, len(members), LANES):
            chosen = members[first : first + LANES]
            if len(chosen) > 1 or cases[chosen[0]].protocol.control != LOAD:
                histories |= zip(chosen, run_lanes([cases[number] for number in chosen]), strict=True)
    again = []
    for number, case in enumerate(cases):
        if number not in histories or not (histories[number] or case.mergeable):
            histories[number] = case.alone()
        if case.mergeable and ((history := histories[number]) is None or history.reason):
            again.append(number)
    if again:
        wider = [replace(cases[number], merged=cases[number].merged + 1) for number in again]
        histories |= zip(again, indent_batch(wider), strict=True)
    return [history for _, history in sorted(histories.items()) if history]


def run_lanes(cases: Sequence[Case]) -> list[History | None]:
    """Simulate 1 to `LANES` indentations of one kind; None for each that finds no equilibrium."""
    began = clock.perf_counter()
    for case in cases:
        check_size(case.specimen, case.indenter, case.resolution, case.largest)
    lanes = [*cases, *[cases[-1]] * (LANES - len(cases))]
    units = np.array([case.radii[0] for case in lanes])
    protocols = [case.protocol for case in lanes]
    large, resolution = lanes[0].large, lanes[0].resolution
    mesh = polar_mesh(lanes[0].radii / units[0], resolution.sectors)
    specimens = [resolved(case.specimen, case.indenter, unit) for case, unit in zip(lanes, units, strict=True)]
    body, bodies = Body.of(mesh), Specimens.of(specimens, mesh, units)
    area = nodal_areas(mesh.nodes[mesh.surface, 0])
    sticking = [attraction(c.specimen, resolution, c.largest, area) for c in lanes]
    expected = [expected_load(c.specimen, c.indenter, c.protocol) for c in lanes]
    drives = Drives.of(protocols, expected, np.array([a is not None for a in sticking]), units)
    friction = [case.indenter.friction for case in lanes]
    band, (iterations, steps) = np.empty((body.size * body.width + 1, LANES)), np.zeros((2, LANES), dtype=np.int64)
    upper = np.empty_like(band) if any(friction) else np.empty((0, LANES))
    profiles = [Profile.of(case.indenter).in_units_of(unit) for case, unit in zip(lanes, units, strict=True)]
    smallest = np.array([case.smallest for case in lanes]) / units
    excess = np.array([elastic_excess(c.specimen, c.indenter, c.protocol) for c in lanes])
    contact = contact_of(
        profiles, excess, friction, sticking, units, body.distance, area, smallest, lanes[0].largest / units[0],
        resolution.growth,
    )  # fmt: skip
    march = March(large, body, bodies, contact, drives, units, band, upper, iterations, steps)
    ends = np.stack([case.times for case in lanes])
    times = np.column_stack([np.zeros(LANES), ends])
    carries = np.stack([case.carries for case in lanes], axis=1)
    durations = [float(protocol.knot_time[-1]) for protocol in protocols]
    states = States(
        Points.unloaded(4 * len(mesh.elements), bodies.elements),
        first_contact(profiles, [case.specimen for case in lanes], durations, body.distance, smallest),
        *bodies.at(np.zeros(LANES), times[:, 1]),
        np.zeros((mesh.size + 1, LANES)),
        np.zeros(LANES),
        np.zeros(LANES),
    )
    start, alive = deepcopy(states), np.ones(LANES, dtype=bool)
    depths, loads = np.full((2, *ends.shape), np.nan)
    trend = Trend.none(mesh.size + 1)
    for k, (begin, end) in enumerate(pairwise(times.T)):
        start.take(states)
        before = np.vstack([states.displacement, states.depth])
        found = march.step(states, begin, end, *trend.guess(end - begin, carries[k]), alive)
        lost = alive & ~found
        if lost.any():
            found |= march.in_parts(states, start, begin, end, np.where(carries[k], 1, 2), lost)
        alive = found
        if not alive.any():
            break
        trend = trend.followed(np.vstack([states.displacement, states.depth]) - before, end - begin, carries[k])
        depths[:, k], loads[:, k] = states.depth * units * 1e3, states.reaction * units**2
    seconds = (clock.perf_counter() - began) / len(cases)
    histories: list[History | None] = []
    for case, taken, curves, whole, tried, steps_taken in zip(
        cases, ends, zip(depths, loads, strict=True), alive, iterations, steps, strict=False
    ):
        depth, load = sampled(case, taken, curves)
        unasked = np.empty((len(depth), 0))
        history = History(depth, load, "", seconds, int(tried), int(steps_taken), unasked)
        histories.append(history if whole else None)
    return histories


def sampled(case: Case, times: np.ndarray, curves: Iterable[np.ndarray]) -> list[np.ndarray]:
    """Return some curves at the protocol's sampling times."""
    places = np.searchsorted(times, case.protocol.sample_time * (1 - 1e-9))
    return [curve[places] for curve in curves]
