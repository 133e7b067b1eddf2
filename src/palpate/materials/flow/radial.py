"""Radial flow: the one scalar equation behind every law of the project, for one point or for the lanes of a vector.

Every inelastic rate here is parallel to the deviatoric stress s, so the implicit update needs one unknown,
q = sqrt(s:s/2). With the deviatoric strain e split into elastic, creep, Voigt and plastic parts, a step ends with

    V(q, p) + (sqrt(3)/2) dalpha = rho,   s = (q/rho) R,   rho = sqrt(R:R/2),
    V = q/(2G) + sum_i (dt/2) phi_i(q, p) q + sum_k c_k phi_k(q, p) q,

where R is e less all that the history fixes and the phi are fluidities of the terms. A fluidity that falls with the
equivalent strain alpha of its own flow takes alpha at the end of the step, alpha + g phi, so that it is implicit in
its law's file and V keeps its one unknown. The pressure p is that of the
element, p = -K tr(eps), so that the update stays radial. Creep rates are trapezoidal in time; a Voigt strain is
integrated exactly for a driving term linear in time,

    e_t(t+dt) = a e_t(t) + b f(t) + c f(t+dt),   f = phi s,   a = exp(-x),  c = 1 - (1-a)/x,  b = (1-a)/x - a,

with x = dt/t_eps, so it is second order for small steps and stable for steps much longer than t_eps. Plastic flow is
rate-independent, sqrt(3) q = sigma(alpha, p). Where a resistance r acts, a term flows at the stress over r.

A back stress X = c e_f in proportion to the strain e_f of all terms but linear Voigt elements acts against them: eta =
s - X drives them in place of s, while s drives Hooke's law and linear Voigt elements, of compliance B together. With
e_f0 the part of e_f that the history fixes and eta = (q/rho) R, the strains add to (1 + B c) e_f + B eta, so that

    R = e'/(1 + B c) - e_f0,   V = B q/(1 + B c) + ...,   s = q R / (rho (1 + B c)) + c R + c e_f0,

where e' is e less what the history fixes of the linear Voigt elements: the same equation with another R and B.

The unknown is y = ln q. On doubly logarithmic axes every power law is straight and every law here convex, so that
Newton's method for ln(V/rho) = 0 converges from above, and for power laws at once; far from the solution its steps are
limited and kept between brackets. The term of second order that
Halley's method adds leaves an error of third order; near the solution ln(V/rho) is 2 (z + z^3/3 + ...) with
z = (V - rho)/(V + rho), and no logarithm is needed. With plastic flow the unknown is ln(dalpha), since a yield stress
may begin with an infinite slope or end with none; brackets guard Newton's method. Where a fluidity grows exponentially
with the stress, each of Newton's steps takes no more than a factor of e off V; some iterations then halve the bracket
instead. A stress that is not found is NaN.

Source: radial return after Simo & Hughes, Computational Inelasticity (1998), sections 3.3 and 3.6; W. Prager, J. Appl.
Mech. 23 (1956) 493-496, for the back stress.

Arguments of the functions, scalars or vectors of lanes:

- `rho`, `q`, `log_q`: invariants of the trial strain R [-] and of the stress [GPa], and the logarithm of q
- `order`, `push`: d ln q / d ln rho, and dq/dp at constant rho
- `least`: the q at which plastic flow begins [GPa]
- `alpha`, `pressure`: hardening variable as the history fixes it, and pressure at the end of the step [GPa]
- `law`, `step`: row of the law, and its weights in the time step, see `palpate.materials.flow.row`
"""

from __future__ import annotations

import math

from numba import njit

from palpate.materials.flow.arithmetic import (
    constant,
    entry,
    exponential,
    greatest,
    logarithm,
    magnitude,
    rough_log,
    where_less,
    whole,
)
from palpate.materials.flow.dispatch import fluidity_of, strength_of
from palpate.materials.flow.row import (
    ACTIVE,
    COMPLIANCE,
    FACTORS,
    FIRST,
    FLOWING,
    FUNCTION,
    GAIN,
    INVERSE_RESISTANCE,
    LOG_RESISTANCE,
    NO_SHARE,
    NUMBERS,
    PER_TERM,
    SHARE,
    SHEAR,
    SIZE,
    SPLIT,
    STIFFENING,
    YIELD,
)

ITERATIONS = 60  # of either iteration; a few suffice
HALVING = 30, 45  # iterations with plastic flow that halve the bracket, begun and ended; Newton's method ends it
TOLERANCE = 1e-5  # of ln q; the change that is smaller is still made, so the error left is of its third power
SQUARED = 1e-7  # of rho, with plastic flow: the error left is of its second power
NOTHING = 1e-150  # takes the place of rho = 0, so that the direction R / rho exists
UNKNOWN = -45.0  # below it ln q is no guess: from there all `ITERATIONS` would be steps of `UP`
FAR = 0.6  # value of z beyond which the logarithm of V/rho is taken
LATE = 12  # iterations after which it is in any case; chosen
DOWN, UP = 2.0, 1.0  # longest steps of ln q from far away: a law's sinh ends where its exponential would overflow
LOWEST, HIGHEST = -1e3, 1e3  # of ln q
DEEP = 80.0  # range of ln(dalpha) below its largest value
HARDENING = 1e-9  # of G, least hardening in the tangent
AT_YIELD = 1.0 - 1e-9  # of the yield stress, from which a body may have flowed: one without hardening never exceeds it
ROOT3 = math.sqrt(3.0)


