"""One time step of `LANES` indentations at once: the iteration of `palpate.fem.newton`, each lane on its own path.

All lanes assemble and factor together; one that has converged or searches along a line leaves the solution unused. What
a lane does thus never depends on its neighbours. The matrix is needed only where some lane takes a Newton step, and
letting nodes go leaves the forces of the stress as they are: neither costs a pass over the elements of its own. A lane
whose matrix at large strains is not positive definite takes its step without the stiffness that stress gives.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from palpate.fem import batch_element, batch_hencky
from palpate.fem.batch_adhesion import attract_forces, attract_matrix
from palpate.fem.batch_banded import solve
from palpate.fem.batch_contact import (
    close_gaps,
    constrain_forces,
    constrain_matrix,
    follow,
    pulled,
    release,
)
from palpate.fem.batch_vector import LANES, load, magnitude, splat, store, where_less
from palpate.fem.newton import ADHESIVE_ITERATIONS, ITERATIONS, TOLERANCE

_small_forces, _small_stiffness = batch_element.internal_forces, batch_element.stiffness
_large_forces, _large_stiffness = batch_hencky.internal_forces, batch_hencky.stiffness

SHORTEST = 0.01  # part of a step, below which an element inside out ends the search
STIFFEST = 1e-3  # share of the force in the last equation, below which the line search takes it for that
TRIES = 5  # of the line search, see `palpate.fem.newton.Search`


@njit(cache=True)
def advance(
    large, body, points, touch, grip, attraction, laws, weights, force_weight, depth_weight, target, scale, farthest,
    displacement, depth, reaction, band, upper, alive, spent,
):  # fmt: skip
    """Bring all lanes into equilibrium under what is prescribed at the end of a step.

    The depth h follows from the last equation, force_weight * F + depth_weight * h = target, of the load F.

    Parameters
    ----------
    large : bool
        See `palpate.fem.batch_hencky`.
    body, points, touch, grip, attraction, laws, weights
        See `palpate.fem.batch_element`, `palpate.fem.batch_law`, `palpate.fem.batch_contact`,
        `palpate.fem.batch_friction` and `palpate.fem.batch_adhesion`; `points`, `touch` and `grip` are advanced.
    force_weight, depth_weight, target : ndarray, shape (LANES,)
        See `palpate.fem.batch_drive`.
    scale : ndarray, shape (LANES,)
        Largest load of the history.
    farthest : ndarray, shape (LANES,)
        How far one iteration may move a node.
    displacement : ndarray, shape (size + 1, LANES)
        In: a guess; out: the solution.
    depth : ndarray, shape (LANES,)
        Likewise.
    reaction : ndarray, shape (LANES,)
        Out: the force of the indenter on the body along z, the load with its sign turned.
    band, upper : ndarray, shape (size * width + 1, LANES)
        Storage for both halves of the matrix; `upper` is empty without friction.
    alive : ndarray of bool, shape (LANES,)
        Lanes that take part; one that finds no equilibrium leaves.
    spent : ndarray of int, shape (LANES,)
        Iterations of each lane are added.
    """
    size = body.size
    forces, border = np.zeros((size + 1, LANES)), np.zeros((size + 1, LANES))
    row = border if len(upper) == 0 else np.zeros((size + 1, LANES))
    direction, toward = np.zeros((size + 1, LANES)), np.zeros(LANES)
    corner, excess = np.zeros(LANES), np.zeros(LANES)
    norm, work = np.zeros(LANES), np.zeros(LANES)
    start, fraction, tries = np.zeros(LANES), np.ones(LANES), np.zeros(LANES, dtype=np.int64)
    searching, solving = np.zeros(LANES, dtype=np.bool_), np.zeros(LANES, dtype=np.bool_)
    taken, held = np.zeros(LANES, dtype=np.int64), np.zeros(LANES, dtype=np.bool_)
    geometric, done = np.ones(LANES), ~alive
    sticky = np.any(attraction.hold > 0.0)
    limit = ADHESIVE_ITERATIONS if sticky else ITERATIONS
    for iteration in range(limit):
        follow(large, body, touch, grip, displacement, depth, done)
        internal_forces(large, body, points, laws, weights, displacement, forces)
        joined = np.any(touch.joined & ~done)
        if joined:
            stiffness(large, body, points, laws, displacement, geometric, band)
            close_gaps(body, touch, band, forces)
        for lane in range(LANES):
            if done[lane]:
                continue
            taken[lane] += 1
            tolerance = TOLERANCE * scale[lane]
            held[lane] = pulled(body, touch, attraction, forces, lane, tolerance)
            may_go = iteration > 0 and held[lane] and not touch.joined[lane]
            kept = depth_weight[lane] == 0.0
            if may_go and release(body, touch, attraction, forces, lane, tolerance, kept):
                held[lane] = pulled(body, touch, attraction, forces, lane, tolerance)
                taken[lane] += 1
                searching[lane] = False
        constrain_forces(body, touch, grip, forces, reaction)
        attract_forces(large, body, touch, grip, attraction, displacement, depth, forces, reaction)
        excess[:] = -reaction * force_weight + depth * depth_weight - target
        measure(forces, direction, size, norm, work)
        work += toward * excess / np.maximum(force_weight, STIFFEST)
        for lane in range(LANES):
            solving[lane] = False
            if done[lane]:
                continue
            imbalance = max(norm[lane], abs(excess[lane])) / scale[lane]
            broken = not np.isfinite(norm[lane] + excess[lane] + work[lane])
            if taken[lane] > limit or (broken and not (large and searching[lane] and fraction[lane] > SHORTEST)):
                alive[lane], done[lane] = False, True
            elif broken:
                fraction[lane] *= 0.5
                move(displacement, depth, direction, toward, lane, -fraction[lane])
            elif imbalance < TOLERANCE and not held[lane] and not touch.joined[lane]:
                done[lane] = True
            elif (
                searching[lane]
                and not (touch.joined[lane] or grip.changed[lane])
                and unbalanced(work[lane], start[lane], tries[lane])
            ):
                tries[lane] += 1
                shorter = fraction[lane] * max(0.1, start[lane] / (start[lane] - work[lane]))
                move(displacement, depth, direction, toward, lane, shorter - fraction[lane])
                fraction[lane] = shorter
            else:
                solving[lane] = True
        if np.all(done):
            break
        if not np.any(solving):
            continue
        if not joined:
            stiffness(large, body, points, laws, displacement, geometric, band)
        constrain_matrix(body, touch, grip, geometric, band, upper, border, row, corner)
        attract_matrix(body, touch, grip, attraction, geometric, band, upper, border, row, corner)
        step(
            band, upper, body.width, forces, border, row, corner, force_weight, depth_weight, excess, solving,
            direction, toward, start,
        )  # fmt: skip
        indefinite = solving & ~np.isfinite(start)
        if (large or sticky) and np.any(indefinite):
            geometric[:] = np.where(indefinite, 0.0, 1.0)
            stiffness(large, body, points, laws, displacement, geometric, band)
            constrain_matrix(body, touch, grip, geometric, band, upper, border, row, corner)
            attract_matrix(body, touch, grip, attraction, geometric, band, upper, border, row, corner)
            step(
                band, upper, body.width, forces, border, row, corner, force_weight, depth_weight, excess, indefinite,
                direction, toward, start,
            )  # fmt: skip
            geometric[:] = 1.0
        for lane in range(LANES):
            if solving[lane]:
                searching[lane], fraction[lane], tries[lane] = True, 1.0, 0
                shorten(direction, toward, start, lane, farthest[lane])
                move(displacement, depth, direction, toward, lane, 1.0)
    alive &= done
    spent += taken


@njit(cache=True)
def internal_forces(large, body, points, laws, weights, displacement, forces):
    """Write the internal `forces` at small or large strains."""
    if large:
        _large_forces(body, points, laws, weights, displacement, forces)
    else:
        _small_forces(body, points, laws, weights, displacement, forces)


@njit(cache=True)
def stiffness(large, body, points, laws, displacement, geometric, band):
    """Write the tangent at small or large strains to the `band`."""
    if large:
        _large_stiffness(body, points, laws, displacement, geometric, band)
    else:
        _small_stiffness(body, points, laws, band)


@njit(cache=True)
def unbalanced(work, start, tries):
    """Return whether the line search goes on, see `palpate.fem.newton.Search.shorten`."""
    return tries < TRIES and work * start <= 0.0 and abs(work) >= 0.8 * abs(start)


@njit(cache=True)
def move(displacement, depth, direction, toward, lane, distance):
    """Move one lane along its direction."""
    for i in range(displacement.shape[0] - 1):
        displacement[i, lane] += distance * direction[i, lane]
    depth[lane] += distance * toward[lane]


@njit(cache=True)
def shorten(direction, toward, start, lane, farthest):
    """Shorten the direction of one lane, and with it the work along it, so that nothing moves farther than that."""
    if farthest == np.inf:
        return
    largest = max(np.abs(direction[:, lane]).max(), abs(toward[lane]))
    if largest > farthest:
        direction[:, lane] *= farthest / largest
        toward[lane] *= farthest / largest
        start[lane] *= farthest / largest


@njit(cache=True)
def measure(forces, direction, size, norm, work):
    """Write the largest of the `forces` that are numbers, and the work of all along the `direction`."""
    largest, total = splat(0.0), splat(0.0)
    for i in range(size):
        force = load(forces, i)
        largest = where_less(largest, magnitude(force), magnitude(force), largest)
        total = total + force * load(direction, i)
    store(norm, 0, largest)
    store(work, 0, total)


@njit(cache=True)
def step(
    band, upper, width, forces, border, row, corner, force_weight, depth_weight, excess, solving, direction, toward,
    start,
):  # fmt: skip
    """Write Newton's direction and the work of the forces along it, in the lanes that are `solving`.

    The depth is eliminated from the bordered system as in `palpate.fem.newton.newton_direction`. Where the matrix is
    not positive definite, the work is NaN.
    """
    size = forces.shape[0] - 1
    forward, sideways = forces.copy(), border.copy()
    solve(band, upper, size, width, forward, sideways)
    ahead, aside = splat(0.0), splat(0.0)
    for i in range(size):
        ahead = ahead + load(row, i) * load(forward, i)
        aside = aside + load(row, i) * load(sideways, i)
    weight, rest = load(force_weight, 0), load(excess, 0)
    pivot = weight * (load(corner, 0) - aside) + load(depth_weight, 0)
    change = (weight * ahead - rest) / where_less(splat(0.0), pivot, pivot, splat(np.nan))
    chosen = np.where(solving, 1.0, 0.0)
    mask = load(chosen, 0)
    total = change * rest / where_less(weight, splat(STIFFEST), splat(STIFFEST), weight)
    for i in range(size):
        value = splat(0.0) - load(forward, i) - change * load(sideways, i)
        total = total + value * load(forces, i)
        store(direction, i, where_less(mask, splat(0.5), load(direction, i), value))
    store(toward, 0, where_less(mask, splat(0.5), load(toward, 0), change))
    store(start, 0, where_less(mask, splat(0.5), load(start, 0), total))
