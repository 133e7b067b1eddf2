"""Derivatives of the radial flow at one Gauss point by parameters, from the start of a step to its end.

Differentiating the radial equation q phi(q) = rho of `palpate.fem.scalar_radial` at fixed time gives

    dq = (dq/drho) (R:dR/(2 rho) - d(q phi)|_q),      ds = (q/rho) dR + R d(q/rho),

where d(q phi)|_q comes from the coefficients alone. In turn, at the Gauss point g of element e: what the history fixes
(`freeze`), the stress while the strain stays (`hold`), and the state that follows once the strain's derivative is known
(`move`). The last axis of `change` (m, 4, s, p), the derivative of the state, runs over the parameters; what begins
with d_ is the derivative of what it names.

Source: direct differentiation of history-dependent problems after Michaleris, Tortorelli & Vidal, Int. J. Numer. Meth.
Engng 37 (1994) 2471-2499, section 3.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem.scalar_radial import (
    ALPHA,
    HARDENING,
    PERMANENT,
    SHEAR,
    STEADY_EXPONENT,
    TRANSIENT,
    VOIGT,
    YIELD,
    invariant,
)

ROOT3 = math.sqrt(3.0)
LOG, POWER = range(2)


def powers_size(coefficients: np.ndarray) -> int:
    """Return how many numbers `powers_of` writes for one point."""
    return POWER + 1 + (len(coefficients) - VOIGT) // 3


@njit(cache=True, error_model="numpy")
def powers_of(e, g, q, row, weights, powers):
    """Write log q and q^(2 m) of the steady creep and of each Voigt element to `powers` (m, 4, elements + 2)."""
    log_q = math.log(q) if q > 0.0 else -700.0
    powers[e, g, LOG] = log_q
    powers[e, g, POWER] = math.exp(2.0 * row[STEADY_EXPONENT] * log_q)
    for k in range(powers.shape[2] - POWER - 1):
        powers[e, g, POWER + 1 + k] = math.exp(2.0 * weights[4 + 4 * k] * log_q)


@njit(cache=True, error_model="numpy", inline="always")
def rate_change(power, coefficient, d_coefficient, exponent, d_exponent, log_q, relative):
    """Return d(C q^(2 m)) for changes of C and m, and the `relative` change dq/q."""
    return power * (d_coefficient + 2.0 * coefficient * (log_q * d_exponent + exponent * relative))


@njit(cache=True, error_model="numpy")
def freeze(e, g, state, change, row, d_row, weights, d_weights, powers):
    """Turn the derivative (s, p) of a point's state into that of what its history fixes in the next step, in place.

    Afterwards its permanent and transient strains sum to the derivative of `palpate.fem.scalar_radial.history`.
    """
    s0, s1, s2, s3 = state[e, g, 0], state[e, g, 1], state[e, g, 2], state[e, g, 3]
    q = invariant(s0, s1, s2, s3)
    log_q = powers[e, g, LOG]
    scale = 0.5 / (q * q) if q > 0.0 else 0.0
    steady = weights[0] * powers[e, g, POWER]
    exponent = row[STEADY_EXPONENT]
    for j in range(change.shape[3]):
        c0, c1, c2, c3 = change[e, g, 0, j], change[e, g, 1, j], change[e, g, 2, j], change[e, g, 3, j]
        relative = scale * (s0 * c0 + s1 * c1 + s2 * c2 + 2.0 * s3 * c3)
        rate = rate_change(
            powers[e, g, POWER], weights[0], d_weights[0, j], exponent, d_row[STEADY_EXPONENT, j], log_q, relative
        )
        change[e, g, PERMANENT, j] += rate * s0 + steady * c0
        change[e, g, PERMANENT + 1, j] += rate * s1 + steady * c1
        change[e, g, PERMANENT + 2, j] += rate * s2 + steady * c2
        change[e, g, PERMANENT + 3, j] += rate * s3 + steady * c3
        for k in range(powers.shape[2] - POWER - 1):
            a, b, m, t = 1 + 4 * k, 2 + 4 * k, 4 + 4 * k, TRANSIENT + 4 * k
            rate = rate_change(
                powers[e, g, POWER + 1 + k], weights[b], d_weights[b, j], weights[m], d_weights[m, j], log_q, relative
            )
            driven, kept, d_kept = weights[b] * powers[e, g, POWER + 1 + k], weights[a], d_weights[a, j]
            change[e, g, t, j] = d_kept * state[e, g, t] + kept * change[e, g, t, j] + rate * s0 + driven * c0
            change[e, g, t + 1, j] = (
                d_kept * state[e, g, t + 1] + kept * change[e, g, t + 1, j] + rate * s1 + driven * c1
            )
            change[e, g, t + 2, j] = (
                d_kept * state[e, g, t + 2] + kept * change[e, g, t + 2, j] + rate * s2 + driven * c2
            )
            change[e, g, t + 3, j] = (
                d_kept * state[e, g, t + 3] + kept * change[e, g, t + 3, j] + rate * s3 + driven * c3
            )


@njit(cache=True, error_model="numpy")
def flow_of(q, alpha, row):
    """Return whether the step yields, the plastic increment of alpha, and the hardening that holds."""
    hardening = max(row[HARDENING], 1e-9 * row[SHEAR])
    threshold = row[YIELD] + row[HARDENING] * alpha
    yields = ROOT3 * q > threshold
    return yields, (ROOT3 * q - threshold) / hardening if yields else 0.0, hardening


@njit(cache=True, error_model="numpy")
def radial_slope(e, g, yields, hardening, row, weights, powers):
    """Return dq/drho."""
    slope = 0.5 / row[SHEAR] + (2.0 * row[STEADY_EXPONENT] + 1.0) * weights[0] * powers[e, g, POWER]
    for k in range(powers.shape[2] - POWER - 1):
        slope += (2.0 * weights[4 + 4 * k] + 1.0) * weights[3 + 4 * k] * powers[e, g, POWER + 1 + k]
    return 1.0 / (slope + 1.5 / hardening) if yields else 1.0 / slope


@njit(cache=True, error_model="numpy", inline="always")
def increment_change(j, alpha, d_alpha, increment, hardening, row, d_row):
    """Return the change of the plastic increment of alpha at fixed q."""
    floor = d_row[HARDENING, j] if hardening == row[HARDENING] else 1e-9 * d_row[SHEAR, j]
    moved = d_row[YIELD, j] + d_row[HARDENING, j] * alpha + row[HARDENING] * d_alpha + increment * floor
    return -moved / hardening


@njit(cache=True, error_model="numpy")
def hold(e, g, change, local, solution, alphas, row, d_row, weights, d_weights, powers):
    """Write to the stress in `change`, after `freeze`, its derivative at fixed strain."""
    q, alpha, log_q = solution[e, g], alphas[e, g], powers[e, g, LOG]
    r0, r1, r2, r3 = local[e, g, 0], local[e, g, 1], local[e, g, 2], local[e, g, 3]
    yields, increment, hardening = flow_of(q, alpha, row)
    slope = radial_slope(e, g, yields, hardening, row, weights, powers)
    rho = invariant(r0, r1, r2, r3)
    ratio = q / rho if rho > 0.0 else slope
    inverse = 1.0 / rho if rho > 0.0 else 0.0
    softer = 0.5 / (row[SHEAR] * row[SHEAR])
    for j in range(change.shape[3]):
        fixed = -softer * d_row[SHEAR, j] + rate_change(
            powers[e, g, POWER],
            weights[0],
            d_weights[0, j],
            row[STEADY_EXPONENT],
            d_row[STEADY_EXPONENT, j],
            log_q,
            0.0,
        )
        d0, d1 = -change[e, g, PERMANENT, j], -change[e, g, PERMANENT + 1, j]
        d2, d3 = -change[e, g, PERMANENT + 2, j], -change[e, g, PERMANENT + 3, j]
        for k in range(powers.shape[2] - POWER - 1):
            c, m, t = 3 + 4 * k, 4 + 4 * k, TRANSIENT + 4 * k
            fixed += rate_change(
                powers[e, g, POWER + 1 + k], weights[c], d_weights[c, j], weights[m], d_weights[m, j], log_q, 0.0
            )
            d0, d1, d2, d3 = (
                d0 - change[e, g, t, j],
                d1 - change[e, g, t + 1, j],
                d2 - change[e, g, t + 2, j],
                d3 - change[e, g, t + 3, j],
            )
        fixed *= q
        if yields:
            fixed += 0.5 * ROOT3 * increment_change(j, alpha, change[e, g, ALPHA, j], increment, hardening, row, d_row)
        d_rho = 0.5 * inverse * (r0 * d0 + r1 * d1 + r2 * d2 + 2.0 * r3 * d3)
        turn = (slope * (d_rho - fixed) - ratio * d_rho) * inverse
        change[e, g, 0, j] = ratio * d0 + turn * r0
        change[e, g, 1, j] = ratio * d1 + turn * r1
        change[e, g, 2, j] = ratio * d2 + turn * r2
        change[e, g, 3, j] = ratio * d3 + turn * r3


@njit(cache=True, error_model="numpy")
def move(e, g, change, d_strain, local, solution, alphas, row, d_row, weights, d_weights, powers):
    """Turn `change`, after `hold`, into the derivative of the state that follows from those of strain (4, p) too."""
    q, alpha, log_q = solution[e, g], alphas[e, g], powers[e, g, LOG]
    r0, r1, r2, r3 = local[e, g, 0], local[e, g, 1], local[e, g, 2], local[e, g, 3]
    yields, increment, hardening = flow_of(q, alpha, row)
    slope = radial_slope(e, g, yields, hardening, row, weights, powers)
    rho = invariant(r0, r1, r2, r3)
    ratio = q / rho if rho > 0.0 else slope
    rank_one = 0.5 * (slope - ratio) / (rho * rho) if rho > 0.0 else 0.0
    s0, s1, s2, s3 = ratio * r0, ratio * r1, ratio * r2, ratio * r3
    inverse = 1.0 / q if q > 0.0 else 0.0
    scale = 0.5 * inverse * inverse
    permanent = weights[0] * powers[e, g, POWER] + 0.5 * ROOT3 * increment * inverse
    for j in range(change.shape[3]):
        d0, d1, d2, d3 = d_strain[0, j], d_strain[1, j], d_strain[2, j], d_strain[3, j]
        mean = (d0 + d1 + d2) / 3.0
        d0, d1, d2 = d0 - mean, d1 - mean, d2 - mean
        turn = rank_one * (r0 * d0 + r1 * d1 + r2 * d2 + 2.0 * r3 * d3)
        c0 = change[e, g, 0, j] + ratio * d0 + turn * r0
        c1 = change[e, g, 1, j] + ratio * d1 + turn * r1
        c2 = change[e, g, 2, j] + ratio * d2 + turn * r2
        c3 = change[e, g, 3, j] + ratio * d3 + turn * r3
        change[e, g, 0, j], change[e, g, 1, j], change[e, g, 2, j], change[e, g, 3, j] = c0, c1, c2, c3
        relative = scale * (s0 * c0 + s1 * c1 + s2 * c2 + 2.0 * s3 * c3)
        rate = rate_change(
            powers[e, g, POWER],
            weights[0],
            d_weights[0, j],
            row[STEADY_EXPONENT],
            d_row[STEADY_EXPONENT, j],
            log_q,
            relative,
        )
        if yields:
            d_increment = increment_change(j, alpha, change[e, g, ALPHA, j], increment, hardening, row, d_row)
            d_increment += ROOT3 * q * relative / hardening
            rate += 0.5 * ROOT3 * inverse * (d_increment - increment * relative)
            change[e, g, ALPHA, j] += d_increment
        change[e, g, PERMANENT, j] += rate * s0 + permanent * c0
        change[e, g, PERMANENT + 1, j] += rate * s1 + permanent * c1
        change[e, g, PERMANENT + 2, j] += rate * s2 + permanent * c2
        change[e, g, PERMANENT + 3, j] += rate * s3 + permanent * c3
        for k in range(powers.shape[2] - POWER - 1):
            c, m, t = 3 + 4 * k, 4 + 4 * k, TRANSIENT + 4 * k
            rate = rate_change(
                powers[e, g, POWER + 1 + k], weights[c], d_weights[c, j], weights[m], d_weights[m, j], log_q, relative
            )
            driven = weights[c] * powers[e, g, POWER + 1 + k]
            change[e, g, t, j] += rate * s0 + driven * c0
            change[e, g, t + 1, j] += rate * s1 + driven * c1
            change[e, g, t + 2, j] += rate * s2 + driven * c2
            change[e, g, t + 3, j] += rate * s3 + driven * c3
