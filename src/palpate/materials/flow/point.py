"""One material point: its state, and how that passes through a time step.

Tensors are stored as normal components, then tensor (not engineering) shear: (rr, zz, tt, rz) in an axisymmetric body,
(xx, yy, zz, xy, yz, zx) in a general one. The state holds the stress deviator, the creep and plastic strain, the
hardening variable alpha, the pressure, and the strain of each Voigt element; under a back stress X also s - X.

Arguments of the functions:

- `law`, `weights`: row of the law, and its weights in the time step, see `palpate.materials.flow.row`
- `at`: where the block of a term begins in the row
- `state` (k,): state variables; `commit` advances them in place
- `rho`, `q`: invariants of the trial strain R [-] and of the stress [GPa]
- `alpha`, `pressure`: hardening variable as the history fixes it, and pressure [GPa], positive in compression
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.materials.flow.dispatch import fluidity_of
from palpate.materials.flow.radial import AT_YIELD, NOTHING, UNKNOWN, borne, compliance, solve_radial, threshold
from palpate.materials.flow.row import (
    BACK,
    BACK_STRESS,
    CLOSING,
    CREEP,
    DECAY,
    FACTORS,
    FIRST,
    FLOWING,
    FUNCTION,
    GAIN,
    HARDENING,
    INVERSE_RESISTANCE,
    KIND,
    LINEAR,
    NO_SHARE,
    NUMBERS,
    OPENING,
    PER_TERM,
    PLASTIC,
    SHARE,
    SIZE,
    SPLIT,
    STIFFENING,
    YIELD,
    voigt_elements,
)

STRESS = 0  # where the stress deviator begins in a state


def state_size(row: np.ndarray, components: int) -> int:
    """Return the number of state variables of a law, for tensors of so many `components`."""
    return (2 + voigt_elements(row) + (row[BACK_STRESS] > 0.0)) * components + 2


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
def driving(state, components, law):
    """Return the stress that drives the flow: s, or s - X under a back stress."""
    first = state.shape[0] - components if law[BACK_STRESS] > 0.0 else STRESS
    return state[first : first + components]


@njit(cache=True)
def fluidity_at(law, at, weights, q, pressure, alpha, gain):
    """Return the fluidity of the term whose block begins at `at`, at the stress over the resistance.

    The `gain` is what a fluidity of one adds to alpha over that stress.
    """
    if law[at + KIND] == LINEAR:
        return 1.0
    inverse = weights[INVERSE_RESISTANCE]
    scaled = max(q * inverse, NOTHING)
    number = int(law[at + FUNCTION])
    value, _, _, _ = fluidity_of(
        number, law, at + NUMBERS, scaled, math.log(scaled), pressure * inverse, alpha, gain * scaled
    )
    return value


@njit(cache=True)
def history(state, weights, law, past, back):
    """Write what the past fixes of a step.

    Parameters
    ----------
    past : ndarray, shape (components,)
        Out: strain that R lacks from the split strain deviator, see `residual`.
    back : ndarray, shape (components,)
        Out: back stress [GPa].

    Returns
    -------
    float
        Hardening variable.
    """
    n = past.shape[0]
    stress, alpha = driving(state, n, law), state[2 * n]
    q, pressure, split, stiffening = length(stress, n), state[2 * n + 1], weights[SPLIT], weights[STIFFENING]
    for i in range(n):
        past[i] = state[n + i]
        back[i] = stiffening * state[n + i]
    at, k, strain = FIRST, FACTORS, 2 * n + 2
    while at < law.shape[0]:
        kind = int(law[at + KIND])
        if kind not in (PLASTIC, BACK):
            value = weights[k + OPENING] * fluidity_at(law, at, weights, q, pressure, state[2 * n], 0.0)
            if kind == HARDENING:
                alpha += value * q / (FLOWING * max(law[SHARE], NO_SHARE))
            for i in range(n):
                change = value * (state[i] if kind == LINEAR else stress[i])
                if kind not in (CREEP, HARDENING):
                    change += weights[k + DECAY] * state[strain + i]
                past[i] += change * (split if kind == LINEAR else 1.0)
                back[i] += 0.0 if kind == LINEAR else stiffening * change
            strain += 0 if kind in (CREEP, HARDENING) else n
            k += PER_TERM
        at += int(law[at + SIZE])
    return alpha


@njit(cache=True)
def residual(deviator, past, weights):
    """Return R (components,) of a strain `deviator` (same)."""
    return weights[SPLIT] * deviator - past


@njit(cache=True)
def solve(rho, guess, alpha, pressure, weights, law):
    """Solve the radial equation from a `guess` of q, zero for none.

    Returns
    -------
    q, slope, push : float
        Invariant of the stress that drives the flow [GPa], and its derivatives by rho and by the pressure.
    """
    rho = max(rho, NOTHING)
    log_q = math.log(guess) if guess > 0.0 else 2.0 * UNKNOWN
    q, _, order, push = solve_radial(rho, rho, log_q, 0.0, alpha, pressure, law, weights)
    return q, order * q / rho, push


@njit(cache=True)
def commit(state, trial, back, alpha, q, pressure, weights, law):
    """Advance `state` in place to the end of a step.

    Parameters
    ----------
    trial, q, pressure
        Its solution: R, q and the pressure.
    back, alpha
        Back stress and hardening variable that the past fixed.
    """
    n = trial.shape[0]
    rho = max(length(trial, n), NOTHING)
    stress = driving(state, n, law)
    old, before, began = length(stress, n), state[2 * n + 1], state[2 * n]
    share, end = FLOWING * max(law[SHARE], NO_SHARE), alpha
    flown = 0.0
    if law[YIELD] > 0.0 and law[SHARE] > NO_SHARE:
        least, _, _ = threshold(alpha, pressure, law, weights)
        if q > AT_YIELD * least:
            total, _, _, _ = compliance(q, math.log(q), alpha, pressure, law, weights)
            slip = max(rho - total * q, 0.0)
            end += slip / share
            flown = slip / rho
    secant, _, _ = borne(q / rho, 1.0, 0.0, weights)
    at, k, strain = FIRST, FACTORS, 2 * n + 2
    while at < law.shape[0]:
        kind = int(law[at + KIND])
        if kind not in (PLASTIC, BACK):
            opened = fluidity_at(law, at, weights, old, before, began, 0.0)
            closed = fluidity_at(law, at, weights, q, pressure, alpha, weights[k + GAIN])
            if kind == HARDENING:
                end += weights[k + CLOSING] * closed * q / share
            creep = kind in (CREEP, HARDENING)
            where, decay = (n, 1.0) if creep else (strain, weights[k + DECAY])
            for i in range(n):
                if kind == LINEAR:
                    first, last = state[i], secant * trial[i] + back[i]
                else:
                    first, last = stress[i], q / rho * trial[i]
                tends = weights[k + OPENING] * opened * first + weights[k + CLOSING] * closed * last
                state[where + i] = decay * state[where + i] + tends
            strain += 0 if creep else n
            k += PER_TERM
        at += int(law[at + SIZE])
    for i in range(n):
        state[n + i] += flown * trial[i]
        stress[i] = q / rho * trial[i]
        if law[BACK_STRESS] > 0.0:
            state[i] = secant * trial[i] + back[i]
    state[2 * n] = end
    state[2 * n + 1] = pressure
