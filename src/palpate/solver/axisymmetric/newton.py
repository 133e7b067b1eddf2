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

Arguments of several functions, beside those of `advance`:

- `coupling`: derivatives of the contact, see `palpate.solver.axisymmetric.contact_coupling.Coupling`
- `forces`, `forward` (size + 1, LANES): residual R, and K^-1 R
- `direction` (size + 1, LANES), `toward`, `wider` (LANES,): Newton's direction of displacements, depth and area
- `force_weight`, `depth_weight`, `excess` (LANES,): of the last equation
- `late`, `limit` (LANES,): the e of the area, and the largest change of the area
- `start`, `work` (LANES,): work of the forces along the direction, at its start and now; `norm` the largest force
- `geometric` (LANES,): zero where the matrix leaves out what keeps it from being positive definite
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.solver.axisymmetric.assembly import internal_forces, stiffness
from palpate.solver.axisymmetric.banded import solve, solve_again
from palpate.solver.axisymmetric.bordered import copy_of, put_back
from palpate.solver.axisymmetric.contact import contact_forces, fit, pull_on, share_of
from palpate.solver.axisymmetric.contact_coupling import LEAST_RESPONSE, add_tangent, no_coupling, spread
from palpate.solver.axisymmetric.coulomb_friction import turn_back
from palpate.solver.axisymmetric.lanes import LANES, load, magnitude, splat, store, where_less
from palpate.solver.axisymmetric.law_lanes import give_back, keep
from palpate.solver.axisymmetric.rows import as_vector, copy_rows

ITERATIONS = 60
TOLERANCE = 2e-7  # of the largest load, which every unbalanced force falls below
LESS = 10.0  # times less closely the load that the area of contact would bear is met
LARGEST_CHANGE = 0.5  # of the area in one iteration
CALM = 0.3  # share of the force of the contact, up to which what is unbalanced lets the area change
APART = 0.1  # of the area, by which it differs from that of the nodes: then its change may unbalance calm forces
TIGHT = 1e-10  # likewise, where neighbours are carried along
EXACT = 100.0  # times as closely a prescribed displacement is met
REUSES = 3  # iterations with one factor of the matrix
PATIENT = 7  # iterations, after which each has a factor of its own
SHORTEST = 0.01  # part of a step, below which an element inside out ends the search
STIFFEST = 1e-3  # share of the force in the last equation, below which the line search takes it for that
TRIES = 5  # of the line search
LESS_WORK = 0.8  # of what it was, below which the work of the forces ends it
MORE = 2.0  # likewise, where nodes begin or cease to slip


