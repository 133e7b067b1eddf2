"""A whole load history on one mesh: march, halve what does not converge, return depth against time."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from palpate.errors import ConvergenceError
from palpate.fem.adhesion import Adhesion, grown, nodal_areas
from palpate.fem.clock import Clock
from palpate.fem.contact_size import check_size, contact_range, plane_strain_modulus
from palpate.fem.directions import Directions
from palpate.fem.discretisation import mesh_radii, step_times
from palpate.fem.folding import ever_wider
from palpate.fem.march import march_by
from palpate.fem.mesh import Resolution, polar_mesh
from palpate.fem.newton import Problem, State, Workspace, advance
from palpate.fem.profile import Profile
from palpate.fem.regions import laws_of, resolved
from palpate.fem.sensitivity import Sensitivity
from palpate.indenters import Indenter
from palpate.protocol import Protocol
from palpate.specimen import Specimen


@dataclass(frozen=True, eq=False)
class History:
    """Outcome of one simulated indentation.

    Attributes
    ----------
    depth : ndarray, shape (n,)
        Depth at the protocol's sampling times [nm]; NaN from a failure on.
    load : ndarray, shape (n,)
        Load there [mN]; likewise.
    reason
        Why the history is incomplete; empty when it is whole.
    seconds
        Wall time spent in the solver.
    iterations, steps
        Newton iterations and time steps done.
    derivatives : ndarray, shape (n, p)
        Of the depth, by each parameter asked for [nm per unit of the parameter]; NaN from a failure on.
    """

    depth: np.ndarray
    load: np.ndarray
    reason: str
    seconds: float
    iterations: int
    steps: int
    derivatives: np.ndarray


def attraction(specimen: Specimen, resolution: Resolution, largest: float, area: np.ndarray) -> Adhesion | None:
    """Return the adhesion of the specimen, ranged for the elements at the edge of the largest contact [um].

    Parameters
    ----------
    area : ndarray, shape (k,)
        Undeformed area of each surface node [um^2].
    """
    if specimen.adhesion == 0.0:
        return None
    modulus = plane_strain_modulus(specimen.coefficients)
    return Adhesion.of(specimen.adhesion, modulus, (resolution.growth - 1.0) * largest, area)


def indent(
    specimen: Specimen,
    indenter: Indenter,
    protocol: Protocol,
    resolution: Resolution,
    large: bool = False,
    radii: np.ndarray | None = None,
    directions: Directions | None = None,
    observe: Callable[[Problem, State], None] | None = None,
) -> History:
    """Simulate an indentation.

    Parameters
    ----------
    specimen, indenter, protocol, resolution
        What is pressed, by what, how, and how finely it is resolved.
    large
        Logarithmic instead of linear strains.
    radii : ndarray, optional
        Rings of the mesh [um], in place of `mesh_radii`; simulations that are compared closely should share theirs.
        Where the innermost fold they are merged, see `palpate.fem.folding`.
    directions : Directions, optional
        Derivatives of the inputs by the parameters for which those of the depth are wanted, on a mesh that stays.
    observe
        Called with the problem and the state at the end of every time step asked for, sampling times among them; from
        the beginning again, with another problem, after a failure.

    Returns
    -------
    History
        A failure of the solver is reported in it, never raised.

    Raises
    ------
    InputError
        When the mesh cannot hold the specimen or the tip, see `check_size`, or the depth has no derivative.
    """
    radii = mesh_radii(specimen, indenter, protocol, resolution) if radii is None else radii
    seconds = 0.0
    for rings in ever_wider(radii, specimen, indenter, resolution, large):
        history = indent_on(rings, specimen, indenter, protocol, resolution, large, directions, observe)
        seconds += history.seconds
        if not history.reason:
            break
    return replace(history, seconds=seconds)


def indent_on(
    radii: np.ndarray,
    specimen: Specimen,
    indenter: Indenter,
    protocol: Protocol,
    resolution: Resolution,
    large: bool = False,
    directions: Directions | None = None,
    observe: Callable[[Problem, State], None] | None = None,
) -> History:
    """Simulate an indentation on the mesh with rings at `radii` [um] and no other; see `indent`."""
    began = clock.perf_counter()
    largest = contact_range(specimen, indenter, protocol)[1]
    check_size(specimen, indenter, resolution, largest)
    mesh = polar_mesh(radii, resolution.sectors)
    specimen = resolved(specimen, indenter, radii[0])
    law, region = laws_of(specimen, mesh), np.zeros(len(mesh.elements), dtype=np.int64)
    adhesion = attraction(specimen, resolution, largest, nodal_areas(mesh.nodes[mesh.surface, 0]))
    problem = Problem(mesh, Profile.of(indenter), specimen, law, region, large, indenter.friction, adhesion)
    work = Workspace.of(problem)
    steps_of = partial(step_times, resolution=resolution, yields=specimen.yields)
    ends = steps_of(protocol)
    sensitivity = None
    if directions:
        moved = tuple((steps_of(shift.low), steps_of(shift.high)) for shift in directions.shifts)
        sensitivity = Sensitivity(problem, directions, Clock(ends, moved, directions.shifts, directions.count))
    state, before = State.initial(problem), None
    depth = np.full(len(protocol.sample_time), np.nan)
    derivatives = np.full((len(depth), directions.count if directions else 0), np.nan)
    reason, steps = "", 0
    corners = set(protocol.knot_time)
    for target in ends:
        try:
            state, before, taken = march(problem, protocol, state, before, target, work, sensitivity)
        except ConvergenceError as error:
            reason = str(error)
            break
        steps += taken
        where = np.searchsorted(protocol.sample_time, target * (1 - 1e-12))
        if where < len(depth) and abs(protocol.sample_time[where] - target) <= 1e-9 * target:
            depth[where] = state.depth * 1e3
            if sensitivity:
                derivatives[where] = sensitivity.depth * 1e3
        if observe is not None:
            observe(problem, state)
        if target in corners:
            before = None
    load = np.where(np.isnan(depth), np.nan, protocol.sample_load)
    return History(depth, load, reason, clock.perf_counter() - began, work.iterations, steps, derivatives)


def march(
    problem: Problem,
    protocol: Protocol,
    state: State,
    before: State | None,
    target: float,
    work: Workspace,
    sensitivity: Sensitivity | None = None,
) -> tuple[State, State, int]:
    """March to `target`, halving what does not converge; return the state there, the one before, and the steps."""

    def step(state: State, time: float, load: float, guess: State) -> State:
        return advance_or_ease(problem, state, time, load, protocol.max_load, guess, work)

    follow = partial(sensitivity.follow, work=work) if sensitivity else None
    return march_by(step, protocol, state, before, target, follow)


def advance_or_ease(
    problem: Problem, state: State, time: float, load: float, scale: float, guess: State, work: Workspace
) -> State:
    """Do what `advance` does; where it fails, carefully, or with an attraction that grows in parts."""
    try:
        return advance(problem, state, time, load, scale, guess, work)
    except ConvergenceError:
        if problem.adhesion is None:
            return advance(problem, state, time, load, scale, guess, work, careful=True)
    return grown(lambda eased, guess: advance(eased, state, time, load, scale, guess, work), problem, state)
