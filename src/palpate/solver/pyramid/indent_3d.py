"""A whole load history in three dimensions: choose the mesh, march, return depth against time."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from palpate.base.threads import on_one_thread
from palpate.errors import ConvergenceError
from palpate.solver.axisymmetric.adhesive_traction import attraction
from palpate.solver.axisymmetric.contact_size import check_size, contact_range
from palpate.solver.axisymmetric.discretisation import mesh_radii, step_times, steps_of_samples
from palpate.solver.axisymmetric.history import History
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.axisymmetric.regions import resolved
from palpate.solver.pyramid.adhesion_3d import nodal_areas
from palpate.solver.pyramid.march_3d import march_by
from palpate.solver.pyramid.mesh_3d import wedge_mesh
from palpate.solver.pyramid.newton_3d import advance
from palpate.solver.pyramid.problem_3d import Problem3D, State, Workspace
from palpate.solver.pyramid.shell import shell
from palpate.solver.pyramid.tip_3d import tip_of
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specimen import Specimen

RESOLUTIONS = {
    "standard": Resolution(growth=1.10, sectors=9),
    "medium": Resolution(growth=1.08, sectors=12),
    "fine": Resolution(growth=1.07, sectors=15, far=4000.0, outer_growth=1.2, refine=2),
    "finest": Resolution(growth=1.06, sectors=18, far=4000.0, outer_growth=1.2, refine=3),
}
LEAST_PART = 1 / 32  # of the attraction, the least growth that is tried


@on_one_thread
def indent_3d(
    specimen: Specimen,
    indenter: Indenter,
    protocol: Protocol,
    resolution: Resolution,
    large: bool = False,
    radii: np.ndarray | None = None,
    observe: Callable[[Problem3D, State], None] | None = None,
) -> History:
    """Simulate an indentation by any indenter with three mirror planes.

    Parameters
    ----------
    specimen, indenter, protocol, resolution
        What is pressed, by what, how, and how finely it is resolved.
    large
        Whether strains and rotations are large.
    radii : ndarray, optional
        Of the shells of the mesh [um], in place of `palpate.solver.axisymmetric.discretisation.mesh_radii`.
    observe
        Called with the problem and the state at the end of every time step asked for, sampling times among them.

    Returns
    -------
    History
        A failure of the solver is reported in it, never raised.

    Raises
    ------
    InputError
        When the mesh cannot hold the specimen or the tip, see `palpate.solver.axisymmetric.contact_size.check_size`.
    """
    began = clock.perf_counter()
    largest = contact_range(specimen, indenter, protocol)[1]
    check_size(specimen, indenter, resolution, largest)
    radii = mesh_radii(specimen, indenter, protocol, resolution) if radii is None else radii
    mesh = wedge_mesh(radii, shell(resolution.sectors))
    specimen = resolved(specimen, indenter, radii[0])
    adhesion = attraction(specimen, resolution, largest, nodal_areas(mesh)) if specimen.adhesion else None
    problem = Problem3D.of(mesh, tip_of(indenter), specimen, indenter.friction, large, adhesion)
    step = partial(advance_or_ease, problem, Workspace.of(problem), protocol.max_load)
    state, before = State.initial(problem), None
    ends = step_times(protocol, resolution, specimen.yields)
    samples, depth = steps_of_samples(ends, protocol), np.full(len(protocol.sample_time), np.nan)
    reason = ""
    for k, target in enumerate(ends):
        try:
            state, before = march_by(step, protocol, state, before, target)
        except ConvergenceError as error:
            reason = str(error)
            break
        depth[samples == k] = state.depth * 1e3
        if observe is not None:
            observe(problem, state)
        if target in protocol.knot_time:
            before = None
    load = np.where(np.isnan(depth), np.nan, protocol.sample_load)
    return History(depth, load, reason, clock.perf_counter() - began, *np.empty((2, 0, len(depth))))


def advance_or_ease(
    problem: Problem3D, work: Workspace, scale: float, state: State, time: float, load: float, guess: State
) -> State:
    """Do what `advance` does; where attraction keeps it from converging, let that grow in parts.

    Each part repeats the whole step and begins where the part before it ended, so only the last one counts. Arguments,
    result and errors are those of `palpate.solver.pyramid.newton_3d.advance`.
    """
    try:
        return advance(problem, work, scale, state, time, load, guess)
    except ConvergenceError:
        if (adhesion := problem.adhesion) is None:
            raise
    done, more, guess = -0.25, 0.25, state
    while done < 1.0:
        part = min(done + more, 1.0)
        eased = replace(problem, adhesion=adhesion.weakened(part))
        try:
            guess = advance(eased, work, scale, state, time, load, guess)
            done, more = part, 1.5 * more
        except ConvergenceError:
            more *= 0.5
            if more < LEAST_PART or done < 0.0:
                raise
    return guess
