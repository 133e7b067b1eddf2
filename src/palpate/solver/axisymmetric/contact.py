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

    w = s l f',    pi a^2 = sum A Phi(2 x + 2),    p = F / (pi a^2),

with the local distance l of nodes and the slope f' that the tip has up to that edge. C and b depend on the exponent n
of the tip there, which is 1 under a cone and 2 under a sphere. Where the pressure falls far below what it was at the
largest load, w narrows with its root. Both a and p belong to the equilibrium that a step looks for, so the contact has
no history but the largest force and area so far. Nothing here has a length or a stress of its own: scaling laws of
sharp tips hold exactly. At given a and p the force has a potential, so the stiffness is symmetric without friction.

Sources: for regularised contact P. Wriggers, Computational Contact Mechanics, 2nd ed. (2006), section 6.3; for kernels
of higher order M. P. Wand & M. C. Jones, Kernel Smoothing (1995), section 2.8.

Arguments of several functions:

- `setup`, `trial`: see `palpate.solver.axisymmetric.trial_state`; at large strains the profile of the tip counts where
  a node has moved to
- `contact`, `state`: `Contact` and `ContactState`
- `k`: number of a surface node
- `done` (LANES,): lanes that are left as they are
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.coulomb_friction import anchored, friction_ratio
from palpate.solver.axisymmetric.lanes import (
    exponential,
    larger,
    load,
    logarithm,
    root,
    smaller,
    splat,
    store,
    where_less,
)
from palpate.solver.axisymmetric.normal_lanes import normal_distribution
from palpate.solver.axisymmetric.rows import as_vector
from palpate.solver.axisymmetric.tip import Tip, profile_at

FARTHEST = 4.0  # of the largest contact radius, beyond which the distance of nodes counts as no larger
SLIP = 2e-3  # of the tip's rise, that precedes the limit of friction
STEEP, BEFORE = 2.0, 1.0  # a node within touches, one at the edge by its half: Phi(STEEP (x + BEFORE))
STEEPEST = 2.25  # exponent of a tip that counts
INSIDE = 0.7  # of the contact radius, from where on the exponent of the tip is taken
LEAST_AREA = 0.05  # of the largest, below which the pressure falls
LEAST_PRESSURE = 0.02  # of the pressure at the largest load, below which the contact counts as that stiff
NARROWING = 0.5  # of the pressure at the largest load, below which the contact becomes narrower
WIDER = 1e-6  # of the area, for derivatives by it
FAR = -8.0  # widths, beyond which a node bears nothing
WEAKEST = -700.0  # exponent of the attraction that counts


