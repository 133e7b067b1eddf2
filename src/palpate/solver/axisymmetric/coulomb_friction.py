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
- `k`: number of a surface node
- `place`: distance R of the node from the axis, in each lane
- `share`, `density`, `width`: share of the node that touches, its derivative by x = g / w, and the width w of
  `palpate.solver.axisymmetric.contact`, in each lane
- `done` (LANES,): lanes that are left as they are
"""

from __future__ import annotations

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import (
    LANES,
    exponential,
    larger,
    load,
    magnitude,
    smaller,
    splat,
    store,
    where_less,
)
from palpate.solver.axisymmetric.rows import as_vector

LEAST_SHARE = 1e-12  # of a node's area in contact, below which it knows no friction
SLIPPING = 1.0  # slip in units of d from which a node counts as slipping
SATURATED = 20.0  # from which tanh is one


@inner_kernel(cache=True, error_model="numpy")
def anchored(state, place, share, k):
    """Return the anchor of a node at a `place`, of which such a `share` touches."""
    before, anchor = load(state.share, k), load(state.anchor, k)
    mean = (before * anchor + (share - before) * 0.5 * (load(state.place, k) + place)) / share
    return where_less(before, share, mean, anchor)


@inner_kernel(cache=True, error_model="numpy")
def friction_ratio(contact, state, place, share, density, width, k):
    """Return m with its derivatives by the distance from the axis, and by the gap."""
    mu, slip_length, before, none = load(contact.friction, 0), load(contact.slip, k), load(state.share, k), splat(0.0)
    mu = where_less(share, splat(LEAST_SHARE), none, mu)
    slip = (place - anchored(state, place, share, k)) / slip_length
    slip = smaller(larger(slip, splat(-SATURATED)), splat(SATURATED))
    tanh = 1.0 - 2.0 / (exponential(2.0 * slip) + 1.0)
    rate = mu * (1.0 - tanh * tanh) / slip_length
    drag = before * (0.5 * (load(state.place, k) + place) - load(state.anchor, k)) / (share * share) * density / width
    grown = where_less(before, share, rate * (1.0 - 0.5 * (share - before) / share), rate)
    acting = where_less(none, mu, splat(1.0), none)
    by_gap = where_less(before, share, none - rate * drag, none)
    return mu * tanh, where_less(none, acting, grown, none), where_less(none, acting, by_gap, none)


@inner_kernel(cache=True, error_model="numpy")
def reverse_slip(setup, trial, shares, slips, changed, done):
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
    distance, radial, none, one = setup.body.distance, setup.body.radial, splat(0.0), splat(1.0)
    rubs = where_less(as_vector(done), splat(0.5), where_less(none, load(contact.friction, 0), one, none), none)
    some = none
    for k in range(1, len(distance)):
        share, moved, past = load(shares, k), load(displacement, radial[k]), load(slips, k)
        acts = where_less(share, splat(LEAST_SHARE), none, rubs)
        anchor = anchored(state, distance[k] + moved, share, k)
        slip = (distance[k] + moved - anchor) / load(contact.slip, k)
        nearer = smaller(magnitude(past), magnitude(slip))
        turns = where_less(slip * past, none, where_less(splat(SLIPPING), nearer, acts, none), none)
        slip = where_less(none, turns, none, slip)
        slid = where_less(splat(SLIPPING), magnitude(past), one, none)
        slides = where_less(splat(SLIPPING), magnitude(slip), one, none)
        some = some + acts * magnitude(slides - slid)
        store(displacement, radial[k], where_less(none, turns, anchor - distance[k], moved))
        store(slips, k, where_less(none, acts, slip, past))
    flags = np.empty(LANES)
    store(flags, 0, some)
    for lane in range(LANES):
        changed[lane] = flags[lane] > 0.0