@njit(cache=True, error_model="numpy", nogil=True)
def advance(
    large, body, points, contact, state, laws, weights, equation, scale, tolerance, farthest, displacement, depth,
    reaction, system, alive, spent,
):  # fmt: skip
    """Bring all lanes into equilibrium under what is prescribed at the end of a step.

    Parameters
    ----------
    large : bool or None
        See `palpate.solver.axisymmetric.assembly`.
    body, points, contact, state, laws, weights
        See `palpate.solver.axisymmetric.element`, `palpate.solver.axisymmetric.law_lanes` and
        `palpate.solver.axisymmetric.contact`; `points` is advanced.
    equation : tuple of ndarray, shape (LANES,)
        Force weight, depth weight and target, see `palpate.solver.axisymmetric.drive`.
    scale : ndarray, shape (LANES,)
        Largest load of the history.
    tolerance
        What every unbalanced force falls below, as a share of that.
    farthest : ndarray, shape (LANES,)
        How far one iteration may move a node.
    displacement : ndarray, shape (size + 1, LANES)
        In: a guess; out: the solution.
    depth : ndarray, shape (LANES,)
        Likewise.
    reaction : ndarray, shape (LANES,)
        Out: the load.
    system : System
        Out: the last factor of the matrix.
    alive : ndarray of bool, shape (LANES,)
        Lanes that take part; one that finds no equilibrium leaves.
    spent : ndarray of int, shape (LANES,)
        Iterations of each lane are added.
    """
    size, count = body.size, body.radial.shape[0]
    force_weight, depth_weight, target = equation
    forces, forward = np.zeros((size + 1, LANES)), np.zeros((size + 1, LANES))
    direction, toward, wider = np.zeros((size + 1, LANES)), np.zeros(LANES), np.zeros(LANES)
    excess, norm, work, late = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
    coupling, slips, changed = no_coupling(count), np.zeros((count, LANES)), np.zeros(LANES, dtype=np.bool_)
    start, fraction, tries = np.zeros(LANES), np.ones(LANES), np.zeros(LANES, dtype=np.int64)
    searching, solving = np.zeros(LANES, dtype=np.bool_), np.zeros(LANES, dtype=np.bool_)
    indefinite, done, rough = np.zeros(LANES, dtype=np.bool_), ~alive, np.any(contact.friction > 0.0)
    limit, geometric = np.zeros(LANES), np.ones(LANES)
    solved = np.empty((4, *points.log_q.shape))
    for iteration in range(ITERATIONS):
        patient = iteration < PATIENT
        fresh = not patient or iteration % REUSES == 0
        if rough:
            shares = shares_of(large, body, contact, state, displacement, depth)
            turn_back(contact, state, shares, body.distance, body.radial, displacement, slips, changed, done)
        internal_forces(large, body, points, laws, weights, displacement, forces)
        fit(contact, state, load_borne(body, contact, state, forces, equation), done)
        contact_forces(large, body, contact, state, displacement, depth, forces, reaction, coupling, done)
        measure(forces, direction, size, norm, work)
        for lane in range(LANES):
            solving[lane] = False
            if done[lane]:
                continue
            spent[lane] += 1
            excess[lane] = reaction[lane] * force_weight[lane] + depth[lane] * depth_weight[lane] - target[lane]
            work[lane] += toward[lane] * excess[lane] / max(force_weight[lane], STIFFEST)
            late[lane] = (state.area[lane] - coupling.area[lane]) / max(1.0 - coupling.feedback[lane], LEAST_RESPONSE)
            exact = EXACT if depth_weight[lane] > 0.0 else 1.0
            imbalance = max(norm[lane], exact * abs(excess[lane])) / scale[lane]
            push = state.pressure[lane] * state.area[lane]
            calm = max(norm[lane], abs(excess[lane])) < CALM * push
            limit[lane] = LARGEST_CHANGE * state.area[lane] if calm else 0.0
            unlike = abs(coupling.area[lane] / state.area[lane] - 1.0)
            broken = not np.isfinite(norm[lane] + excess[lane] + work[lane])
            if broken and not (searching[lane] and fraction[lane] > SHORTEST):
                alive[lane], done[lane] = False, True
            elif broken:
                fraction[lane] *= 0.5
                move(displacement, depth, state, direction, toward, wider, lane, -fraction[lane])
            elif max(imbalance, unlike * push / scale[lane] / LESS) < tolerance:
                done[lane] = True
                keep(points, solved, lane)
            elif (
                searching[lane]
                and not (calm and unlike > APART)
                and unbalanced(work[lane], start[lane], tries[lane], MORE if changed[lane] and patient else LESS_WORK)
            ):
                tries[lane] += 1
                shorter = fraction[lane] * max(0.1, start[lane] / (start[lane] - work[lane]))
                move(displacement, depth, state, direction, toward, wider, lane, shorter - fraction[lane])
                fraction[lane] = shorter
            else:
                solving[lane] = True
        if np.all(done):
            break
        if fresh:
            stiffness(large, body, points, laws, displacement, geometric, system.band)
            factor(body, coupling, geometric, system, forces, forward)
        elif np.any(solving):
            copy_rows(forces, forward)
            solve_again(system.band, system.upper, size, body.width, forward)
        direct(
            system, forces, forward, force_weight, depth_weight, excess, late, limit, solving, direction, toward, wider,
            start,
        )  # fmt: skip
        for lane in range(LANES):
            indefinite[lane] = solving[lane] and not math.isfinite(start[lane])
            geometric[lane] = 0.0 if indefinite[lane] else 1.0
        if np.any(indefinite):
            before = copy_of(system)
            stiffness(large, body, points, laws, displacement, geometric, system.band)
            factor(body, coupling, geometric, system, forces, forward)
            direct(
                system, forces, forward, force_weight, depth_weight, excess, late, limit, indefinite, direction, toward,
                wider, start,
            )  # fmt: skip
            geometric[:] = 1.0
            put_back(system, before, indefinite)
        for lane in range(LANES):
            if solving[lane]:
                searching[lane], fraction[lane], tries[lane] = True, 1.0, 0
                wider[lane] /= state.area[lane]
                shorten(direction, toward, wider, start, lane, farthest[lane])
                move(displacement, depth, state, direction, toward, wider, lane, 1.0)
    alive &= done
    give_back(points, solved, alive)


@njit(cache=True)
def factor(body, coupling, geometric, system, forces, forward):
    """Complete the matrix by the contact, factor it and solve for the `forces`."""
    spread(body, coupling, system.widening, system.swelling, system.growth)
    add_tangent(body, coupling.tangent, geometric, system.band, system.upper, system.border, system.row, system.corner)
    copy_rows(forces, forward)
    copy_rows(system.border, system.sideways)
    solve(system.band, system.upper, body.size, body.width, forward, system.sideways)
    solve_again(system.band, system.upper, body.size, body.width, system.swelling)


