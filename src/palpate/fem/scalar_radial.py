"""Radial flow: the one scalar equation behind every law of the project.

Every inelastic rate here is parallel to the deviatoric stress s, so the implicit update needs one unknown,
q = sqrt(s:s/2). With the deviatoric strain e split into elastic, steady, transient and plastic parts,

    e = s/(2G) + e_s + sum_k e_t,k + e_p,

the end of a step obeys  q * phi(q) = rho,  rho = sqrt(R:R/2),  s = (q/rho) R,  where R is e less all that the
history fixes, and

    q phi(q) = q/(2G) + (dt/2) C_s q^(2 m_s + 1) + sum_k c_k C_t,k q^(2 m_t,k + 1) + (sqrt(3)/2) * dalpha(q).

The steady rate is trapezoidal; each Voigt strain is integrated exactly for a driving term linear in time,

    e_t(t+dt) = a e_t(t) + b f(t) + c f(t+dt),  f = C_t J2^m_t s,  a = exp(-x),  c = 1 - (1-a)/x,  b = (1-a)/x - a,

with x = dt/t_eps, so it is second order for small steps and stable for steps much longer than t_eps.
Plastic flow is rate-independent with linear hardening, sqrt(3) q = sigma_Y + H alpha.

Tensors are stored as normal components, then tensor (not engineering) shear: (rr, zz, tt, rz) in an axisymmetric body,
(xx, yy, zz, xy, yz, zx) in a general one.

Source: the corrected nonlinear Burgers law of the project's physics notes; radial return after
Simo & Hughes, Computational Inelasticity (1998), sections 3.3 and 3.6.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

# Layout of a law's coefficients: G, K, C_s, m_s, sigma_Y, H, then (C_t, m_t, t_eps) for each Voigt element.
SHEAR, BULK, STEADY, STEADY_EXPONENT, YIELD, HARDENING, VOIGT = range(7)
# Layout of the state at a point: stress deviator (4), steady and plastic strain (4), alpha, Voigt strains (4 each);
# where tensors have six components, six in place of each four.
STRESS, PERMANENT, ALPHA, TRANSIENT = 0, 4, 8, 9


def state_size(coefficients: np.ndarray, components: int = 4) -> int:
    """Return the number of state variables at one point, for tensors of so many `components`."""
    return 2 * components + 1 + components * ((len(coefficients) - VOIGT) // 3)


@njit(cache=True)
def step_weights(coefficients, dt):
    """Return what a step of length `dt` [s] makes of the coefficients.

    Returns
    -------
    ndarray, shape (1 + 4 * elements,)
        (dt/2) C_s, then a, b*C_t, c*C_t and the exponent m_t of each Voigt element.
    """
    elements = (coefficients.shape[0] - VOIGT) // 3
    weights = np.empty(1 + 4 * elements)
    weights[0] = 0.5 * dt * coefficients[STEADY]
    for k in range(elements):
        amplitude = coefficients[VOIGT + 3 * k]
        x = dt / coefficients[VOIGT + 3 * k + 2]
        decay = math.exp(-x)
        mean = -math.expm1(-x) / x
        weights[1 + 4 * k] = decay
        weights[2 + 4 * k] = (mean - decay) * amplitude
        weights[3 + 4 * k] = (1.0 - mean) * amplitude
        weights[4 + 4 * k] = coefficients[VOIGT + 3 * k + 1]
    return weights


@njit(cache=True, inline="always")
def invariant(t0, t1, t2, t3):
    """Return sqrt(T:T/2) of a symmetric tensor given as rr, zz, tt, rz."""
    return math.sqrt(0.5 * (t0 * t0 + t1 * t1 + t2 * t2) + t3 * t3)


@njit(cache=True)
def length(tensor, components):
    """Return sqrt(T:T/2) of a symmetric tensor stored as so many `components`, three of them normal."""
    normal, shear = 0.0, 0.0
    for i in range(3):
        normal += tensor[i] * tensor[i]
    for i in range(3, components):
        shear += tensor[i] * tensor[i]
    return math.sqrt(0.5 * normal + shear)


@njit(cache=True)
def history(state, weights, coefficients, out):
    """Write to `out` (components,) the strain that the past fixes: what R lacks from the strain deviator."""
    components = out.shape[0]
    transient = 2 * components + 1
    q = length(state, components)
    log_q = math.log(q) if q > 0.0 else -700.0
    steady = weights[0] * math.exp(2.0 * coefficients[STEADY_EXPONENT] * log_q)
    for i in range(components):
        out[i] = state[components + i] + steady * state[i]
    elements = (weights.shape[0] - 1) // 4
    for k in range(elements):
        driven = weights[2 + 4 * k] * math.exp(2.0 * weights[4 + 4 * k] * log_q)
        for i in range(components):
            out[i] += weights[1 + 4 * k] * state[transient + components * k + i] + driven * state[i]


@njit(cache=True)
def solve_radial(rho, guess, alpha, weights, coefficients):
    """Solve q phi(q) = rho by Newton; the left side is convex and increasing, so it converges from anywhere.

    Returns
    -------
    q, slope : float
        Invariant of the stress [GPa] and dq/drho, on the side of the yield stress where q lies.
    """
    elastic = 0.5 / coefficients[SHEAR]
    if rho <= 0.0:
        return 0.0, 1.0 / elastic
    power = 2.0 * coefficients[STEADY_EXPONENT]
    elements = (weights.shape[0] - 1) // 4
    root3 = math.sqrt(3.0)
    hardening = max(coefficients[HARDENING], 1e-9 * coefficients[SHEAR])
    threshold = coefficients[YIELD] + coefficients[HARDENING] * alpha
    q = guess if guess > 0.0 else rho / elastic
    plastic = root3 * q > threshold
    value, slope = 0.0, elastic
    for _ in range(60):
        log_q = math.log(q)
        term = weights[0] * math.exp(power * log_q)
        value = (elastic + term) * q - rho
        slope = elastic + (power + 1.0) * term
        for k in range(elements):
            exponent = 2.0 * weights[4 + 4 * k]
            term = weights[3 + 4 * k] * math.exp(exponent * log_q)
            value += term * q
            slope += (exponent + 1.0) * term
        plastic = root3 * q > threshold
        if plastic:
            value += 0.5 * root3 * (root3 * q - threshold) / hardening
            slope += 1.5 / hardening
        change = value / slope
        if change >= q:
            change = 0.5 * q
        q -= change
        if abs(change) <= 1e-8 * q:
            break
    if plastic != (root3 * q > threshold):
        slope += 1.5 / hardening if not plastic else -1.5 / hardening
    return q, 1.0 / slope


@njit(cache=True)
def commit(state, residual, q, rho, weights, coefficients):
    """Advance `state` in place to the end of the step whose solution is (`residual`, `q`, `rho`)."""
    components = residual.shape[0]
    alpha, transient = 2 * components, 2 * components + 1
    ratio = q / rho if rho > 0.0 else 0.0
    old = length(state, components)
    log_old = math.log(old) if old > 0.0 else -700.0
    log_new = math.log(q) if q > 0.0 else -700.0
    power = 2.0 * coefficients[STEADY_EXPONENT]
    steady_old = weights[0] * math.exp(power * log_old)
    steady_new = weights[0] * math.exp(power * log_new)
    root3 = math.sqrt(3.0)
    flow = 0.0
    excess = root3 * q - coefficients[YIELD] - coefficients[HARDENING] * state[alpha]
    if excess > 0.0:
        dalpha = excess / max(coefficients[HARDENING], 1e-9 * coefficients[SHEAR])
        state[alpha] += dalpha
        flow = 0.5 * root3 * dalpha / q
    elements = (weights.shape[0] - 1) // 4
    for k in range(elements):
        exponent = 2.0 * weights[4 + 4 * k]
        driven_old = weights[2 + 4 * k] * math.exp(exponent * log_old)
        driven_new = weights[3 + 4 * k] * math.exp(exponent * log_new)
        for i in range(components):
            j = transient + components * k + i
            state[j] = weights[1 + 4 * k] * state[j] + driven_old * state[i] + driven_new * ratio * residual[i]
    for i in range(components):
        new = ratio * residual[i]
        state[components + i] += steady_old * state[i] + (steady_new + flow) * new
        state[i] = new


def resisted(coefficients: np.ndarray, resistance: float) -> np.ndarray:
    """Return the laws (..., c) whose inelastic rates at stress s are those of `coefficients` at s / resistance."""
    if resistance == 1.0:
        return coefficients
    laws = coefficients.copy()
    laws[..., STEADY] *= resistance ** -(2 * laws[..., STEADY_EXPONENT] + 1)
    laws[..., VOIGT::3] *= resistance ** -(2 * laws[..., VOIGT + 1 :: 3] + 1)
    laws[..., [YIELD, HARDENING]] *= resistance
    return laws
