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
- `k`, `lane`: number of a surface node, and of a lane
- `done` (LANES,): lanes that are left as they are
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.coulomb_friction import anchored, friction_ratio
from palpate.solver.axisymmetric.lanes import LANES
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


@inner_kernel(cache=True)
def normal_distribution(x):
    """Return Phi(x), not below 1e-28, and phi(x)."""
    return 0.5 * math.erfc(-math.sqrt(0.5) * max(x, -11.0)), math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)


@njit(cache=True)
def touching(x):
    """Return which share of a node belongs to the area of the contact, and its derivative by x."""
    share, density = normal_distribution(STEEP * (x + BEFORE))
    return share, STEEP * density


@inner_kernel(cache=True, error_model="numpy")
def width_of(contact, state, k, lane):
    """Return the width w over which the gap of a node closes."""
    return contact.width[k, lane] * state.rise[lane]


@inner_kernel(cache=True, error_model="numpy")
def penetration(setup, trial, k, lane):
    """Return x = g / w of a node, its distance from the axis, and slope and curvature of the tip over it."""
    r, z, distance = setup.body.radial[k], setup.body.vertical[k], setup.body.distance[k]
    moved = trial.displacement[r, lane] if r >= 0 else 0.0
    height, slope, curvature = profile_at(setup.large, setup.contact.tip, lane, distance, moved)
    x = (trial.depth[lane] + trial.displacement[z, lane] - height) / width_of(setup.contact, trial.contact, k, lane)
    return x, distance + moved, slope, curvature


@inner_kernel(cache=True, error_model="numpy")
def share_of(setup, trial, k, lane):
    """Return which share of a node touches, and where it is."""
    x, place, _, _ = penetration(setup, trial, k, lane)
    return touching(x)[0], place


@inner_kernel(cache=True, error_model="numpy")
def fit(contact, state, borne, done):
    """Let pressure, width and b be what they are at the state's area where the contact has `borne` (LANES,) so much."""
    for lane in range(LANES):
        if done[lane]:
            continue
        area = state.area[lane]
        pressure, stiffness, rise, blend = fitted(contact, state, borne[lane], area, lane)
        _, stiffer, steeper, blended = fitted(contact, state, borne[lane], area * (1.0 + WIDER), lane)
        state.pressure[lane], state.stiffness[lane] = pressure, stiffness
        state.rise[lane], state.blend[lane] = rise, blend
        state.by_area[0, lane] = (stiffer / stiffness - 1.0) / (WIDER * area)
        state.by_area[1, lane] = (steeper / rise - 1.0) / (WIDER * area)
        state.by_area[2, lane] = (blended - blend) / (WIDER * area)


@inner_kernel(cache=True)
def pull_on(contact, area, lane):
    """Return the attraction of a contact of some `area`."""
    return contact.strength[lane] * area


@inner_kernel(cache=True, error_model="numpy")
def fitted(contact, state, borne, area, lane):
    """Return p, C p, rise and b of a contact of some `area` under a load; attraction presses it as much as it pulls.

    Parameters
    ----------
    borne
        Load of the contact.
    area
        Area of the contact.
    """
    pull = pull_on(contact, area, lane)
    push = max(borne + pull, LEAST_PRESSURE * pull)
    edge, widest = math.sqrt(area / math.pi), max(state.widest[lane], area)
    height, slope, _ = profile_at(True, contact.tip, lane, edge, 0.0)
    inner_height, inner_slope, _ = profile_at(True, contact.tip, lane, INSIDE * edge, 0.0)
    n = min(1.0 + math.log(slope / inner_slope) / math.log(1.0 / INSIDE), STEEPEST)
    chord = (height - inner_height) / ((1.0 - INSIDE) * edge)
    usual = max(state.strongest[lane], push) / widest
    least = math.hypot(LEAST_AREA * widest, contact.area[0] + contact.area[1])
    pressure = max(push / math.hypot(area, least), LEAST_PRESSURE * usual)
    rise = (
        chord
        * (1.0 + (n - 1.0) * (1.0 - INSIDE) / (1.0 + INSIDE))
        * math.sqrt(min(1.0, pressure / (NARROWING * usual)))
    )
    cone, sphere = contact.stiffness[0, lane], contact.stiffness[1, lane]
    blend = contact.blend[0, lane] + (n - 1.0) * (contact.blend[1, lane] - contact.blend[0, lane])
    return pressure, pressure * cone * (sphere / cone) ** (n - 1.0), rise, blend