class Contact(NamedTuple):
    """What of the contact stays during a simulation.

    Attributes
    ----------
    tip : Tip
    width : ndarray, shape (k, LANES)
        s l of each surface node.
    area : ndarray, shape (k,)
        Area that belongs to each of them.
    stiffness, blend : ndarray, shape (2, LANES)
        C and b under tips of n = 1, and of n = 2.
    attraction : ndarray, shape (k, LANES)
        Largest force of attraction of each node along z; zero without adhesion.
    strength, reach : ndarray, shape (LANES,)
        Largest traction of the attraction, and gap over which it falls by e.
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
    strength: np.ndarray
    reach: np.ndarray
    friction: np.ndarray
    slip: np.ndarray


class ContactState(NamedTuple):
    """What of it changes.

    Attributes
    ----------
    area : ndarray, shape (LANES,)
        pi a^2, an unknown of the equilibrium.
    pressure, stiffness, rise, blend : ndarray, shape (LANES,)
        p, C p, w / (s l) and b.
    by_area : ndarray, shape (3, LANES)
        Derivatives by the area of the logarithms of C p and w, and of b.
    strongest, widest : ndarray, shape (LANES,)
        Largest force p pi a^2 and largest area so far.
    anchor, share, place : ndarray, shape (k, LANES)
        See `palpate.solver.axisymmetric.coulomb_friction`.
    """

    area: np.ndarray
    pressure: np.ndarray
    stiffness: np.ndarray
    rise: np.ndarray
    blend: np.ndarray
    by_area: np.ndarray
    strongest: np.ndarray
    widest: np.ndarray
    anchor: np.ndarray
    share: np.ndarray
    place: np.ndarray


@inner_kernel(cache=True, error_model="numpy")
def touching(x):
    """Return which share of a node belongs to the area of the contact, and its derivative by x."""
    share, density = normal_distribution(STEEP * (x + BEFORE))
    return share, STEEP * density


@inner_kernel(cache=True, error_model="numpy")
def width_of(contact, state, k):
    """Return the width w over which the gap of a node closes."""
    return load(contact.width, k) * load(state.rise, 0)


@inner_kernel(cache=True, error_model="numpy")
def penetration(setup, trial, k):
    """Return x = g / w of a node, its distance from the axis, and slope and curvature of the tip over it."""
    r, z, distance = setup.body.radial[k], setup.body.vertical[k], splat(setup.body.distance[k])
    moved = load(trial.displacement, r) if r >= 0 else splat(0.0)
    height, slope, curvature = profile_at(setup.large, setup.contact.tip, distance, moved)
    gap = load(trial.depth, 0) + load(trial.displacement, z) - height
    return gap / width_of(setup.contact, trial.contact, k), distance + moved, slope, curvature


@inner_kernel(cache=True, error_model="numpy")
def share_of(setup, trial, k):
    """Return which share of a node touches, and where it is."""
    x, place, _, _ = penetration(setup, trial, k)
    return touching(x)[0], place


@inner_kernel(cache=True, error_model="numpy")
def fit(contact, state, borne, done):
    """Let pressure, width and b be what they are at the state's area where the contact has `borne` (LANES,) so much."""
    kept, half, area = as_vector(done), splat(0.5), load(state.area, 0)
    pressure, stiffness, rise, blend = fitted(contact, state, load(borne, 0), area)
    _, stiffer, steeper, blended = fitted(contact, state, load(borne, 0), area * (1.0 + WIDER))
    more = WIDER * area
    for now, new in (
        (state.pressure, pressure), (state.stiffness, stiffness), (state.rise, rise), (state.blend, blend),
    ):  # fmt: skip
        store(now, 0, where_less(half, kept, load(now, 0), new))
    slopes = (stiffer / stiffness - 1.0) / more, (steeper / rise - 1.0) / more, (blended - blend) / more
    for i, slope in enumerate(slopes):
        store(state.by_area, i, where_less(half, kept, load(state.by_area, i), slope))


@inner_kernel(cache=True, error_model="numpy")
def fitted(contact, state, borne, area):
    """Return p, C p, rise and b of a contact of some `area` under a load; attraction presses it as much as it pulls.

    Parameters
    ----------
    borne, area
        Load and area of the contact, in each lane.
    """
    pull = load(contact.strength, 0) * area
    push = larger(borne + pull, LEAST_PRESSURE * pull)
    edge, widest, none = root(area * (1.0 / math.pi)), larger(load(state.widest, 0), area), splat(0.0)
    height, slope, _ = profile_at(True, contact.tip, edge, none)
    inner_height, inner_slope, _ = profile_at(True, contact.tip, INSIDE * edge, none)
    more = smaller(logarithm(slope / inner_slope) * (1.0 / math.log(1.0 / INSIDE)), splat(STEEPEST - 1.0))
    chord = (height - inner_height) / ((1.0 - INSIDE) * edge)
    usual = larger(load(state.strongest, 0), push) / widest
    first, least = contact.area[0] + contact.area[1], LEAST_AREA * widest
    pressure = larger(push / root(area * area + least * least + first * first), LEAST_PRESSURE * usual)
    narrower = root(smaller(splat(1.0), pressure / (NARROWING * usual)))
    rise = chord * (1.0 + more * ((1.0 - INSIDE) / (1.0 + INSIDE))) * narrower
    cone, sphere = load(contact.stiffness, 0), load(contact.stiffness, 1)
    blend = load(contact.blend, 0) + more * (load(contact.blend, 1) - load(contact.blend, 0))
    return pressure, pressure * cone * exponential(more * logarithm(sphere / cone)), rise, blend