@njit(cache=True, forceinline=True)
def compliance(q, log_q, alpha, pressure, law, step):
    """Return V/q, its first and second derivative by ln q, and its derivative by the pressure."""
    inverse = entry(step, INVERSE_RESISTANCE)
    q, log_q, pressure = q * inverse, log_q - entry(step, LOG_RESISTANCE), pressure * inverse
    total = entry(step, COMPLIANCE)
    slope, curve, push = constant(total, 0.0), constant(total, 0.0), constant(total, 0.0)
    at, k, end = FIRST, FACTORS, whole(law, ACTIVE)
    # Term after term of the row, up to the last one whose strain depends on the stress alone.
    while at < end:
        value, first, second, by_pressure = fluidity_of(
            whole(law, at + FUNCTION), law, at + NUMBERS, q, log_q, pressure, alpha, entry(step, k + GAIN) * q
        )
        factor = entry(step, k)
        total, slope = total + factor * value, slope + factor * first
        curve, push = curve + factor * second, push + factor * by_pressure
        k += PER_TERM
        at += whole(law, at + SIZE)
    return total, slope, curve, push * inverse


@njit(cache=True, forceinline=True)
def borne(secant, order, push, step):
    """Return what a back stress makes of the `secant` q/rho, `order` and `push`: those of the part of s along R.

    That part is q/(1 + B c) + c rho. Without a back stress they are returned as they are, to the last digit.
    """
    split, stiffening = entry(step, SPLIT), entry(step, STIFFENING)
    both = split * secant + stiffening
    return both, order + (stiffening / both) * (1.0 - order), split * push


@njit(cache=True)
def threshold(alpha, pressure, law, step):
    """Return the q at which plastic flow goes on after a plastic strain `alpha`, and its derivatives by both."""
    at, inverse = whole(law, YIELD), entry(step, INVERSE_RESISTANCE)
    stress, hardening, by_pressure = strength_of(
        whole(law, at + FUNCTION), law, at + NUMBERS, alpha, pressure * inverse
    )
    factor = 1.0 / (ROOT3 * inverse)
    stress = where_less(entry(law, SHARE), constant(alpha, NO_SHARE), constant(alpha, 1e30), stress * factor)
    return stress, hardening * factor, by_pressure * (1.0 / ROOT3)


@njit(cache=True)
def solve_radial(rho, last, log_q, order, alpha, pressure, law, step):
    """Solve the radial equation for rho > 0, from the `last` rho, its ln q and d ln q / d ln rho.

    Parameters
    ----------
    alpha, pressure
        Hardening variable as the history fixes it, and pressure at the end of the step [GPa].
    law, step
        Rows, see `palpate.materials.flow.row`.

    Returns
    -------
    q, log_q, order, push
        The solution [GPa], its logarithm, d ln q / d ln rho, and dq/dp at constant rho; q is NaN where it is not found.
    """
    # Along the tangent at the last solution, with d ln rho = 2 (rho - last) / (rho + last); without one, as if elastic.
    further = log_q + order * 2.0 * (rho - last) / (rho + last)
    log_q = where_less(log_q, constant(rho, UNKNOWN), rough_log(rho) - rough_log(entry(step, COMPLIANCE)), further)
    q, order, push, change = rho, rho, rho, rho
    found, found_log, found_order, found_push = rho, rho, rho, rho
    lowest, highest = constant(rho, LOWEST), constant(rho, HIGHEST)
    zero, open = constant(rho, 0.0), constant(rho, 1.0)  # one in lanes that have not converged
    for iteration in range(ITERATIONS):
        q = exponential(log_q)
        total, slope, curve, by_pressure = compliance(q, log_q, alpha, pressure, law, step)
        # V = total q, so d ln V / d ln q = growth / total; bend is the same of growth.
        growth = total + slope
        bend = growth + slope + curve
        value = total * q
        both = value + rho
        inverse = 1.0 / (both * total * growth)
        # z = (V - rho) / (V + rho), times d ln q / d ln V: the change is ln(V / rho) = 2 (z + z^3 / 3) over that slope.
        excess = (value - rho) * inverse * total * growth
        order = both * inverse * total * total
        push = by_pressure / growth
        change = (2.0 + (2.0 / 3.0) * excess * excess) * excess * order
        # Halley's term, left out where it is not small against the change.
        bent = 0.5 * change * (both * inverse * total * bend - both * inverse * growth * growth)
        change = change + where_less(magnitude(bent), constant(bent, 0.05), change * bent, zero)
        order = order + 2.0 * bent * order
        # What is found is the stress after this change, with exp(-change) as its series; lanes found before stay.
        found = where_less(zero, open, q * (1.0 - change * (1.0 - change * (0.5 - change * (1.0 / 6.0)))), found)
        found_log = where_less(zero, open, log_q - change, found_log)
        found_order, found_push = where_less(zero, open, order, found_order), where_less(zero, open, push, found_push)
        open = where_less(constant(rho, TOLERANCE), magnitude(change), open, zero)
        if greatest(open) == 0.0:
            break
        # Some lane is far away: the whole logarithm, a step of limited length, and halving where it leaves its bracket.
        # The same where Newton's method goes to and fro about a kink, as where flow hardens at once.
        farthest = FAR if iteration < LATE else 0.0
        if greatest(where_less(zero, open, magnitude(excess), zero)) > farthest:
            away = where_less(constant(rho, farthest), magnitude(excess), open, zero)
            far = logarithm(value / rho) * both * inverse * total * total
            far = where_less(far, constant(far, DOWN), far, constant(far, DOWN))
            far = where_less(far, constant(far, -UP), constant(far, -UP), far)
            highest = where_less(zero, away, where_less(rho, value, log_q, highest), highest)
            lowest = where_less(zero, away, where_less(value, rho, log_q, lowest), lowest)
            middle = log_q - 0.5 * (lowest + highest)
            far = where_less(far, log_q - lowest, where_less(log_q - highest, far, far, middle), middle)
            change = where_less(zero, away, far, change)
        log_q = log_q - change
    found = where_less(zero, open, constant(rho, math.nan), found)
    q, log_q, order, push = found, found_log, found_order, zero - found_push * found
    # The stress without plastic flow is the answer unless it exceeds the yield stress in some lane.
    if whole(law, YIELD) > 0:
        least, _, _ = threshold(alpha, pressure, law, step)
        if greatest(q - least) > 0.0:
            q, log_q, order, push = flow(rho, (q, log_q, order, push), least, alpha, pressure, law, step)
    return q, log_q, order, push