@njit(cache=True)
def load_borne(body, contact, state, forces, equation):
    """Return the load (LANES,) of the contact: what is prescribed, or what the internal `forces` hold.

    Where it is not prescribed, what presses changes by no more than a factor of two from one iteration to the next.
    """
    force_weight, depth_weight, target = equation
    borne = np.zeros(LANES)
    for lane in range(LANES):
        if depth_weight[lane] == 0.0:
            borne[lane] = target[lane] / force_weight[lane]
        else:
            for k in range(body.vertical.shape[0]):
                borne[lane] -= forces[body.vertical[k], lane]
            push = state.pressure[lane] * state.area[lane]
            pull = pull_on(contact, state.area[lane], lane)
            borne[lane] = min(max(borne[lane], 0.5 * push - pull), 2.0 * push - pull)
    return borne


@njit(cache=True)
def shares_of(large, body, contact, state, displacement, depth):
    """Return the share (k, LANES) of each surface node that touches."""
    shares = np.zeros((body.radial.shape[0], LANES))
    for k in range(body.radial.shape[0]):
        for lane in range(LANES):
            shares[k, lane] = share_of(large, body, contact, state, displacement, depth, k, lane)[0]
    return shares


@njit(cache=True)
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


@njit(cache=True)
def move(displacement, depth, state, direction, toward, wider, lane, distance):
    """Move one lane along its direction.

    Parameters
    ----------
    distance
        In units of the direction.
    """
    for i in range(displacement.shape[0] - 1):
        displacement[i, lane] += distance * direction[i, lane]
    depth[lane] += distance * toward[lane]
    state.area[lane] *= math.exp(distance * wider[lane])


@njit(cache=True)
def shorten(direction, toward, wider, start, lane, farthest):
    """Shorten the direction of one lane, and with it the work along it, so that nothing moves farther than that.

    Parameters
    ----------
    farthest
        Largest displacement of any node.
    """
    if farthest == np.inf:
        return
    largest = abs(toward[lane])
    for i in range(direction.shape[0]):
        largest = max(largest, abs(direction[i, lane]))
    if largest > farthest:
        for i in range(direction.shape[0]):
            direction[i, lane] *= farthest / largest
        toward[lane] *= farthest / largest
        wider[lane] *= farthest / largest
        start[lane] *= farthest / largest


@njit(cache=True)
def measure(forces, direction, size, norm, work):
    """Write the largest of the `forces` that are numbers, and the work of all along the `direction`.

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


@njit(cache=True)
def direct(
    system, forces, forward, force_weight, depth_weight, excess, late, limit, solving, direction, toward, wider, start
):  # fmt: skip
    """Write Newton's direction and the work of the forces along it, in the lanes that are `solving`.

    Depth and area are eliminated from the bordered system; the matrix times `forward` is the `forces`. The area changes
    by no more than the `limit` (LANES,), and the rest with it. Where the matrix is not positive definite, the work is
    NaN.
    """
    size = forces.shape[0] - 1
    row, widening, sideways, swelling = system.row, system.widening, system.sideways, system.swelling
    zero = splat(0.0)
    load_ahead, load_aside, load_spread, area_ahead, area_aside, area_spread = zero, zero, zero, zero, zero, zero
    for i in range(size):
        r, v, f, s, w = load(row, i), load(widening, i), load(forward, i), load(sideways, i), load(swelling, i)
        load_ahead, load_aside, load_spread = load_ahead + r * f, load_aside + r * s, load_spread + r * w
        area_ahead, area_aside, area_spread = area_ahead + v * f, area_aside + v * s, area_spread + v * w
    area_ahead = area_ahead + load(late, 0)
    weight, rest, most = load(force_weight, 0), load(excess, 0), load(limit, 0)
    yielding = splat(1.0) + area_spread
    yielding = where_less(yielding, splat(LEAST_RESPONSE), splat(LEAST_RESPONSE), yielding)
    by_area, by_depth = load(system.growth, 0) - load_spread, load(widening, size) - area_aside
    alone = weight * (load(system.corner, 0) - load_aside) + load(depth_weight, 0)
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
        total = total + value * load(forces, i)
        store(direction, i, where_less(mask, splat(0.5), load(direction, i), value))
    store(toward, 0, where_less(mask, splat(0.5), load(toward, 0), change))
    store(wider, 0, where_less(mask, splat(0.5), load(wider, 0), spreading))
    store(start, 0, where_less(mask, splat(0.5), load(start, 0), total))
