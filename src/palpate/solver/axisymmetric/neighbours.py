"""Indentations a little beside others, carried along with them: exact derivatives by any parameter.

The equations of equilibrium hold at every value of a parameter p. Their total derivative by p is linear in that of the
displacements, with the tangent of Newton's method, so that a converged step whose matrix is factored already costs one
more solution for each parameter (Michaleris, Tortorelli & Vidal, Int. J. Numer. Meth. Engng 37 (1994) 2471-2499,
section 3). Here the right-hand side is not derived term by term. A neighbour, whose parameter is changed a little, has
a history of its own, and its residual where its host has just arrived is that right-hand side times the change.
Newton's correction with the factor of the host then brings it to its own equilibrium.
Whatever a law, a tip, a film, friction, adhesion or the drive does, its derivative follows without a line of its own.

Where these corrections do not bring it there, as where the tip leaves the surface, it is solved with its own matrices
instead, and where that fails, too, it is NaN from there on. In a metal that hardly hardens, under a cap smaller than
the contact, the solution itself is not smooth in the parameters, and the derivative is of no use.

A neighbour keeps the mesh and the steps of its host, so its curve is that of the same discretisation. Only a step that
ends at a corner of the host's load history ends at that of the neighbour's own, where the parameter moves it: between
steps its largest load would be missed.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from numba import njit

from palpate.materials.flow.radial import UNKNOWN
from palpate.solver.axisymmetric.contact import contact_forces, end_step
from palpate.solver.axisymmetric.contact_coupling import no_coupling
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.march import March, States
from palpate.solver.axisymmetric.newton import (
    LARGEST_CHANGE,
    advance,
    direct,
    factor,
    imbalance,
    measure,
    no_direction,
    no_residual,
    solve_for,
    unbalance,
)
from palpate.solver.axisymmetric.trial_state import Prescribed
from palpate.study.protocol import Protocol

CORRECTIONS = 2  # with the factor of the host, whose matrix is not exactly the neighbour's
CORRECTIONS_WITH_FRICTION = 8  # between sticking and slipping the matrix changes more
LARGEST_MISS = 3e-7  # of the largest load, what corrections may leave: a hundredth of what a change of 3e-5 unbalances
NEAR = 1e-3  # of the test, within which a corner is the same one, moved


@dataclass(eq=False)
class Neighbours:
    """Neighbours of `LANES` indentations, one for each of some parameters.

    Parameters
    ----------
    host : March
    marches
        How each advances.
    states
        Where each has arrived.
    corners
        Of each, in each lane, corners of the host's load history that it has elsewhere, and where [s].
    """

    host: March
    marches: Sequence[March]
    states: list[States]
    corners: list[list[dict[float, float]]]

    @classmethod
    def of(cls, host: March, begun: Sequence[tuple[March, States]]) -> Neighbours:
        """Return neighbours that have just begun."""
        hosts = host.drives.protocols
        corners = [list(map(moved_corners, hosts, march.drives.protocols)) for march, _ in begun]
        return cls(host, [march for march, _ in begun], [states for _, states in begun], corners)

    def times(self, k: int, times: np.ndarray) -> np.ndarray:
        """Return the time that neighbour number k has reached at `times` of its hosts (LANES,) [s]."""
        return np.array([moved.get(time, time) for moved, time in zip(self.corners[k], times.tolist(), strict=True)])

    def follow(self, start: States, arrived: States, begin: np.ndarray, end: np.ndarray, lanes: np.ndarray) -> None:
        """Advance in some `lanes` (LANES,), whose hosts went from the `start` to where they `arrived`; times in s.

        Parameters
        ----------
        start, arrived
            States of the hosts before and after the step.
        begin, end : ndarray, shape (LANES,)
            Times of the hosts [s].
        lanes : ndarray of bool, shape (LANES,)
            Which take part.
        """
        factored = False
        for k, march in enumerate(self.marches):
            if not factored:
                trial = arrived.trial._replace(reaction=np.zeros(LANES))
                refactor(self.host.setup, arrived.material, trial, self.host.system)
            states = self.states[k] if lanes.all() else deepcopy(self.states[k])
            # The guess: the neighbour stays as far from its host as it was at the start of the step.
            away, deeper = states.displacement - start.displacement, states.depth - start.depth
            wider = states.contact.area - start.contact.area
            own_begin, own_end = self.times(k, begin), self.times(k, end)
            march.open(states, own_begin, own_end)
            states.displacement, states.depth = arrived.displacement + away, arrived.depth + deeper
            states.contact.area[:] = arrived.contact.area + wider
            times = CORRECTIONS_WITH_FRICTION if march.setup.contact.friction.any() else CORRECTIONS
            prescribed = march.prescribed(own_end)
            missed = correct(march.setup, states.material, states.trial, prescribed, march.system, lanes, times)
            # The host's factor serves all neighbours until one that is lost overwrites it; the next factors anew.
            lost = lanes & (missed > LARGEST_MISS)
            factored = not lost.any()
            if not factored:
                solve_alone(march, states, arrived, prescribed, lost)
            end_step(march.setup, states.trial)
            if states is not self.states[k]:
                self.states[k].take(states, lanes)


def moved_corners(host: Protocol, other: Protocol) -> dict[float, float]:
    """Return the corners of a load history that another, nearly the same, has elsewhere, and where [s]."""
    nearest = other.knot_time[np.abs(host.knot_time[:, None] - other.knot_time).argmin(axis=1)]
    moved = (nearest != host.knot_time) & (np.abs(nearest - host.knot_time) < NEAR * host.knot_time[-1])
    return dict(zip(host.knot_time[moved].tolist(), nearest[moved].tolist(), strict=True))


def solve_alone(march: March, states: States, arrived: States, prescribed: Prescribed, lost: np.ndarray) -> None:
    """Solve some lanes of a neighbour from where their hosts arrived, with matrices of its own; NaN where that fails.

    Parameters
    ----------
    march, states
        How the neighbour advances, and its states in an open step.
    arrived
        States of the hosts.
    prescribed
        What the neighbour has to meet.
    lost : ndarray of bool, shape (LANES,)
        Which lanes.
    """
    np.copyto(states.displacement, arrived.displacement, where=lost)
    np.copyto(states.depth, arrived.depth, where=lost)
    np.copyto(states.contact.area, arrived.contact.area, where=lost)
    np.copyto(states.points.log_q, 2.0 * UNKNOWN, where=lost)
    found, still = lost.copy(), np.zeros((len(states.displacement) + 2, LANES))
    stride = march.stride(states, still)
    advance(march.setup, states.material, states.trial, prescribed, march.system, stride, found)
    states.depth[lost & ~found] = np.nan


@njit(cache=True, error_model="numpy", nogil=True)
def refactor(setup, material, trial, system):
    """Factor the matrix at a solution; the parameters are those of `palpate.solver.axisymmetric.newton.advance`.

    The reaction of the `trial` is written.
    """
    forces, coupling = np.zeros((setup.body.size + 1, LANES)), no_coupling(setup.body.radial.shape[0])
    contact_forces(setup, trial, forces, coupling)
    factor(setup, material, trial, system, coupling, np.ones(LANES), forces, np.zeros_like(forces))


@njit(cache=True, error_model="numpy", nogil=True)
def correct(setup, material, trial, prescribed, system, lanes, times):
    """Bring lanes that lie close to a solution to equilibrium, by some iterations with the factor that it left.

    Parameters
    ----------
    setup, material, trial, prescribed
        See `palpate.solver.axisymmetric.trial_state`.
    system
        Holds the factor.
    lanes : ndarray of bool, shape (LANES,)
        Which take part.
    times
        Number of iterations.

    Returns
    -------
    missed : ndarray, shape (LANES,)
        What they lack of equilibrium in the end, see `palpate.solver.axisymmetric.newton.imbalance`; infinite where it
        is no number.
    """
    size, coupling, done = setup.body.size, no_coupling(setup.body.radial.shape[0]), ~lanes
    residual, direction, forward = no_residual(size), no_direction(size), np.zeros((size + 1, LANES))
    for iteration in range(times + 1):
        unbalance(setup, material, trial, prescribed, residual, coupling, done)
        if iteration == times:
            break
        solve_for(setup.body, system, residual.forces, forward)
        for lane in range(LANES):
            residual.limit[lane] = LARGEST_CHANGE * trial.contact.area[lane]
        direct(system, prescribed, residual, forward, lanes, direction)
        for i in range(trial.displacement.shape[0]):
            for lane in range(LANES):
                trial.displacement[i, lane] += direction.displacement[i, lane]
        for lane in range(LANES):
            trial.depth[lane] += direction.depth[lane]
            trial.contact.area[lane] += direction.area[lane]
    norm, work, missed = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
    measure(residual.forces, direction.displacement, size, norm, work)
    for lane in range(LANES):
        if lanes[lane]:
            found = imbalance(trial.contact, prescribed, residual, coupling, norm, lane)
            missed[lane] = found if np.isfinite(found + work[lane]) else np.inf
    return missed
