"""One material point: its state, and how that passes through a time step.

Tensors are stored as normal components, then tensor (not engineering) shear: (rr, zz, tt, rz) in an axisymmetric body,
(xx, yy, zz, xy, yz, zx) in a general one. The state holds the stress deviator, the creep and plastic strain, the
equivalent plastic strain, the pressure, and the strain of each Voigt element.

Arguments of the functions:

- `law`, `weights`: row of the law, and its weights in the time step, see `palpate.materials.flow.row`
- `at`: where the block of a term begins in the row
- `state` (k,): state variables; `commit` advances them in place
- `rho`, `q`: invariants of the trial strain R [-] and of the stress [GPa]
- `alpha`, `pressure`: equivalent plastic strain at the start of the step, and pressure [GPa], positive in compression
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.materials.flow.dispatch import fluidity_of
from palpate.materials.flow.radial import AT_YIELD, NOTHING, UNKNOWN, compliance, solve_radial, threshold
from palpate.materials.flow.row import (
    CLOSING,
    CREEP,
    DECAY,
    FACTORS,
    FIRST,
    FUNCTION,
    INVERSE_RESISTANCE,
    KIND,
    LINEAR,
    NUMBERS,
    OPENING,
    PER_TERM,
    PLASTIC,
    SHARE,
    SIZE,
    YIELD,
    voigt_elements,
)

STRESS = 0  # where the stress deviator begins in a state


def state_size(row: np.ndarray, components: int) -> int:
    """Return the number of state variables of a law, for tensors of so many `components`."""
    return (2 + voigt_elements(row)) * components + 2


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
def fluidity_at(law, at, weights, q, pressure):
    """Return the fluidity of the term whose block begins at `at`, at the stress over the resistance."""
    if law[at + KIND] == LINEAR:
        return 1.0
    inverse = weights[INVERSE_RESISTANCE]
    scaled = max(q * inverse, NOTHING)
    number = int(law[at + FUNCTION])
    value, _, _, _ = fluidity_of(number, law, at + NUMBERS, scaled, math.log(scaled), pressure * inverse)
    return value


@njit(cache=True)
def history(state, weights, law, out):
    """Write to `out` (components,) the strain that the past fixes: what R lacks from the strain deviator."""
    n = out.shape[0]
    q, pressure = length(state, n), state[2 * n + 1]
    for i in range(n):
        out[i] = state[n + i]
    at, k, strain = FIRST, FACTORS, 2 * n + 2
    while at < law.shape[0]:
        kind = int(law[at + KIND])
        if kind != PLASTIC:
            value = fluidity_at(law, at, weights, q, pressure)
            for i in range(n):
                out[i] += weights[k + OPENING] * value * state[i]
            if kind != CREEP:
                for i in range(n):
                    out[i] += weights[k + DECAY] * state[strain + i]
                strain += n
            k += PER_TERM
        at += int(law[at + SIZE])


@njit(cache=True)
def solve(rho, guess, alpha, pressure, weights, law):
    """Solve the radial equation from a `guess` of q, zero for none.

    Returns
    -------
    q, slope, push : float
        Invariant of the stress [GPa], and its derivatives by rho and by the pressure.
    """
    rho = max(rho, NOTHING)
    log_q = math.log(guess) if guess > 0.0 else 2.0 * UNKNOWN
    q, _, order, push = solve_radial(rho, rho, log_q, 0.0, alpha, pressure, law, weights)
    return q, order * q / rho, push


@njit(cache=True)
def commit(state, residual, q, pressure, weights, law):
    """Advance `state` in place to the end of the step whose solution is `residual` (R), `q` and `pressure`."""
    n = residual.shape[0]
    rho = max(length(residual, n), NOTHING)
    old, before = length(state, n), state[2 * n + 1]
    flown = 0.0
    if law[YIELD] > 0.0 and law[SHARE] > 1e-12:
        least, _, _ = threshold(state[2 * n], pressure, law, weights)
        if q > AT_YIELD * least:
            total, _, _, _ = compliance(q, math.log(q), pressure, law, weights)
            slip = max(rho - total * q, 0.0)
            state[2 * n] += slip / (0.5 * math.sqrt(3.0) * law[SHARE])
            flown = slip / rho
    at, k, strain = FIRST, FACTORS, 2 * n + 2
    while at < law.shape[0]:
        kind = int(law[at + KIND])
        if kind != PLASTIC:
            opened = fluidity_at(law, at, weights, old, before)
            closed = fluidity_at(law, at, weights, q, pressure) * q / rho
            where, decay = (n, 1.0) if kind == CREEP else (strain, weights[k + DECAY])
            for i in range(n):
                tends = weights[k + OPENING] * opened * state[i] + weights[k + CLOSING] * closed * residual[i]
                state[where + i] = decay * state[where + i] + tends
            strain += 0 if kind == CREEP else n
            k += PER_TERM
        at += int(law[at + SIZE])
    for i in range(n):
        state[n + i] += flown * residual[i]
        state[i] = q / rho * residual[i]
    state[2 * n + 1] = pressure
