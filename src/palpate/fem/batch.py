"""Many indentations at once: those that share the shape of mesh and load history run through the SIMD lanes together.

Under a sharp cone, meshes for different materials differ by a factor on all lengths alone, and so do not differ at all
once each is measured in a unit of its own. At large strains each step of the graded onset, and the one after it,
begins where the last one ended: carried on, it could turn an element inside out, and lanes cannot halve a step.
"""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cached_property

import numpy as np

from palpate.fem.batch_contact import Touch
from palpate.fem.batch_element import Body
from palpate.fem.batch_law import Points, law_rows, turn, weight_rows
from palpate.fem.batch_newton import advance
from palpate.fem.batch_vector import LANES
from palpate.fem.indent import GRADED_START, History, indent, mesh_radii, step_times
from palpate.fem.mesh import Resolution, polar_mesh
from palpate.indenters import Indenter
from palpate.materials.law import NO_YIELD
from palpate.materials.radial import YIELD
from palpate.protocol import Protocol
from palpate.specimen import Specimen


@dataclass(frozen=True, eq=False)
class Case:
    """The arguments of `palpate.fem.indent.indent`, with a `shift` of all nodes outwards, in rings, for its mesh."""

    specimen: Specimen
    indenter: Indenter
    protocol: Protocol
    resolution: Resolution
    large: bool = False
    shift: float = 0.0

    @property
    def suits(self) -> bool:
        """Whether it can be batched: a sharp cone without friction, a homogeneous body, no yielding.

        What any other property of specimen or indenter might do is unknown here, so each must have its default.
        """
        usual = all(
            getattr(thing, field.name) == field.default
            for thing in (self.specimen, self.indenter)
            for field in fields(thing)
            if field.default is not MISSING and field.name != "half_angle"
        )
        flows = self.specimen.coefficients[YIELD] < NO_YIELD
        return usual and not flows and self.indenter.shape == "cone"

    @cached_property
    def radii(self) -> np.ndarray:
        """Radii of the rings of nodes [um]."""
        usual = mesh_radii(self.specimen, self.indenter, self.protocol, self.resolution)
        return usual * self.resolution.growth**self.shift

    def alone(self) -> History:
        """Simulate it by itself."""
        return indent(self.specimen, self.indenter, self.protocol, self.resolution, self.large, self.radii)

    @cached_property
    def times(self) -> np.ndarray:
        """Ends of the time steps [s]."""
        return step_times(self.protocol, self.resolution.refine)

    @cached_property
    def corners(self) -> np.ndarray:
        """Which steps end at a corner of the load history."""
        return np.isin(self.times, self.protocol.knot_time)

    @property
    def kind(self) -> tuple:
        """What cases that run together have in common."""
        radii = self.radii
        shape = np.round(np.log(radii / radii[0]), 6).tobytes()
        return self.large, self.resolution, shape, self.corners.tobytes(), len(self.specimen.coefficients)


def indent_batch(cases: Sequence[Case]) -> list[History]:
    """Simulate several indentations: in SIMD lanes those that suit, by `palpate.fem.indent.indent` all others.

    A lane that finds no equilibrium in one of its steps is simulated again alone, where steps can be halved.

    Raises
    ------
    InputError
        See `palpate.fem.indent.indent`.
    """
    histories: dict[int, History] = {}
    kinds: dict[tuple, list[int]] = {}
    for number, case in enumerate(cases):
        if case.suits:
            kinds.setdefault(case.kind, []).append(number)
    for members in kinds.values():
        for first in range(0, len(members), LANES):
            chosen = members[first : first + LANES]
            if len(chosen) > 1:
                found = run_lanes([cases[number] for number in chosen])
                histories |= {number: history for number, history in zip(chosen, found, strict=True) if history}
    return [histories.get(number) or case.alone() for number, case in enumerate(cases)]


def run_lanes(cases: Sequence[Case]) -> list[History | None]:
    """Simulate 2 to `LANES` indentations of one kind; None for each that finds no equilibrium."""
    began = clock.perf_counter()
    lanes = [*cases, *[cases[-1]] * (LANES - len(cases))]
    units = np.array([case.radii[0] for case in lanes])
    resolution = lanes[0].resolution
    mesh = polar_mesh(lanes[0].radii / units[0], resolution.sectors)
    body = Body.of(mesh)
    coefficients = np.stack([case.specimen.coefficients for case in lanes])
    law, corners = law_rows(coefficients), lanes[0].corners
    times = np.stack([case.times for case in lanes])
    loads = np.stack([case.protocol.load_at(case.times) for case in lanes]) / units[:, None] ** 2
    scale = np.array([case.protocol.max_load for case in lanes]) / units**2
    steps = np.diff(times, axis=1, prepend=0.0)
    points = Points.unloaded(4 * len(mesh.elements), len(law) - 3)
    touch = Touch.at_apex(np.array([case.indenter.slope for case in lanes]), len(mesh.surface))
    displacement, depth = np.zeros((mesh.size + 1, LANES)), np.zeros(LANES)
    change, deepening = np.zeros_like(displacement), np.zeros(LANES)
    band = np.empty((body.size * body.width + 1, LANES))
    alive, spent = np.ones(LANES, dtype=bool), np.zeros(LANES, dtype=np.int64)
    depths = np.full((LANES, times.shape[1]), np.nan)
    weights = weight_rows(coefficients, steps[:, 0])
    for k in range(times.shape[1]):
        free = k > (len(GRADED_START) + 1 if lanes[0].large else 0) and not corners[k - 1]
        carried = steps[:, k] / steps[:, k - 1] if free else np.zeros(LANES)
        before, shallower = displacement, depth
        displacement, depth = displacement + carried * change, depth + carried * deepening
        advance(
            lanes[0].large, body, points, touch, law, weights, loads[:, k].copy(), scale, displacement, depth, band,
            alive, spent,
        )  # fmt: skip
        change, deepening = displacement - before, depth - shallower
        depths[:, k] = depth * units * 1e3
        if k + 1 < times.shape[1]:
            following = weight_rows(coefficients, steps[:, k + 1])
            turn(points, law, weights, following)
            weights = following
    seconds = (clock.perf_counter() - began) / len(cases)
    return [
        History(curve, "", seconds, int(count), times.shape[1], np.empty((len(curve), 0))) if whole else None
        for curve, whole, count in zip(map(sampled, cases, times, depths), alive, spent, strict=False)
    ]


def sampled(case: Case, times: np.ndarray, depths: np.ndarray) -> np.ndarray:
    """Return the depths at the protocol's sampling times."""
    wanted = case.protocol.sample_time
    return depths[np.searchsorted(times, wanted * (1 - 1e-9))]
