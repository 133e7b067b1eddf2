"""Contact with a rigid tip as a smooth function of the gap, in SIMD lanes.

The penetration of a surface node into the tip, g = h + u_z - f(r + u_r) with the depth h, gives the node a force along
(f', -1) of the size

    F(g) = C p A (x Phi(x) + b phi(x)),    x = g / w,

with the normal distribution Phi and its density phi. Nodes are loaded gradually while the gap closes over the width w,
so no derivative of the depth jumps when contact spreads. What is smeared out is max(g, 0): by a normal distribution
where b = 1, and where b = 1/2 by the kernel of fourth order, whose second moment vanishes. Values of b between the two
make the error of first order in the element's size vanish (`BLEND`; a larger b lets the tip sink in less).

p is the mean pressure of the contact, and so the penetration that a typical pressure needs is the same share of w from
a soft body to a hard one, and from the first contact to the last. The width is measured in the rise of the tip over one
element at the edge of contact,

    w = s l f'(a) (1 + n) / 2,    n = a f'(a) / f(a),    pi a^2 = sum A Phi(x),    p = F / (pi a^2),

with the local distance l of nodes; it narrows with the root of p in unloading. Both a and p belong to the equilibrium
that a step looks for: each iteration takes them from its own displacements (`adapt`), so the contact has no memory.
Nothing here has a length or a stress of its own: scaling laws of sharp tips hold exactly. At given a and p the force
has a potential, so the stiffness is symmetric without friction.

Sources: for regularised contact P. Wriggers, Computational Contact Mechanics, 2nd ed. (2006), section 6.3; for kernels
of higher order M. P. Wand & M. C. Jones, Kernel Smoothing (1995), section 2.8.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_friction import anchored, friction_ratio
from palpate.fem.batch_tip import Tip, profile_at
from palpate.fem.batch_vector import LANES

FARTHEST = 2.0  # of the largest contact radius, beyond which the distance of nodes counts as no larger
SLIP = 2e-3  # of the tip's rise, that precedes the limit of friction
LEAST_PRESSURE = 0.02  # of the pressure at the largest load, below which the contact counts as that stiff
FASTEST = 2.0  # factor by which the pressure changes at most from one iteration to the next
WIDER = 1e-5  # of the area, for derivatives by it
ROUNDS = 2  # in which the radius of contact and the width that it determines are found together


class Contact(NamedTuple):
    """What of the contact stays during a simulation.

    Attributes
    ----------
    tip : Tip
    width : ndarray, shape (k, LANES)
        s l of each surface node.
    area : ndarray, shape (k,)
        Area that belongs to each of them.
    stiffness : ndarray, shape (LANES,)
        C.
    blend : ndarray, shape (2, LANES)
        b under tips of n = 1, and what it grows by with n.
    attraction : ndarray, shape (k, LANES)
        Largest force of attraction of each node along z; zero without adhesion.
    reach : ndarray, shape (LANES,)
        Gap over which the attraction falls by e.
    friction : ndarray, shape (LANES,)
        Coulomb's coefficient.
    slip : ndarray, shape (k, LANES)
        Slip that precedes the limit of friction.
    """

    tip: Tip
    width: np.ndarray
    area: np.ndarray
    stiffness: np.ndarray
    blend: np.ndarray
    attraction: np.ndarray
    reach: np.ndarray
    friction: np.ndarray
    slip: np.ndarray


class ContactState(NamedTuple):
    """What of it changes.

    Attributes
    ----------
    pressure, area : ndarray, shape (LANES,)
        Mean pressure p and area pi a^2.
    rise : ndarray, shape (LANES,)
        f'(a) (1 + n) / 2 at the edge of contact, and how far it has narrowed: w / (s l).
    blend : ndarray, shape (LANES,)
        b.
    strongest, widest : ndarray, shape (LANES,)
        Largest force p pi a^2 and largest area so far.
    anchor, share, place : ndarray, shape (k, LANES)
        See `palpate.fem.batch_friction`.
    """

    pressure: np.ndarray
    area: np.ndarray
    rise: np.ndarray
    blend: np.ndarray
    strongest: np.ndarray
    widest: np.ndarray
    anchor: np.ndarray
    share: np.ndarray
    place: np.ndarray


@njit(cache=True)
def normal_distribution(x):
    """Return Phi(x), not below 1e-28."""
    return 0.5 * math.erfc(-math.sqrt(0.5) * max(x, -11.0))


@njit(cache=True, error_model="numpy")
def width_of(contact, state, k, lane):
    """Return the width w over which the gap of a node closes."""
    return contact.width[k, lane] * state.rise[lane]


@njit(cache=True, error_model="numpy")
def penetration(large, body, contact, state, displacement, depth, k, lane):
    """Return x = g / w of a node, its distance from the axis, and slope and curvature of the tip over it."""
    r, z = body.radial[k], body.vertical[k]
    moved = displacement[r, lane] if r >= 0 else 0.0
    height, slope, curvature = profile_at(large, contact.tip, lane, body.distance[k], moved)
    x = (depth[lane] + displacement[z, lane] - height) / width_of(contact, state, k, lane)
    return x, body.distance[k] + moved, slope, curvature


@njit(cache=True, error_model="numpy")
def force_on(contact, state, x, k, lane):
    """Return force and derivative by the gap of the penetration x of a node."""
    share, density = normal_distribution(x), math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    blend = state.blend[lane]
    scale = contact.stiffness[lane] * state.pressure[lane] * contact.area[k]
    width = width_of(contact, state, k, lane)
    return scale * (x * share + blend * density), scale * (share + (1.0 - blend) * x * density) / width


@njit(cache=True, error_model="numpy")
def begin_step(large, body, contact, state, displacement, depth):
    """Note where the nodes are, and which share of them touches, at the start of a step with friction."""
    if not np.any(contact.friction > 0.0):
        return
    for k in range(body.radial.shape[0]):
        for lane in range(LANES):
            x, place, _, _ = penetration(large, body, contact, state, displacement, depth, k, lane)
            state.share[k, lane] = normal_distribution(x)
            state.place[k, lane] = place


@njit(cache=True, error_model="numpy")
def adapt(large, body, contact, state, displacement, depth, bearing, done):
    """Take pressure and radius of the contact from the displacements and the load that it is `bearing` (LANES,)."""
    for _ in range(ROUNDS):
        area, pull = touching(large, body, contact, state, displacement, depth, done)
        for lane in range(LANES):
            push = bearing[lane] + pull[lane]
            if not done[lane] and np.isfinite(area[lane] + push):
                state.area[lane] = area[lane]
                least, most = state.pressure[lane] / FASTEST, state.pressure[lane] * FASTEST
                take_pressure(contact, state, min(max(push / area[lane], least), most), lane)


@njit(cache=True, error_model="numpy")
def touching(large, body, contact, state, displacement, depth, done):
    """Return the area (LANES,) of the contact, and the attraction (LANES,) that acts on the surface."""
    area, pull = np.zeros(LANES), np.zeros(LANES)
    for k in range(body.radial.shape[0]):
        for lane in range(LANES):
            if done[lane]:
                continue
            x, _, _, _ = penetration(large, body, contact, state, displacement, depth, k, lane)
            area[lane] += contact.area[k] * normal_distribution(x)
            if contact.attraction[k, lane] > 0.0:
                pull[lane] += attraction_on(contact, state, x, k, lane)[0]
    return area, pull


@njit(cache=True, error_model="numpy")
def take_pressure(contact, state, pressure, lane):
    """Let a contact of a known area have a `pressure`, and the width and the b that belong to both."""
    area = state.area[lane]
    radius = math.sqrt(area / math.pi)
    height, slope, _ = profile_at(True, contact.tip, lane, radius, 0.0)
    exponent = radius * slope / height
    usual = max(state.strongest[lane], pressure * area) / max(state.widest[lane], area)
    state.pressure[lane] = max(pressure, LEAST_PRESSURE * usual)
    narrowing = math.sqrt(min(1.0, state.pressure[lane] / usual))
    state.rise[lane] = 0.5 * slope * (1.0 + exponent) * narrowing
    state.blend[lane] = contact.blend[0, lane] + (exponent - 1.0) * contact.blend[1, lane]


@njit(cache=True, error_model="numpy")
def spread(large, body, contact, state, displacement, depth, done, widening, swelling, growth):
    """Write how forces and area of the contact depend on each other, for Newton's method.

    Parameters
    ----------
    widening : ndarray, shape (size + 1, LANES)
        Out: derivative of the area by the displacements, and by the depth as its last row.
    swelling : ndarray, shape (size + 1, LANES)
        Out: derivative of the residual by the area, at the same load, whose pressure and width follow.
    growth : ndarray, shape (LANES,)
        Out: derivative of the load by the area.
    """
    size, count = body.size, body.radial.shape[0]
    wider = ContactState(
        state.pressure.copy(), state.area * (1.0 + WIDER), state.rise.copy(), state.blend.copy(), state.strongest,
        state.widest, state.anchor, state.share, state.place,
    )  # fmt: skip
    for lane in range(LANES):
        take_pressure(contact, wider, state.pressure[lane] / (1.0 + WIDER), lane)
    load, tangent, now = np.zeros(LANES), np.zeros((count, 2, 4, LANES)), np.zeros_like(swelling)
    contact_forces(large, body, contact, state, displacement, depth, now, load, tangent, done)
    swelling[:] = 0.0
    contact_forces(large, body, contact, wider, displacement, depth, swelling, growth, tangent, done)
    step = WIDER * state.area
    swelling[:] = (swelling - now) / step
    growth[:] = (growth - load) / step
    touched, _ = touching(large, body, contact, state, displacement, depth, done)
    reached, _ = touching(large, body, contact, wider, displacement, depth, done)
    feedback = 1.0 - (reached - touched) / step
    widening[:] = 0.0
    for k in range(count):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            if done[lane]:
                continue
            x, _, slope, _ = penetration(large, body, contact, state, displacement, depth, k, lane)
            density = math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
            rate = contact.area[k] * density / width_of(contact, state, k, lane) / feedback[lane]
            widening[z, lane] += rate
            widening[size, lane] += rate
            if r >= 0:
                widening[r, lane] -= rate * slope


@njit(cache=True, error_model="numpy")
def attraction_on(contact, state, x, k, lane):
    """Return the force of attraction on a node, and its derivative by the penetration."""
    share, density = normal_distribution(x), math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    gap = width_of(contact, state, k, lane) * (x * share + density - x)
    pull = contact.attraction[k, lane] * math.exp(-gap / contact.reach[lane])
    return pull, pull * (1.0 - share) / contact.reach[lane]


@njit(cache=True, error_model="numpy")
def end_step(large, body, contact, state, displacement, depth):
    """Note how large force and area have been, and move the anchors of friction to where they are."""
    for lane in range(LANES):
        state.strongest[lane] = max(state.strongest[lane], state.pressure[lane] * state.area[lane])
        state.widest[lane] = max(state.widest[lane], state.area[lane])
    if not np.any(contact.friction > 0.0):
        return
    for k in range(body.radial.shape[0]):
        for lane in range(LANES):
            x, place, _, _ = penetration(large, body, contact, state, displacement, depth, k, lane)
            slip = 2.0 * contact.slip[k, lane]
            anchor = anchored(state, place, normal_distribution(x), k, lane)
            state.anchor[k, lane] = min(max(anchor, place - slip), place + slip)


@njit(cache=True, error_model="numpy")
def contact_forces(large, body, contact, state, displacement, depth, forces, load, tangent, done):
    """Add the contact to the residual `forces` (size + 1, LANES); write `load` (LANES,) and `tangent` (k, 2, 4, LANES).

    The tangent holds the derivatives of a node's radial residual by u_r and by u_z, and those of its vertical one; by
    the depth they are those by u_z. The second of the two leaves out what keeps a matrix from being positive definite:
    the rise of the force where b < 1 makes it fall, attraction that decays, and a tip that curves away.
    """
    load[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            if done[lane]:
                continue
            x, place, slope, curvature = penetration(large, body, contact, state, displacement, depth, k, lane)
            push, rate = force_on(contact, state, x, k, lane)
            if r < 0:
                slope, curvature = 0.0, 0.0
            net, net_rate = push, rate
            if contact.attraction[k, lane] > 0.0:
                pull, pull_rate = attraction_on(contact, state, x, k, lane)
                net, net_rate = net - pull, net_rate - pull_rate
            pressing, pressing_rate = max(push, 0.0), rate if push > 0.0 else 0.0
            m, m_r, m_g = 0.0, 0.0, 0.0
            if contact.friction[lane] > 0.0 and r >= 0:
                width = width_of(contact, state, k, lane)
                m, m_r, m_g = friction_ratio(contact, state, place, normal_distribution(x), x, width, k, lane)
            forces[z, lane] += net + m * pressing * slope
            load[lane] += net + m * pressing * slope
            if r >= 0:
                forces[r, lane] += m * pressing - net * slope
            for part in range(2):
                if part == 1:
                    net_rate, curvature = max(rate, 0.0), min(curvature, 0.0)
                along = m * pressing_rate + m_g * pressing
                by_gap, vertical = along - net_rate * slope, net_rate + along * slope
                tangent[k, part, 0, lane] = m_r * pressing - by_gap * slope - net * curvature
                tangent[k, part, 1, lane] = by_gap
                tangent[k, part, 2, lane] = m_r * pressing * slope - vertical * slope + m * pressing * curvature
                tangent[k, part, 3, lane] = vertical


@njit(cache=True)
def add_tangent(body, tangent, geometric, lower, upper, column, row, corner):
    """Add the tangent of the contact to the band; write column and row (size + 1, LANES) and diagonal of the depth.

    Without friction the matrix is symmetric: `upper` is empty, see `palpate.fem.batch_banded`, and the `row` the
    `column`. `geometric` (LANES,) is zero where the matrix is to be positive definite.
    """
    symmetric = len(upper) == 0
    column[:] = 0.0
    corner[:] = 0.0
    if not symmetric:
        upper[:] = lower
        row[:] = 0.0
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            part = 0 if geometric[lane] > 0.0 else 1
            vertical = tangent[k, part, 3, lane]
            lower[entry(z, z, body.width), lane] += vertical
            column[z, lane] += vertical
            corner[lane] += vertical
            if not symmetric:
                row[z, lane] += vertical
            if r >= 0:
                by_gap, across = tangent[k, part, 1, lane], tangent[k, part, 2, lane]
                lower[entry(r, r, body.width), lane] += tangent[k, part, 0, lane]
                lower[entry(z, r, body.width), lane] += by_gap
                column[r, lane] += by_gap
                if not symmetric:
                    upper[entry(z, r, body.width), lane] += across
                    row[r, lane] += across


@njit(cache=True, inline="always")
def entry(i, j, width):
    """Return where the band holds the entry (i, j)."""
    return min(i, j) * width + abs(i - j)
