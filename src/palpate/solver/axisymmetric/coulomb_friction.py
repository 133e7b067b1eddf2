"""Coulomb friction along the generator of a rigid tip, in SIMD lanes.

The tip moves along z only, so a node at the distance R from the axis slips exactly when R changes. Friction T = -m N
opposes the slip,

    m = mu tanh((R - A) / d),

with the anchor A, which a node that slips drags along at the distance 2 d. The little slip d replaces sticking; in
proportion to the rise of the tip it adds no length to a sharp cone.

A node comes to touch gradually. What comes to touch of it in a step is anchored where it then is, midway, and the
anchor is the mean over all that touches: with the shares S_0 and S_1 > S_0 that touch before and after a step

    A_1 = (S_0 A_0 + (S_1 - S_0) (R_0 + R_1) / 2) / S_1.

Source: return mapping after Wriggers, Computational Contact Mechanics, 2nd ed. (2006), chapter 5.

Arguments of the functions:

- `contact`, `state`: see `palpate.solver.axisymmetric.contact`
- `k`, `lane`: number of a surface node, and of a lane
- `place`: distance R of the node from the axis
- `share`, `density`, `width`: share of the node that touches, its derivative by x = g / w, and the width w of
  `palpate.solver.axisymmetric.contact`
- `done` (LANES,): lanes that are left as they are
"""

from __future__ import annotations

import math

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES

LEAST_SHARE = 1e-12  # of a node's area in contact, below which it knows no friction
SLIPPING = 1.0  # slip in units of d from which a node counts as slipping
SATURATED = 20.0  # from which tanh is one


@inner_kernel(cache=True, error_model="numpy")
def anchored(state, place, share, k, lane):
    """Return the anchor of a node at a `place`, of which such a `share` touches."""
    before = state.share[k, lane]
    if share <= before:
        return state.anchor[k, lane]
    return (before * state.anchor[k, lane] + (share - before) * 0.5 * (state.place[k, lane] + place)) / share


@inner_kernel(cache=True, error_model="numpy")
def friction_ratio(contact, state, place, share, density, width, k, lane):
    """Return m with its derivatives by the distance from the axis, and by the gap."""
    mu, slip_length, before = contact.friction[lane], contact.slip[k, lane], state.share[k, lane]
    if share < LEAST_SHARE:
        return 0.0, 0.0, 0.0
    slip = (place - anchored(state, place, share, k, lane)) / slip_length
    if abs(slip) > SATURATED:
        return math.copysign(mu, slip), 0.0, 0.0
    m = mu * math.tanh(slip)
    rate = (mu - m * m / mu) / slip_length
    if share <= before:
        return m, rate, 0.0
    midway = 0.5 * (state.place[k, lane] + place)
    drag = before * (midway - state.anchor[k, lane]) / share**2 * density / width
    return m, rate * (1.0 - 0.5 * (share - before) / share), -rate * drag


@inner_kernel(cache=True, error_model="numpy")
def turn_back(setup, trial, shares, slips, changed, done):
    """Put nodes whose slip reverses within one iteration back to where they stuck.

    Parameters
    ----------
    setup, trial
        See `palpate.solver.axisymmetric.trial_state`.
    shares : ndarray, shape (k, LANES)
        Of the nodes that touch.
    slips : ndarray, shape (k, LANES)
        In: slip in the iteration before; out: now.
    changed : ndarray of bool, shape (LANES,)
        Out: whether some node began or ceased to slip.
    """
    contact, state, displacement = setup.contact, trial.contact, trial.displacement
    distance, radial = setup.body.distance, setup.body.radial
    changed[:] = False
    for k in range(1, len(distance)):
        for lane in range(LANES):
            if done[lane] or contact.friction[lane] == 0.0 or shares[k, lane] < LEAST_SHARE:
                continue
            place = distance[k] + displacement[radial[k], lane]
            anchor = anchored(state, place, shares[k, lane], k, lane)
            slip, past = (place - anchor) / contact.slip[k, lane], slips[k, lane]
            if slip * past < 0.0 and min(abs(slip), abs(past)) > SLIPPING:
                displacement[radial[k], lane] = anchor - distance[k]
                slip = 0.0
            if (abs(slip) > SLIPPING) != (abs(past) > SLIPPING):
                changed[lane] = True
            slips[k, lane] = slip
