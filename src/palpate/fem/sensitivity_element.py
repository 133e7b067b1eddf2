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
    STRESS,
    TRANSIENT,
    YIELD,
    invariant,
)

ROOT3 = math.sqrt(3.0)
_linear_element = linear.element
_hencky_element = hencky.element
_strain_at = hencky.strain_at


@njit(cache=True)
def strain_matrices(gradients, volumes, u, large, b, mean):
    """Write dE/du at the Gauss points in the fixed axes, `b` (4, 4, 8), and of the mean tr E, `mean` (8,).

    Returns
    -------
    float
        Mean tr E of the element.
    """
    volume = volumes[0] + volumes[1] + volumes[2] + volumes[3]
    mean[:] = 0.0
    theta = 0.0
    if large:
        strain, frame = np.empty(3), np.empty(7)
    for g in range(4):
        share = volumes[g] / volume
        if large:
            _strain_at(gradients[g], u, strain, b[g], frame)
            theta += share * (strain[0] + strain[1] + strain[2])
            c, s = frame[COS], frame[SIN]
            for i in range(8):
                b0, b1, b3 = b[g, 0, i], b[g, 1, i], b[g, 3, i]
                b[g, 0, i] = b0 * c * c + b1 * s * s - 2.0 * b3 * s * c
                b[g, 1, i] = b0 * s * s + b1 * c * c + 2.0 * b3 * s * c
                b[g, 3, i] = (b0 - b1) * s * c + b3 * (c * c - s * s)
        else:
            b[g] = 0.0
            for a in range(4):
                nr, nz, nt = gradients[g, 0, a], gradients[g, 1, a], gradients[g, 2, a]
                b[g, 0, 2 * a], b[g, 1, 2 * a + 1], b[g, 2, 2 * a] = nr, nz, nt
                b[g, 3, 2 * a], b[g, 3, 2 * a + 1] = 0.5 * nz, 0.5 * nr
        for i in range(8):
            mean[i] += share * (b[g, 0, i] + b[g, 1, i] + b[g, 2, i])
    if not large:
        for i in range(8):
            theta += mean[i] * u[i]
    return theta


@njit(cache=True)
def powers_of(q, row, weights, powers):
    """Write q^(2 m) of the steady creep and of each Voigt element to `powers`; return log q."""
    log_q = math.log(q) if q > 0.0 else -700.0
    powers[0] = math.exp(2.0 * row[STEADY_EXPONENT] * log_q)
    for k in range(powers.shape[0] - 1):
        powers[1 + k] = math.exp(2.0 * weights[4 + 4 * k] * log_q)
    return log_q


@njit(cache=True, inline="always")
def rate_change(power, coefficient, d_coefficient, exponent, d_exponent, log_q, relative):
    """Return d(C q^(2 m)) for changes of C and m, and the `relative` change dq/q."""
    return power * (d_coefficient + 2.0 * coefficient * (log_q * d_exponent + exponent * relative))


@njit(cache=True)
def freeze(state, change, row, d_row, weights, d_weights, powers):
    """Turn the derivative (s, p) of a point's state into that of what its history fixes in the next step, in place.

    Afterwards its permanent and transient strains sum to the derivative of `palpate.materials.radial.history`.
    """
    q = invariant(state[0], state[1], state[2], state[3])
    log_q = powers_of(q, row, weights, powers)
    scale = 0.5 / (q * q) if q > 0.0 else 0.0
    steady = weights[0] * powers[0]
    for j in range(change.shape[1]):
        c0, c1, c2, c3 = change[0, j], change[1, j], change[2, j], change[3, j]
        relative = scale * (state[0] * c0 + state[1] * c1 + state[2] * c2 + 2.0 * state[3] * c3)
        rate = rate_change(
            powers[0], weights[0], d_weights[0, j], row[STEADY_EXPONENT], d_row[STEADY_EXPONENT, j], log_q, relative
        )
        change[PERMANENT, j] += rate * state[0] + steady * c0
        change[PERMANENT + 1, j] += rate * state[1] + steady * c1
        change[PERMANENT + 2, j] += rate * state[2] + steady * c2
        change[PERMANENT + 3, j] += rate * state[3] + steady * c3
        for k in range(powers.shape[0] - 1):
            a, b, m, t = 1 + 4 * k, 2 + 4 * k, 4 + 4 * k, TRANSIENT + 4 * k
            rate = rate_change(
                powers[1 + k], weights[b], d_weights[b, j], weights[m], d_weights[m, j], log_q, relative
            )
            driven = weights[b] * powers[1 + k]
            for i in range(4):
                kept = d_weights[a, j] * state[t + i] + weights[a] * change[t + i, j]
                change[t + i, j] = kept + rate * state[i] + driven * change[i, j]