@njit(cache=True, error_model="numpy")
def begin_step(setup, trial):
    """Note where the nodes are, and which share of them touches, at the start of a step with friction."""
    if not np.any(setup.contact.friction > 0.0):
        return
    for k in range(setup.body.radial.shape[0]):
        for lane in range(LANES):
            share, place = share_of(setup, trial, k, lane)
            trial.contact.share[k, lane], trial.contact.place[k, lane] = share, place


@njit(cache=True, error_model="numpy")
def end_step(setup, trial):
    """Note how large force and area have been, and move the anchors of friction to where they are."""
    contact, state = setup.contact, trial.contact
    for lane in range(LANES):
        state.strongest[lane] = max(state.strongest[lane], state.pressure[lane] * state.area[lane])
        state.widest[lane] = max(state.widest[lane], state.area[lane])
    if not np.any(contact.friction > 0.0):
        return
    for k in range(setup.body.radial.shape[0]):
        for lane in range(LANES):
            share, place = share_of(setup, trial, k, lane)
            slip = 2.0 * contact.slip[k, lane]
            state.anchor[k, lane] = min(max(anchored(state, place, share, k, lane), place - slip), place + slip)


@inner_kernel(cache=True, error_model="numpy")
def contact_forces(setup, trial, forces, coupling, done):
    """Add the contact to the residual `forces` (size + 1, LANES); write the reaction and the `coupling`."""
    body, contact, state, load = setup.body, setup.contact, trial.contact, trial.reaction
    for lane in range(LANES):
        if not done[lane]:
            load[lane], coupling.area[lane], coupling.feedback[lane] = 0.0, 0.0, 0.0
    for k in range(body.radial.shape[0]):
        r, z = body.radial[k], body.vertical[k]
        for lane in range(LANES):
            if done[lane]:
                continue
            x, place, slope, curvature = penetration(setup, trial, k, lane)
            if x < FAR and contact.attraction[k, lane] == 0.0:
                coupling.tangent[k, :, :, lane] = 0.0
                coupling.by_area[k, :, lane] = 0.0
                coupling.touching[k, :, lane] = 0.0
                continue
            width = width_of(contact, state, k, lane)
            pressing, widening, blending = state.by_area[0, lane], state.by_area[1, lane], state.by_area[2, lane]
            share, density = normal_distribution(x)
            blend, scale = state.blend[lane], state.stiffness[lane] * contact.area[k]
            push, rate = scale * (x * share + blend * density), scale * (share + (1.0 - blend) * x * density) / width
            swell = push * pressing - rate * x * width * widening + scale * density * blending
            if r < 0:
                slope, curvature = 0.0, 0.0
            net, net_rate, net_swell = push, rate, swell
            if contact.attraction[k, lane] > 0.0:
                gap, reach = width * (x * share + density - x), contact.reach[lane]
                pull = contact.attraction[k, lane] * math.exp(-gap / reach)
                net, net_rate = net - pull, net_rate - pull * (1.0 - share) / reach
                net_swell += pull * width * widening * density / reach
            if push <= 0.0:
                push, rate, swell = 0.0, 0.0, 0.0
            within, spreading = touching(x)
            m, m_r, m_g = 0.0, 0.0, 0.0
            if contact.friction[lane] > 0.0 and r >= 0:
                m, m_r, m_g = friction_ratio(contact, state, place, within, spreading, width, k, lane)
            along_swell = m * swell - m_g * push * x * width * widening
            forces[z, lane] += net + m * push * slope
            load[lane] += net + m * push * slope
            coupling.by_area[k, 1, lane] = net_swell + along_swell * slope
            coupling.area[lane] += contact.area[k] * within
            coupling.feedback[lane] -= contact.area[k] * spreading * x * widening
            coupling.touching[k, 1, lane] = contact.area[k] * spreading / width
            if r >= 0:
                forces[r, lane] += m * push - net * slope
                coupling.by_area[k, 0, lane] = along_swell - net_swell * slope
                coupling.touching[k, 0, lane] = -coupling.touching[k, 1, lane] * slope
            for part in range(2):
                if part == 1:
                    net_rate, curvature = max(rate, 0.0), min(curvature, 0.0)
                along = m * rate + m_g * push
                by_gap, vertical = along - net_rate * slope, net_rate + along * slope
                coupling.tangent[k, part, 0, lane] = m_r * push - by_gap * slope - net * curvature
                coupling.tangent[k, part, 1, lane] = by_gap
                coupling.tangent[k, part, 2, lane] = m_r * push * slope - vertical * slope + m * push * curvature
                coupling.tangent[k, part, 3, lane] = vertical
