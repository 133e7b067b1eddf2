"""Derivatives of every element's force and history by parameters, at the end of a converged step.

Differentiating the radial equation q phi(q) = rho of `palpate.materials.radial` at fixed time gives

    dq = (dq/drho) (R:dR/(2 rho) - d(q phi)|_q),      ds = (q/rho) dR + R d(q/rho),

where d(q phi)|_q comes from the coefficients alone. With the displacements held, R changes only by the strain that the
history fixes, which gives the right-hand sides (`carry`); with their derivatives known, dR does, which gives the
derivative of the history for the next step (`settle`). The last axis of every derivative runs over the parameters.

Source: direct differentiation of history-dependent problems after Michaleris, Tortorelli & Vidal, Int. J. Numer. Meth.
Engng 37 (1994) 2471-2499, section 3.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem import hencky, linear
from palpate.fem.hencky import COS, SIN
from palpate.materials.radial import (
    ALPHA,
    BULK,
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
_linear_element = linear.element
_hencky_element = hencky.element
_strain_at = hencky.strain_at


def powers_size(coefficients: np.ndarray) -> int:
    """Return how many numbers `powers_of` writes for one point."""
    return POWER + 1 + (len(coefficients) - VOIGT) // 3


@njit(cache=True, error_model="numpy")
def strain_matrices(e, gradients, u, large, b, trace):
    """Write dE/du at the Gauss points of an element in the fixed axes to `b` (4, 4, 8), and tr E to `trace` (4,).

    At small strains the zeros of `b` stay as they are.
    """
    if large:
        strain, frame = np.empty(3), np.empty(7)
    for g in range(4):
        if large:
            _strain_at(gradients[e, g], u, strain, b[g], frame)
            trace[g] = strain[0] + strain[1] + strain[2]
            c, s = frame[COS], frame[SIN]
            for i in range(8):
                b0, b1, b3 = b[g, 0, i], b[g, 1, i], b[g, 3, i]
                b[g, 0, i] = b0 * c * c + b1 * s * s - 2.0 * b3 * s * c
                b[g, 1, i] = b0 * s * s + b1 * c * c + 2.0 * b3 * s * c
                b[g, 3, i] = (b0 - b1) * s * c + b3 * (c * c - s * s)
        else:
            trace[g] = 0.0
            for a in range(4):
                nr, nz, nt = gradients[e, g, 0, a], gradients[e, g, 1, a], gradients[e, g, 2, a]
                b[g, 0, 2 * a], b[g, 1, 2 * a + 1], b[g, 2, 2 * a] = nr, nz, nt
                b[g, 3, 2 * a], b[g, 3, 2 * a + 1] = 0.5 * nz, 0.5 * nr
                trace[g] += (nr + nt) * u[2 * a] + nz * u[2 * a + 1]


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

    Afterwards its permanent and transient strains sum to the derivative of `palpate.materials.radial.history`.
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


@njit(cache=True, error_model="numpy")
def carry(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    state, alphas, local, solution, powers, change, d_force,
):  # fmt: skip
    """Carry the derivative of the history into the step and add that of the nodal forces at fixed displacements.

    Parameters
    ----------
    elements, gradients, volumes
        See `palpate.fem.mesh.Mesh`.
    large : bool
    displacement : ndarray, shape (n, 2)
        At the end of the step.
    region, coefficients, weights
        Laws and what the step makes of them, see `palpate.fem.element.assemble`.
    d_coefficients, d_weights : ndarray, shapes (regions, c, p) and (regions, w, p)
    state, alphas, local, solution : ndarray, shapes (m, 4, s), (m, 4), (m, 4, 4) and (m, 4)
        State and its accumulated plastic strain at the start of the step; R and q at its end.
    powers : ndarray, shape (m, 4, elements + 2)
        log q and all q^(2 m) at the start of the step; afterwards, at its end.
    change : ndarray, shape (m, 4, s, p)
        Derivative of `state`; afterwards, of what it fixes in the step.
    d_force : ndarray, shape (n, 2, p)
        Receives the derivative of the internal forces.
    """
    count = change.shape[3]
    b, trace, u, fe = np.zeros((4, 4, 8)), np.empty(4), np.empty(8), np.empty((8, count))
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
        strain_matrices(e, gradients, u, large, b, trace)
        volume, dilatation = 0.0, 0.0
        for g in range(4):
            volume += volumes[e, g]
            dilatation += volumes[e, g] * trace[g]
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        for a in range(8):
            swelling = 0.0
            for g in range(4):
                swelling += volumes[e, g] * (b[g, 0, a] + b[g, 1, a] + b[g, 2, a])
            for j in range(count):
                fe[a, j] = dilatation / volume * swelling * d_row[BULK, j]
        for g in range(4):
            freeze(e, g, state, change, row, d_row, step, d_step, powers)
            powers_of(e, g, solution[e, g], row, step, powers)
            hold(e, g, change, local, solution, alphas, row, d_row, step, d_step, powers)
            for j in range(count):
                weight = volumes[e, g]
                s0, s1 = weight * change[e, g, 0, j], weight * change[e, g, 1, j]
                s2, s3 = weight * change[e, g, 2, j], 2.0 * weight * change[e, g, 3, j]
                for a in range(8):
                    fe[a, j] += b[g, 0, a] * s0 + b[g, 1, a] * s1 + b[g, 2, a] * s2 + b[g, 3, a] * s3
        for a in range(8):
            for j in range(count):
                d_force[elements[e, a // 2], a % 2, j] += fe[a, j]


@njit(cache=True, error_model="numpy")
def settle(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    alphas, local, solution, powers, d_displacement, change,
):  # fmt: skip
    """Turn `change`, as `carry` left it, into the derivative of the state at the end of the step.

    Parameters
    ----------
    d_displacement : ndarray, shape (n, 2, p)
        Derivative of the displacements at the end of the step.
    """
    count = change.shape[3]
    b, trace, u = np.zeros((4, 4, 8)), np.empty(4), np.empty(8)
    d_u, d_strain = np.empty((8, count)), np.empty((4, count))
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
            for j in range(count):
                d_u[a, j] = d_displacement[elements[e, a // 2], a % 2, j]
        strain_matrices(e, gradients, u, large, b, trace)
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        for g in range(4):
            for j in range(count):
                d0, d1, d2, d3 = 0.0, 0.0, 0.0, 0.0
                for a in range(8):
                    d0 += b[g, 0, a] * d_u[a, j]
                    d1 += b[g, 1, a] * d_u[a, j]
                    d2 += b[g, 2, a] * d_u[a, j]
                    d3 += b[g, 3, a] * d_u[a, j]
                d_strain[0, j], d_strain[1, j], d_strain[2, j], d_strain[3, j] = d0, d1, d2, d3
            move(e, g, change, d_strain, local, solution, alphas, row, d_row, step, d_step, powers)


@njit(cache=True, error_model="numpy")
def push(
    elements, gradients, volumes, large, displacement, region, coefficients, weights, past, alpha, deviatoric,
    dilatation, guesses, pushed, lift, d_force,
):  # fmt: skip
    """Add the change (n, 2, p) of the internal forces where the nodes `pushed` (n,) move along z by `lift` (n, p)."""
    ke, fe, u, local, q = np.zeros((9, 9)), np.zeros(9), np.empty(8), np.empty((4, 4)), np.empty(4)
    for e in range(elements.shape[0]):
        corners = elements[e]
        if not (pushed[corners[0]] or pushed[corners[1]] or pushed[corners[2]] or pushed[corners[3]]):
            continue
        for a in range(8):
            u[a] = displacement[corners[a // 2], a % 2]
        q[:] = guesses[e]
        row, step = coefficients[region[e]], weights[region[e]]
        if large:
            _hencky_element(gradients[e], volumes[e], u, past[e], alpha[e], q, step, row, local, ke, fe)
        else:
            _linear_element(
                gradients[e], volumes[e], deviatoric[e], dilatation[e], u, past[e], alpha[e], q, step, row, local,
                ke, fe,
            )  # fmt: skip
        for c in range(4):
            if pushed[corners[c]]:
                for a in range(8):
                    for j in range(lift.shape[1]):
                        d_force[corners[a // 2], a % 2, j] += ke[a, 2 * c + 1] * lift[corners[c], j]