@njit(cache=True, error_model="numpy")
def begin_step(setup, trial):
    """Note where the nodes are, and which share of them touches, at the start of a step with friction."""
    if not np.any(setup.contact.friction > 0.0):
        return
    for k in range(setup.body.radial.shape[0]):
        share, place = share_of(setup, trial, k)
        store(trial.contact.share, k, share)
        store(trial.contact.place, k, place)


@njit(cache=True, error_model="numpy")
def end_step(setup, trial):
    """Note how large force and area have been, and move the anchors of friction to where they are."""
    contact, state = setup.contact, trial.contact
    area = load(state.area, 0)
    store(state.strongest, 0, larger(load(state.strongest, 0), load(state.pressure, 0) * area))
    store(state.widest, 0, larger(load(state.widest, 0), area))
    if not np.any(contact.friction > 0.0):
        return
    for k in range(setup.body.radial.shape[0]):
        share, place = share_of(setup, trial, k)
        slip = 2.0 * load(contact.slip, k)
        store(state.anchor, k, smaller(larger(anchored(state, place, share, k), place - slip), place + slip))


@inner_kernel(cache=True, error_model="numpy")
def contact_forces(setup, trial, forces, coupling):
    """Add the contact to the residual `forces` (size + 1, LANES); write the reaction and the `coupling`."""
    body, contact, state, none = setup.body, setup.contact, trial.contact, splat(0.0)
    pressing, widening, blending = load(state.by_area, 0), load(state.by_area, 1), load(state.by_area, 2)
    blend, reach, borne, area, feedback = load(state.blend, 0), load(contact.reach, 0), none, none, none
    rough = np.any(contact.friction > 0.0)
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        x, place, slope, curvature = penetration(setup, trial, k)
        width, scale = width_of(contact, state, k), load(state.stiffness, 0) * contact.area[k]
        share, density = normal_distribution(x)
        share, density = where_less(x, splat(FAR), none, share), where_less(x, splat(FAR), none, density)
        within, spreading = touching(x)
        if r < 0:
            slope, curvature = none, none
        push, rate = scale * (x * share + blend * density), scale * (share + (1.0 - blend) * x * density) / width
        swell = push * pressing - rate * x * width * widening + scale * density * blending
        hold, gap = load(contact.attraction, k), width * (x * share + density - x)
        pull = hold * exponential(larger(none - gap / reach, splat(WEAKEST)))
        net, net_rate = push - pull, rate - pull * (1.0 - share) / reach
        net_swell = swell + pull * width * widening * density / reach
        presses = where_less(none, push, splat(1.0), none)
        push, rate, swell = presses * push, presses * rate, presses * swell
        m, m_r, m_g = none, none, none
        if rough and r >= 0:
            m, m_r, m_g = friction_ratio(contact, state, place, within, spreading, width, k)
        along_swell = m * swell - m_g * push * x * width * widening
        vertical = net + m * push * slope
        store(forces, z, load(forces, z) + vertical)
        borne, area = borne + vertical, area + contact.area[k] * within
        feedback = feedback - contact.area[k] * spreading * x * widening
        spread = contact.area[k] * spreading / width
        store(coupling.by_area, 2 * k + 1, net_swell + along_swell * slope)
        store(coupling.touching, 2 * k + 1, spread)
        if r >= 0:
            store(forces, r, load(forces, r) + (m * push - net * slope))
            store(coupling.by_area, 2 * k, along_swell - net_swell * slope)
            store(coupling.touching, 2 * k, none - spread * slope)
        for part in range(2):
            if part == 1:
                net_rate, curvature = larger(rate, none), smaller(curvature, none)
            along, row = m * rate + m_g * push, 8 * k + 4 * part
            by_gap, upright = along - net_rate * slope, net_rate + along * slope
            store(coupling.tangent, row, m_r * push - by_gap * slope - net * curvature)
            store(coupling.tangent, row + 1, by_gap)
            store(coupling.tangent, row + 2, m_r * push * slope - upright * slope + m * push * curvature)
            store(coupling.tangent, row + 3, upright)
    store(trial.reaction, 0, borne)
    store(coupling.area, 0, area)
    store(coupling.feedback, 0, feedback)