@njit(cache=True)
def flow(rho, unyielding, least, alpha, pressure, law, step):
    """Return what `solve_radial` does, from its `unyielding` solution; plastic flow begins at `least` q."""
    q, log_q, order, push = unyielding
    nothing = constant(rho, 0.0)
    total, _, _, _ = compliance(least, logarithm(least), alpha, pressure, law, step)
    share = where_less(entry(law, SHARE), constant(rho, NO_SHARE), constant(rho, NO_SHARE), entry(law, SHARE))
    share = FLOWING * share
    floor = 1e-17 * rho
    # The slip is largest where all strain beyond the yield point is plastic without hardening; the search begins there.
    slip = where_less(least, q, rho - total * least, rho)
    slip = where_less(slip, floor, floor, slip) / share
    highest = logarithm(slip)
    deepest, log_slip = highest - DEEP, highest
    lowest = deepest
    new, growth, by_pressure, hardening, by_strength = rho, rho, rho, rho, rho
    open = where_less(least, q, constant(rho, 1.0), nothing)  # one in lanes that flow and have not converged
    for iteration in range(ITERATIONS):
        slip = exponential(log_slip)
        stress, harder, by_stress = threshold(alpha + slip, pressure, law, step)
        total, slope, _, by_push = compliance(stress, logarithm(stress), alpha, pressure, law, step)
        excess = total * stress + share * slip - rho
        # Newton's method for V(q) + (sqrt(3)/2) dalpha = rho at q = sigma(alpha + dalpha) / sqrt(3), by dalpha.
        change = excess / ((total + slope) * harder + share)
        closing = where_less(magnitude(excess) / rho, constant(rho, SQUARED), harder * change, nothing)
        new, growth = where_less(nothing, open, stress - closing, new), where_less(nothing, open, total + slope, growth)
        hardening, by_pressure = (
            where_less(nothing, open, harder, hardening),
            where_less(nothing, open, by_push, by_pressure),
        )
        by_strength = where_less(nothing, open, by_stress, by_strength)
        open = where_less(constant(rho, SQUARED), magnitude(excess) / rho, open, nothing)
        if greatest(open) == 0.0:
            break
        highest = where_less(nothing, excess, log_slip, highest)
        lowest = where_less(nothing, excess, lowest, log_slip)
        log_slip = log_slip - change / slip
        middle = 0.5 * (lowest + highest)
        log_slip = where_less(log_slip, lowest, middle, where_less(highest, log_slip, middle, log_slip))
        if HALVING[0] <= iteration < HALVING[1]:
            log_slip = middle
    none = where_less(deepest, lowest, nothing, open)  # one in lanes whose slip is below all that counts
    least, open = where_less(nothing, none, q, least), where_less(nothing, none, nothing, open)
    # What lanes that flow have in place of the derivatives without flow; the others keep theirs.
    limit = (HARDENING / ROOT3) * entry(law, SHEAR)
    hardening = where_less(hardening, limit, limit, hardening)
    slope = growth * hardening + share
    order = where_less(least, q, rho * hardening / (new * slope), order)
    push = where_less(least, q, (share * by_strength - by_pressure * new * hardening) / slope, push)
    log_q = where_less(least, q, logarithm(where_less(least, q, new, rho)), log_q)
    stress = where_less(nothing, open, constant(rho, math.nan), where_less(least, q, new, q))
    return stress, log_q, order, push