@njit(cache=True)
def flow_of(q, alpha, row):
    """Return whether the step yields, the plastic increment of alpha, and the hardening that holds."""
    hardening = max(row[HARDENING], 1e-9 * row[SHEAR])
    threshold = row[YIELD] + row[HARDENING] * alpha
    yields = ROOT3 * q > threshold
    return yields, (ROOT3 * q - threshold) / hardening if yields else 0.0, hardening


@njit(cache=True)
def radial_slope(yields, hardening, row, weights, powers):
    """Return dq/drho."""
    slope = 0.5 / row[SHEAR] + (2.0 * row[STEADY_EXPONENT] + 1.0) * weights[0] * powers[0]
    for k in range(powers.shape[0] - 1):
        slope += (2.0 * weights[4 + 4 * k] + 1.0) * weights[3 + 4 * k] * powers[1 + k]
    return 1.0 / (slope + 1.5 / hardening) if yields else 1.0 / slope


@njit(cache=True, inline="always")
def increment_change(j, alpha, d_alpha, increment, hardening, row, d_row):
    """Return the change of the plastic increment of alpha at fixed q."""
    floor = d_row[HARDENING, j] if hardening == row[HARDENING] else 1e-9 * d_row[SHEAR, j]
    moved = d_row[YIELD, j] + d_row[HARDENING, j] * alpha + row[HARDENING] * d_alpha + increment * floor
    return -moved / hardening


@njit(cache=True)
def stress_change(change, q, log_q, r, rho, alpha, slope, yields, increment, hardening, row, d_row, weights, d_weights, powers,
                  d_local, d_q, d_stress):  # fmt: skip
    """Write dq (p,) and ds (4, p) for the changes `d_local` (4, p) of R; `change` is the derivative of the state."""
    ratio = q / rho if rho > 0.0 else slope
    inverse = 1.0 / rho if rho > 0.0 else 0.0
    for j in range(d_q.shape[0]):
        fixed = -0.5 * d_row[SHEAR, j] / (row[SHEAR] * row[SHEAR])
        fixed += rate_change(
            powers[0], weights[0], d_weights[0, j], row[STEADY_EXPONENT], d_row[STEADY_EXPONENT, j], log_q, 0.0
        )
        for k in range(powers.shape[0] - 1):
            c, m = 3 + 4 * k, 4 + 4 * k
            fixed += rate_change(powers[1 + k], weights[c], d_weights[c, j], weights[m], d_weights[m, j], log_q, 0.0)
        fixed *= q
        if yields:
            fixed += 0.5 * ROOT3 * increment_change(j, alpha, change[ALPHA, j], increment, hardening, row, d_row)
        d0, d1, d2, d3 = d_local[0, j], d_local[1, j], d_local[2, j], d_local[3, j]
        d_rho = 0.5 * inverse * (r[0] * d0 + r[1] * d1 + r[2] * d2 + 2.0 * r[3] * d3)
        d_q[j] = slope * (d_rho - fixed)
        turn = (d_q[j] - ratio * d_rho) * inverse
        d_stress[0, j] = ratio * d0 + turn * r[0]
        d_stress[1, j] = ratio * d1 + turn * r[1]
        d_stress[2, j] = ratio * d2 + turn * r[2]
        d_stress[3, j] = ratio * d3 + turn * r[3]


@njit(cache=True)
def frozen_strain(change, d_local):
    """Write minus the derivative of what the history fixes, after `freeze`, to `d_local` (4, p)."""
    for i in range(4):
        for j in range(change.shape[1]):
            d_local[i, j] = -change[PERMANENT + i, j]
        for t in range(TRANSIENT + i, change.shape[0], 4):
            for j in range(change.shape[1]):
                d_local[i, j] -= change[t, j]


