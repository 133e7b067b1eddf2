"""One time step of `LANES` indentations at once: Newton's method on equilibrium, law and contact together.

The depth h of the tip is one more unknown beside the displacements u, and what is prescribed of load F and depth one
more equation (`drive`). So is the area S of the contact, which its pressure and width follow (`contact`). With the band
matrix K of body and contact, the derivatives k and s of all forces by depth and area, those of the load r, c and g by
displacements, depth and area, those of the area v and b, and what S is too large by, e, every iteration solves

    K du + k dh + s dS = -R,    force_weight (r du + c dh + g dS) + depth_weight dh = -excess,    dS = v du + b dh - e.

A factor of the matrix serves `REUSES` iterations. Each lane searches along Newton's direction, by the secant, until the
work of the forces along it falls below 0.8 of what it was, or below 2 where nodes begin or cease to slip. While the
area is far from that of the nodes, calm forces do not hold back its change. All lanes are assembled and factored
together, at iterations that depend on their number alone; a lane that has converged or searches along a line leaves the
solution unused: lanes never depend on each other. A lane whose matrix is not positive definite takes its step without
what takes that away.

Arguments of several functions:

- `setup`, `material`, `trial`, `prescribed`, `residual`, `direction`: see `palpate.solver.axisymmetric.trial_state`
- `system`: the linearised system, see `palpate.solver.axisymmetric.bordered.System`
- `forces` (size + 1, LANES): those of the residual
- `coupling`: derivatives of the contact, see `palpate.solver.axisymmetric.contact_coupling.Coupling`
- `forward` (size + 1, LANES): K^-1 R
- `geometric` (LANES,): zero where the matrix leaves out what keeps it from being positive definite
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.assembly import internal_forces, stiffness
from palpate.solver.axisymmetric.banded import solve, solve_again
from palpate.solver.axisymmetric.bordered import copy_of, put_back
from palpate.solver.axisymmetric.contact import contact_forces, fit, share_of
from palpate.solver.axisymmetric.contact_coupling import LEAST_RESPONSE, add_tangent, no_coupling, spread
from palpate.solver.axisymmetric.coulomb_friction import reverse_slip
from palpate.solver.axisymmetric.lanes import (
    LANES,
    exponential,
    larger,
    load,
    magnitude,
    splat,
    store,
    where_less,
)
from palpate.solver.axisymmetric.law_lanes import restore_solution, save_solution
from palpate.solver.axisymmetric.rows import as_vector, copy_rows
from palpate.solver.axisymmetric.trial_state import Direction, Residual

ITERATIONS = 60  # of a step, then it is divided; chosen
TOLERANCE = 2e-7  # of the largest load, which every unbalanced force falls below
TIGHT = 1e-10  # likewise, where neighbours are carried along
LESS = 10.0  # times less closely the load that the area of contact would bear is met
LARGEST_CHANGE = 0.5  # of the area in one iteration
CALM = 0.3  # share of the force of the contact, up to which what is unbalanced lets the area change
APART = 0.1  # of the area, by which it differs from that of the nodes: then its change may unbalance calm forces
EXACT = 100.0  # times as closely a prescribed displacement is met
REUSES = 3  # iterations with one factor of the matrix
PATIENT = 7  # iterations, after which each has a factor of its own
SHORTEST = 0.01  # part of a step, below which an element inside out ends the search
STIFFEST = 1e-3  # share of the force in the last equation, below which the line search takes it for that
TRIES = 5  # of the line search
LESS_WORK = 0.8  # of what it was, below which the work of the forces ends it
MORE = 2.0  # likewise, where nodes begin or cease to slip


@njit(cache=True, error_model="numpy", nogil=True)
def advance(setup, material, trial, prescribed, system, farthest, alive):
    """Bring all lanes into equilibrium under what is prescribed at the end of a step.

    Parameters
    ----------
    setup : Setup
    material : Material
        In: points at the start of the step; out: at its end.
    trial : Trial
        In: a guess; out: the solution.
    prescribed : Prescribed
    system : System
        Storage of the linear system; holds the last factor of the matrix in the end.
    farthest : ndarray, shape (LANES,)
        How far one iteration may move a node.
    alive : ndarray of bool, shape (LANES,)
        Lanes that take part; one that finds no equilibrium leaves.
    """
    points, state = material.points, trial.contact
    size, count = setup.body.size, setup.body.radial.shape[0]
    residual, direction, forward = no_residual(size), no_direction(size), np.zeros((size + 1, LANES))
    norm, work, coupling = np.zeros(LANES), np.zeros(LANES), no_coupling(count)
    slips, changed = np.zeros((count, LANES)), np.zeros(LANES, dtype=np.bool_)
    fraction, tries, geometric = np.ones(LANES), np.zeros(LANES, dtype=np.int64), np.ones(LANES)
    distance, found = np.zeros(LANES), np.zeros(LANES, dtype=np.bool_)
    searching, solving = np.zeros(LANES, dtype=np.bool_), np.zeros(LANES, dtype=np.bool_)
    indefinite, done, rough = np.zeros(LANES, dtype=np.bool_), ~alive, np.any(setup.contact.friction > 0.0)
    solved = np.empty((4, *points.log_q.shape))
    for iteration in range(ITERATIONS):
        patient = iteration < PATIENT
        # Fresh depends on the number of the iteration alone: lanes are factored together, whatever each of them needs.
        fresh = not patient or iteration % REUSES == 0
        if rough:
            reverse_slip(setup, trial, shares_of(setup, trial), slips, changed, done)
        unbalance(setup, material, trial, prescribed, residual, coupling, done)
        measure(residual.forces, direction.displacement, size, norm, work)
        for lane in range(LANES):
            solving[lane], found[lane], distance[lane] = False, False, 0.0
            if done[lane]:
                continue
            excess = residual.excess[lane]
            work[lane] += direction.depth[lane] * excess / max(prescribed.force_weight[lane], STIFFEST)
            # Each lane does one of four things: it leaves or steps back, it is in equilibrium, it searches on along its
            # direction, or it needs a new direction.
            push = state.pressure[lane] * state.area[lane]
            calm = max(norm[lane], abs(excess)) < CALM * push
            residual.limit[lane] = LARGEST_CHANGE * state.area[lane] if calm else 0.0
            # How far the area that the pressure follows lies from that of the nodes that touch.
            unlike = abs(coupling.area[lane] / state.area[lane] - 1.0)
            broken = not np.isfinite(norm[lane] + excess + work[lane])
            if broken and not (searching[lane] and fraction[lane] > SHORTEST):
                alive[lane], done[lane] = False, True
            elif broken:
                fraction[lane] *= 0.5
                distance[lane] = -fraction[lane]
            elif imbalance(state, prescribed, residual, coupling, norm, lane) < prescribed.tolerance:
                done[lane] = found[lane] = True
            elif (
                searching[lane]
                and not (calm and unlike > APART)
                and unbalanced(
                    work[lane], direction.work[lane], tries[lane], MORE if changed[lane] and patient else LESS_WORK
                )
            ):
                tries[lane] += 1
                # The secant of the work along the direction, no shorter than a tenth.
                shorter = fraction[lane] * max(0.1, direction.work[lane] / (direction.work[lane] - work[lane]))
                distance[lane] = shorter - fraction[lane]
                fraction[lane] = shorter
            else:
                solving[lane] = True
        if np.any(found):
            save_solution(points, solved, found)
        if np.all(done):
            break
        if np.any(distance != 0.0):
            move(trial, direction, distance)
        if fresh:
            factor(setup, material, trial, system, coupling, geometric, residual.forces, forward)
        elif np.any(solving):
            solve_for(setup.body, system, residual.forces, forward)
        # The work is NaN where the matrix is not positive definite: those lanes solve again without its geometric part,
        # and the factor of the others is put back.
        direct(system, prescribed, residual, forward, solving, direction)
        for lane in range(LANES):
            indefinite[lane] = solving[lane] and not math.isfinite(direction.work[lane])
            geometric[lane] = 0.0 if indefinite[lane] else 1.0
        if np.any(indefinite):
            before = copy_of(system)
            factor(setup, material, trial, system, coupling, geometric, residual.forces, forward)
            direct(system, prescribed, residual, forward, indefinite, direction)
            geometric[:] = 1.0
            put_back(system, before, indefinite)
        for lane in range(LANES):
            distance[lane] = 0.0
            if solving[lane]:
                searching[lane], fraction[lane], tries[lane], distance[lane] = True, 1.0, 0, 1.0
                # The area moves by a factor, so that it stays positive.
                direction.area[lane] /= state.area[lane]
        if np.any(solving):
            shorten(direction, farthest, solving)
            move(trial, direction, distance)
    alive &= done
    restore_solution(points, solved, alive)


@inner_kernel(cache=True)
def no_residual(size):
    """Return a residual of so many unknowns, which is zero."""
    return Residual(np.zeros((size + 1, LANES)), np.zeros(LANES), np.zeros(LANES), np.zeros(LANES))


@inner_kernel(cache=True)
def no_direction(size):
    """Return a direction of so many unknowns, which is zero."""
    return Direction(np.zeros((size + 1, LANES)), np.zeros(LANES), np.zeros(LANES), np.zeros(LANES))


@inner_kernel(cache=True, error_model="numpy")
def unbalance(setup, material, trial, prescribed, residual, coupling, done):
    """Write the residual, but for its limit, and the coupling in the lanes that are not `done`."""
    internal_forces(setup, material, trial.displacement, residual.forces)
    fit(setup.contact, trial.contact, load_borne(setup, trial.contact, residual.forces, prescribed), done)
    contact_forces(setup, trial, residual.forces, coupling)
    for lane in range(LANES):
        if not done[lane]:
            borne = trial.reaction[lane] * prescribed.force_weight[lane]
            residual.excess[lane] = borne + trial.depth[lane] * prescribed.depth_weight[lane] - prescribed.target[lane]
            missing = trial.contact.area[lane] - coupling.area[lane]
            residual.late[lane] = missing / max(1.0 - coupling.feedback[lane], LEAST_RESPONSE)


@inner_kernel(cache=True, error_model="numpy")
def imbalance(state, prescribed, residual, coupling, norm, lane):
    """Return what a lane lacks of equilibrium, in forces, drive and area of contact, as a share of its largest load.

    Parameters
    ----------
    state
        Of the contact.
    norm : ndarray, shape (LANES,)
        Largest unbalanced force.
    """
    exact, scale = EXACT if prescribed.depth_weight[lane] != 0.0 else 1.0, prescribed.scale[lane]
    unlike, push = abs(coupling.area[lane] / state.area[lane] - 1.0), state.pressure[lane] * state.area[lane]
    return max(max(norm[lane], exact * abs(residual.excess[lane])) / scale, unlike * push / scale / LESS)


@inner_kernel(cache=True)
def factor(setup, material, trial, system, coupling, geometric, forces, forward):
    """Assemble the matrix of body and contact, factor it and solve for the `forces`."""
    body = setup.body
    stiffness(setup, material, trial.displacement, geometric, system.band)
    spread(body, coupling, system.widening, system.swelling, system.growth)
    add_tangent(body, coupling.tangent, geometric, system.band, system.upper, system.border, system.row, system.corner)
    copy_rows(forces, forward)
    copy_rows(system.border, system.sideways)
    solve(system.band, system.upper, body.size, body.width, forward, system.sideways)
    solve_again(system.band, system.upper, body.size, body.width, system.swelling)


@inner_kernel(cache=True)
def solve_for(body, system, forces, forward):
    """Solve for the `forces` with the last factor."""
    copy_rows(forces, forward)
    solve_again(system.band, system.upper, body.size, body.width, forward)


@inner_kernel(cache=True)
def load_borne(setup, state, forces, prescribed):
    """Return the load (LANES,) of a contact in such a `state`: what is prescribed, or what internal `forces` hold.

    Where it is not prescribed, what presses changes by no more than a factor of two from one iteration to the next.
    """
    vertical, borne = setup.body.vertical, np.zeros(LANES)
    for lane in range(LANES):
        if prescribed.depth_weight[lane] == 0.0:
            borne[lane] = prescribed.target[lane] / prescribed.force_weight[lane]
        else:
            for k in range(vertical.shape[0]):
                borne[lane] -= forces[vertical[k], lane]
            push = state.pressure[lane] * state.area[lane]
            pull = setup.contact.strength[lane] * state.area[lane]
            borne[lane] = min(max(borne[lane], 0.5 * push - pull), 2.0 * push - pull)
    return borne


@inner_kernel(cache=True)
def shares_of(setup, trial):
    """Return the share (k, LANES) of each surface node that touches."""
    shares = np.zeros((setup.body.radial.shape[0], LANES))
    for k in range(setup.body.radial.shape[0]):
        store(shares, k, share_of(setup, trial, k)[0])
    return shares


@inner_kernel(cache=True)
def unbalanced(work, start, tries, share):
    """Return whether the line search goes on: up to `TRIES` times, until the work is less than a `share` of the start.

    Parameters
    ----------
    tries
        Of the search so far.
    share
        `LESS_WORK` or `MORE`.
    """
    return tries < TRIES and work * start <= 0.0 and abs(work) >= share * abs(start)


@inner_kernel(cache=True)
def move(trial, direction, distance):
    """Move lanes along their directions, in which the area is relative.

    Parameters
    ----------
    distance : ndarray, shape (LANES,)
        In units of the direction; lanes stay where it is zero.
    """
    far, none = load(distance, 0), splat(0.0)
    square = far * far
    for i in range(trial.displacement.shape[0] - 1):
        before = load(trial.displacement, i)
        store(trial.displacement, i, where_less(none, square, before + far * load(direction.displacement, i), before))
    depth, area = load(trial.depth, 0), load(trial.contact.area, 0)
    store(trial.depth, 0, where_less(none, square, depth + far * load(direction.depth, 0), depth))
    wider = area * exponential(far * load(direction.area, 0))
    store(trial.contact.area, 0, where_less(none, square, wider, area))


@inner_kernel(cache=True)
def shorten(direction, farthest, lanes):
    """Shorten the direction of some lanes, and with it the work along it, so that nothing moves farther than that.

    Parameters
    ----------
    farthest : ndarray, shape (LANES,)
        Largest displacement of any node.
    lanes : ndarray of bool, shape (LANES,)
        Which lanes.
    """
    largest, most, one = magnitude(load(direction.depth, 0)), load(farthest, 0), splat(1.0)
    for i in range(direction.displacement.shape[0]):
        largest = larger(largest, magnitude(load(direction.displacement, i)))
    share = where_less(splat(0.5), as_vector(lanes), where_less(most, largest, most / largest, one), one)
    for i in range(direction.displacement.shape[0]):
        store(direction.displacement, i, share * load(direction.displacement, i))
    for row in (direction.depth, direction.area, direction.work):
        store(row, 0, share * load(row, 0))


@inner_kernel(cache=True)
def measure(forces, direction, size, norm, work):
    """Write the largest of the `forces` that are numbers, as `norm`, and the `work` of all along the `direction`.

    Parameters
    ----------
    size
        Number of unknowns.
    """
    largest, total = splat(0.0), splat(0.0)
    for i in range(size):
        force = load(forces, i)
        largest = where_less(largest, magnitude(force), magnitude(force), largest)
        total = total + force * load(direction, i)
    store(norm, 0, largest)
    store(work, 0, total)


@inner_kernel(cache=True)
def direct(system, prescribed, residual, forward, solving, direction):
    """Write Newton's direction and the work of the forces along it, in the lanes that are `solving`.

    Depth and area are eliminated from the bordered system. The area changes by no more than its limit, and the rest
    with it. Where the matrix is not positive definite, the work is NaN.
    """
    size = forward.shape[0] - 1
    row, widening, sideways, swelling = system.row, system.widening, system.sideways, system.swelling
    zero = splat(0.0)
    # Of load and area: what the forces ask for (ahead), and the change by a unit of depth (aside) and of area (spread).
    load_ahead, load_aside, load_spread, area_ahead, area_aside, area_spread = zero, zero, zero, zero, zero, zero
    for i in range(size):
        r, v, f, s, w = load(row, i), load(widening, i), load(forward, i), load(sideways, i), load(swelling, i)
        load_ahead, load_aside, load_spread = load_ahead + r * f, load_aside + r * s, load_spread + r * w
        area_ahead, area_aside, area_spread = area_ahead + v * f, area_aside + v * s, area_spread + v * w
    area_ahead = area_ahead + load(residual.late, 0)
    weight, rest, most = load(prescribed.force_weight, 0), load(residual.excess, 0), load(residual.limit, 0)
    yielding = splat(1.0) + area_spread
    yielding = where_less(yielding, splat(LEAST_RESPONSE), splat(LEAST_RESPONSE), yielding)
    by_area, by_depth = load(system.growth, 0) - load_spread, load(widening, size) - area_aside
    # Schur complement of the depth, without and with the area that follows it; the former where the latter is negative.
    alone = weight * (load(system.corner, 0) - load_aside) + load(prescribed.depth_weight, 0)
    together = alone + weight * by_area * by_depth / yielding
    together = where_less(zero, together, together, alone)
    change = (weight * (load_ahead + by_area * area_ahead / yielding) - rest) / together
    spreading = (change * by_depth - area_ahead) / yielding
    spreading = where_less(spreading, zero - most, zero - most, spreading)
    spreading = where_less(most, spreading, most, spreading)
    change = (weight * (load_ahead - by_area * spreading) - rest) / where_less(zero, alone, alone, splat(np.nan))
    mask = as_vector(solving)
    total = change * rest / where_less(weight, splat(STIFFEST), splat(STIFFEST), weight)
    for i in range(size):
        value = zero - load(forward, i) - change * load(sideways, i) - spreading * load(swelling, i)
        total = total + value * load(residual.forces, i)
        store(direction.displacement, i, where_less(mask, splat(0.5), load(direction.displacement, i), value))
    store(direction.depth, 0, where_less(mask, splat(0.5), load(direction.depth, 0), change))
    store(direction.area, 0, where_less(mask, splat(0.5), load(direction.area, 0), spreading))
    store(direction.work, 0, where_less(mask, splat(0.5), load(direction.work, 0), total))
