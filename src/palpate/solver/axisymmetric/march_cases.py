"""Many indentations at once: those that share the shape of mesh and load history run through the SIMD lanes together.

Under a sharp cone, meshes for different homogeneous materials differ by a factor on all lengths alone, and so do not
differ at all once each is measured in a unit of its own; nor do two meshes for one indentation, whatever it is.

Where the load history has a corner, and how many steps it takes, may differ from lane to lane. A step begins where the
last change carries it; where the load grows by much, at the last solution made wider and deeper
(`palpate.solver.axisymmetric.widening`). At large strains the last change is not carried on at the graded onset, nor in
the step after it: it could turn an element inside out. A lane that finds no equilibrium from there tries again from
where the last step ended, and then in parts.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from itertools import pairwise

import numpy as np

from palpate.solver.axisymmetric.adhesive_traction import attraction, nodal_areas
from palpate.solver.axisymmetric.bordered import System
from palpate.solver.axisymmetric.contact_size import check_size, expected_load, loaded_time
from palpate.solver.axisymmetric.discretisation import steps_of_samples
from palpate.solver.axisymmetric.drive import Drives
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.fields import Moment
from palpate.solver.axisymmetric.folding import upright
from palpate.solver.axisymmetric.history import History
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.law_lanes import Points
from palpate.solver.axisymmetric.march import March, States
from palpate.solver.axisymmetric.mesh import Mesh, polar_mesh
from palpate.solver.axisymmetric.neighbours import Neighbours
from palpate.solver.axisymmetric.newton import TIGHT, TOLERANCE
from palpate.solver.axisymmetric.profile import Profile
from palpate.solver.axisymmetric.regions import resolved
from palpate.solver.axisymmetric.regularisation import attraction_in_lanes, contact_of, elastic_excess, first_contact
from palpate.solver.axisymmetric.specimens import Specimens
from palpate.solver.axisymmetric.trend import Trend
from palpate.solver.axisymmetric.trial_state import Setup
from palpate.solver.axisymmetric.widening import Widening


def indent_batch(cases: Sequence[Case], perturbed: Sequence[Sequence[Case]] = ()) -> list[History]:
    """Simulate several indentations by indenters of revolution, those of a kind together in SIMD lanes.

    One that finds no equilibrium in the smallest parts of a step is simulated again with its innermost rings merged,
    where that may help.

    Parameters
    ----------
    perturbed
        For each case the same with each of some parameters changed a little, see
        `palpate.solver.axisymmetric.neighbours`.

    Raises
    ------
    InputError
        When a mesh cannot hold the specimen or the tip, see `palpate.solver.axisymmetric.contact_size.check_size`.
    """
    histories: dict[int, History] = {}
    kinds: dict[tuple, list[int]] = {}
    for number, case in enumerate(cases):
        kinds.setdefault(case.kind, []).append(number)
    for members in kinds.values():
        members.sort(key=lambda number: len(cases[number].times))
        for first in range(0, len(members), LANES):
            chosen = members[first : first + LANES]
            others = [perturbed[number] for number in chosen] if perturbed else []
            histories |= zip(chosen, _with_neighbours([cases[number] for number in chosen], others), strict=True)
    again = [number for number, case in enumerate(cases) if histories[number].reason and case.mergeable]
    if again:
        wider = [replace(cases[number], merged=cases[number].merged + 1) for number in again]
        others = [
            [replace(other, merged=case.merged) for other in perturbed[number]]
            for number, case in zip(again, wider, strict=True)
            if perturbed
        ]
        histories |= zip(again, indent_batch(wider, others), strict=True)
    return [history for _, history in sorted(histories.items())]


def _with_neighbours(cases: Sequence[Case], perturbed: Sequence[Sequence[Case]]) -> list[History]:
    """Simulate 1 to `LANES` cases of one kind with their neighbours, which share out the lanes that are left."""
    count = max(map(len, perturbed), default=0)
    if not count:
        return run_lanes(cases)
    copies = LANES // len(cases)
    rows = -(-count // copies)
    lanes = [case for case in cases for _ in range(copies)]
    others = [[*row, *[case] * (rows * copies - len(row))] for case, row in zip(cases, perturbed, strict=True)]
    ran = run_lanes(lanes, [[o for row in others for o in row[k * copies : (k + 1) * copies]] for k in range(rows)])
    histories = []
    for first, row in zip(range(0, len(lanes), copies), perturbed, strict=True):
        places = [divmod(parameter, copies) for parameter in range(len(row))]
        own, points = ran[first], len(ran[first].depth)
        depths = [ran[first + lane].perturbed_depths[place] for place, lane in places]
        loads = [ran[first + lane].perturbed_loads[place] for place, lane in places]
        histories.append(
            replace(
                own,
                seconds=copies * own.seconds,
                perturbed_depths=np.reshape(depths, (len(row), points)),
                perturbed_loads=np.reshape(loads, (len(row), points)),
            )
        )
    return histories


def run_lanes(
    cases: Sequence[Case], perturbed: Sequence[Sequence[Case]] = (), observe: Callable[[Moment], None] | None = None
) -> list[History]:
    """Simulate 1 to `LANES` indentations of one kind.

    Parameters
    ----------
    perturbed
        For each of some parameters the same indentations with that parameter changed a little, which are carried along
        on the same meshes and in the same steps, see `palpate.solver.axisymmetric.neighbours`.
    observe
        Called with the body of the first case at the end of each of its steps.
    """
    began = clock.perf_counter()
    for case in cases:
        check_size(case.specimen, case.indenter, case.resolution, case.contacts[1])
    lanes, others = padded(cases), [padded(row) for row in perturbed]
    units = np.array([case.radii[0] for case in lanes])
    mesh = polar_mesh(lanes[0].shape, lanes[0].resolution.sectors)
    body = Body.of(mesh)
    system = System.of(body, not any(case.indenter.friction for case in lanes))
    tolerance = TIGHT if perturbed else TOLERANCE
    march, states = begun(lanes, lanes, mesh, body, units, system, tolerance)
    neighbours = Neighbours.of(march, [begun(row, lanes, mesh, body, units, system, tolerance) for row in others])
    counts = np.array([len(case.times) for case in lanes])
    unloaded = np.array([case.unloaded_steps for case in lanes])
    sticking = np.array([case.specimen.adhesion > 0.0 for case in lanes])
    ends = np.stack([_prolonged(case.times, counts.max()) for case in lanes])
    times = np.column_stack([np.zeros(LANES), ends])
    carries = np.stack([np.resize(case.carries, counts.max()) for case in lanes], axis=1)
    start, alive = deepcopy(states), np.ones(LANES, dtype=bool)
    depths, loads = np.full((2, 1 + len(others), *ends.shape), np.nan)
    trend, widening = Trend.none(len(states.unknowns)), Widening.of(mesh, march.drives, times)
    reasons = [""] * LANES
    for k, (begin, end) in enumerate(pairwise(times.T)):
        start.take(states)
        before = states.unknowns
        alive &= k < counts
        going = alive & (sticking | (k >= unloaded))
        usual = trend.guess(end - begin, carries[k])
        found = march.step(states, begin, end, widening.guess(k, states, trend.last, usual, going & ~sticking), going)
        if perturbed:
            neighbours.follow(start, states, begin, end, found)
        lost = going & ~found
        if lost.any():
            parts = np.where(carries[k], 1, 2)
            found |= march.in_parts(states, start, begin, end, parts, lost, neighbours.follow if perturbed else None)
        if lanes[0].large:
            found &= upright(mesh, states.displacement)
        going &= found | (k >= unloaded)
        for failed in np.flatnonzero(going & ~found):
            reasons[failed] = f"no equilibrium beyond {begin[failed]:.4g} s"
        states.take(start, alive & ~going)
        alive &= found | ~going
        if not alive.any():
            break
        if observe and alive[0]:
            observe(Moment.of(mesh, lanes[0].large, states, float(end[0]), float(units[0])))
        trend = trend.followed(states.unknowns - before, end - begin, carries[k])
        for curve, reached in enumerate([states, *neighbours.states]):
            depths[curve, alive, k] = (reached.depth * units * 1e3)[alive]
            loads[curve, alive, k] = (reached.reaction * units**2)[alive]
    seconds = (clock.perf_counter() - began) / len(cases)
    histories = []
    for lane, case in enumerate(cases):
        corners = [moved[lane] for moved in neighbours.corners]
        depth, load = (_at_samples(case, curves[:, lane], corners) for curves in (depths, loads))
        histories.append(History(depth[0], load[0], reasons[lane], seconds, depth[1:], load[1:]))
    return histories


def _at_samples(case: Case, curves: np.ndarray, corners: Sequence[Mapping[float, float]]) -> np.ndarray:
    """Return the values (1 + p, n) at the samples of a case and of its neighbours from those after each step.

    Parameters
    ----------
    case
    curves : ndarray, shape (1 + p, steps)
    corners
        For each neighbour the times of steps that it takes elsewhere, and where [s].
    """
    places = steps_of_samples(case.times, case.protocol)
    found = curves[:, places]
    for values, steps, elsewhere in zip(found[1:], curves[1:], corners, strict=True):
        own = np.array([elsewhere.get(time, time) for time in case.times])
        moved = own[places] != case.times[places]
        values[moved] = np.interp(case.times[places][moved], own, steps[: len(own)])
    return found


def _prolonged(times: np.ndarray, count: int) -> np.ndarray:
    """Return the ends of `count` steps, of which those past the last of the `times` (n,) are as long as it was [s]."""
    step = times[-1] - (times[-2] if len(times) > 1 else 0.0)
    return np.append(times, times[-1] + step * np.arange(1, count - len(times) + 1))


def padded(cases: Sequence[Case]) -> list[Case]:
    """Return the cases, the last one repeated until there are `LANES`."""
    return [*cases, *[cases[-1]] * (LANES - len(cases))]


def begun(
    lanes: Sequence[Case], hosts: Sequence[Case], mesh: Mesh, body: Body, units: np.ndarray, system: System,
    tolerance: float,
) -> tuple[March, States]:  # fmt: skip
    """Return how `LANES` cases advance, and where they begin, on the mesh and with the first step of their hosts.

    Parameters
    ----------
    lanes
        A case for each lane.
    hosts
        The cases whose mesh and steps they share.
    mesh, body
        The mesh, and the body of it.
    units : ndarray, shape (LANES,)
        Unit of length of each lane [um].
    system
        Storage of the linear systems.
    tolerance
        Largest unbalanced force, as a share of the largest load.
    """
    large, resolution = hosts[0].large, hosts[0].resolution
    specimens = [resolved(case.specimen, case.indenter, unit) for case, unit in zip(lanes, units, strict=True)]
    bodies = Specimens.of(specimens, mesh, units)
    area = nodal_areas(mesh.nodes[mesh.surface, 0])
    contacts = [case.contacts for case in hosts]
    sticking = [
        attraction(case.specimen, resolution, case.contacts[1], area) if case.specimen.adhesion else None
        for case in lanes
    ]
    expected = [expected_load(c.specimen.coefficients, c.indenter, c.protocol) for c in hosts]
    protocols, adhesive = [case.protocol for case in lanes], np.array([a is not None for a in sticking])
    drives = Drives.of(protocols, expected, adhesive, units)
    profiles = [Profile.of(case.indenter).in_units_of(unit) for case, unit in zip(lanes, units, strict=True)]
    ranges = np.array(contacts).T / units
    contact = contact_of(
        profiles, np.array([elastic_excess(c.specimen, c.indenter, c.protocol) for c in lanes]),
        [case.indenter.friction for case in lanes], attraction_in_lanes(sticking, units, len(area)),
        np.stack([body.distance, area]), ranges, resolution.growth, resolution.sectors,
    )  # fmt: skip
    first = np.array([case.times[0] for case in hosts])
    loaded = np.array([case.times[case.unloaded_steps] for case in hosts])
    touching = first_contact(
        profiles, specimens, list(map(loaded_time, protocols)), body.distance, ranges[0],
        np.where((drives.depth_weight != 0.0) | adhesive, 0.0, drives.equation(loaded)[2]),
    )  # fmt: skip
    radii = np.sqrt(touching.area / np.pi)
    depth = np.array([float(profile(a)[0]) for profile, a in zip(profiles, radii, strict=True)])
    onset = np.stack([touching.area, depth])
    march = March(
        Setup(large or None, body, contact), bodies, drives, units, system, tolerance, onset,
        np.array([c.halvings for c in hosts]),
    )  # fmt: skip
    states = States(
        Points.unloaded(4 * len(mesh.elements), bodies.elements, bodies.backed),
        touching,
        *bodies.at(np.zeros(LANES), first),
        np.zeros((mesh.size + 1, LANES)),
        np.zeros(LANES),
        np.zeros(LANES),
    )
    return march, states