@njit(cache=True)
def carry(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    state, local, solution, change, d_force,
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
    state, local, solution : ndarray, shapes (m, 4, s), (m, 4, 4) and (m, 4)
        State at the start of the step; R and q at its end.
    change : ndarray, shape (m, 4, s, p)
        Derivative of `state`; afterwards, of what it fixes in the step.
    d_force : ndarray, shape (n, 2, p)
        Receives the derivative of the internal forces.
    """
    count = change.shape[3]
    b, mean, u = np.empty((4, 4, 8)), np.empty(8), np.empty(8)
    d_local, d_q, d_stress, fe = np.empty((4, count)), np.empty(count), np.empty((4, count)), np.empty((8, count))
    powers = np.empty(1 + (weights.shape[1] - 1) // 4)
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
        theta = strain_matrices(gradients[e], volumes[e], u, large, b, mean)
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        pressed = volumes[e].sum() * theta
        for a in range(8):
            for j in range(count):
                fe[a, j] = pressed * mean[a] * d_row[BULK, j]
        for g in range(4):
            freeze(state[e, g], change[e, g], row, d_row, step, d_step, powers)
            frozen_strain(change[e, g], d_local)
            r, q, alpha = local[e, g], solution[e, g], state[e, g, ALPHA]
            rho = invariant(r[0], r[1], r[2], r[3])
            log_q = powers_of(q, row, step, powers)
            yields, increment, hardening = flow_of(q, alpha, row)
            slope = radial_slope(yields, hardening, row, step, powers)
            stress_change(
                change[e, g], q, log_q, r, rho, alpha, slope, yields, increment, hardening, row, d_row, step, d_step, powers,
                d_local, d_q, d_stress,
            )  # fmt: skip
            volume = volumes[e, g]
            for a in range(8):
                b0, b1, b2, b3 = b[g, 0, a], b[g, 1, a], b[g, 2, a], 2.0 * b[g, 3, a]
                for j in range(count):
                    work = b0 * d_stress[0, j] + b1 * d_stress[1, j] + b2 * d_stress[2, j] + b3 * d_stress[3, j]
                    fe[a, j] += volume * work
        for a in range(8):
            for j in range(count):
                d_force[elements[e, a // 2], a % 2, j] += fe[a, j]


@njit(cache=True)
def settle(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    alphas, local, solution, d_displacement, change,
):  # fmt: skip
    """Turn `change`, as `carry` left it, into the derivative of the state at the end of the step.

    Parameters
    ----------
    alphas : ndarray, shape (m, 4)
        Accumulated plastic strain at the start of the step.
    d_displacement : ndarray, shape (n, 2, p)
        Derivative of the displacements at the end of the step.
    """
    count = change.shape[3]
    b, mean, u = np.empty((4, 4, 8)), np.empty(8), np.empty(8)
    d_local, d_q, d_stress, d_u = np.empty((4, count)), np.empty(count), np.empty((4, count)), np.empty((8, count))
    powers = np.empty(1 + (weights.shape[1] - 1) // 4)
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
            d_u[a] = d_displacement[elements[e, a // 2], a % 2]
        strain_matrices(gradients[e], volumes[e], u, large, b, mean)
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        for g in range(4):
            frozen_strain(change[e, g], d_local)
            for a in range(8):
                b0, b1, b2, b3 = b[g, 0, a], b[g, 1, a], b[g, 2, a], b[g, 3, a]
                third = (b0 + b1 + b2) / 3.0
                for j in range(count):
                    d_local[0, j] += (b0 - third) * d_u[a, j]
                    d_local[1, j] += (b1 - third) * d_u[a, j]
                    d_local[2, j] += (b2 - third) * d_u[a, j]
                    d_local[3, j] += b3 * d_u[a, j]
            r, q, alpha = local[e, g], solution[e, g], alphas[e, g]
            rho = invariant(r[0], r[1], r[2], r[3])
            log_q = powers_of(q, row, step, powers)
            yields, increment, hardening = flow_of(q, alpha, row)
            slope = radial_slope(yields, hardening, row, step, powers)
            stress_change(
                change[e, g], q, log_q, r, rho, alpha, slope, yields, increment, hardening, row, d_row, step, d_step, powers,
                d_local, d_q, d_stress,
            )  # fmt: skip
            ratio = q / rho if rho > 0.0 else 0.0
            _finish(
                change[e, g], r, ratio, q, log_q, alpha, yields, increment, hardening, row, d_row, step, d_step, powers,
                d_q, d_stress,
            )  # fmt: skip


@njit(cache=True)
def _finish(change, r, ratio, q, log_q, alpha, yields, increment, hardening, row, d_row, weights, d_weights, powers, d_q,
            d_stress):  # fmt: skip
    """Add what the step itself contributes to the derivative of a point's state, in place."""
    inverse = 1.0 / q if q > 0.0 else 0.0
    permanent = weights[0] * powers[0] + 0.5 * ROOT3 * increment * inverse
    for j in range(d_q.shape[0]):
        relative = d_q[j] * inverse
        rate = rate_change(
            powers[0], weights[0], d_weights[0, j], row[STEADY_EXPONENT], d_row[STEADY_EXPONENT, j], log_q, relative
        )
        if yields:
            d_increment = increment_change(j, alpha, change[ALPHA, j], increment, hardening, row, d_row)
            d_increment += ROOT3 * d_q[j] / hardening
            rate += 0.5 * ROOT3 * inverse * (d_increment - increment * relative)
            change[ALPHA, j] += d_increment
        for i in range(4):
            stress = ratio * r[i]
            change[PERMANENT + i, j] += rate * stress + permanent * d_stress[i, j]
            change[STRESS + i, j] = d_stress[i, j]
        for k in range(powers.shape[0] - 1):
            c, m, t = 3 + 4 * k, 4 + 4 * k, TRANSIENT + 4 * k
            rate = rate_change(
                powers[1 + k], weights[c], d_weights[c, j], weights[m], d_weights[m, j], log_q, relative
            )
            driven = weights[c] * powers[1 + k]
            for i in range(4):
                change[t + i, j] += rate * ratio * r[i] + driven * d_stress[i, j]


@njit(cache=True)
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
