r"""A law at a point under uniaxial stress, by its own update: a test of the bulk, without finite elements.

With the axial stress sigma, the logarithmic strain eps and the bulk modulus K, along the axis

    s = 2 sigma / 3,   p = -sigma / 3,   e = eps - sigma / (9 K),

and minus half of s and e across it. So s and R of `palpate.materials.flow.radial` keep the direction (1, -1/2, -1/2),
and each step has one unknown: sigma where the strain is prescribed, and rho where the stress is. Under large strains
the laws relate true stress to logarithmic strain as well; the axes keep still, so the same equations hold.

What is prescribed runs straight between samples. The intervals between them are divided in two until the response
changes by less than `TOLERANCE`.

Arguments of the kernels are those of `palpate.materials.flow.point`, tensors having three normal components, with
`past` and `back` (3,), which `history` writes, and

- `strain`, `stress`: along the axis, at the end of a step, the second one in GPa
- `prescribed` (n,): strain or, where `stress_driven`, stress at the ends of all steps, whose `weights` are (n, w)
- `response` (n,): out, the other one
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from indentation_files.uniaxial_test import STRAIN, STRESS
from palpate.materials.flow.point import commit, history, residual, solve, state_size
from palpate.materials.flow.radial import NOTHING, borne
from palpate.materials.flow.row import BULK, COMPLIANCE, SPLIT, STIFFENING, step_weights

TOLERANCE = 1e-4  # of the largest response; chosen, below the noise of a load cell
HALVINGS = 8  # of an interval, at most
CLOSE = 1e-10  # relative change of the unknown that ends a step's iteration
ITERATIONS = 80
UNIT_LENGTH = 0.5 * math.sqrt(3.0)  # sqrt(T:T/2) of T = (1, -1/2, -1/2)
LARGEST = 1e3  # rho beyond which no strain bears the stress


@njit(cache=True)
def stress_at(strain, stress, state, past, back, alpha, weights, law):
    """Return the axial stress [GPa] at the end of a step to an axial `strain`, from a guess; and q.

    Newton's method; NaN where it is not found.
    """
    split, stiffening, lateral = weights[SPLIT], weights[STIFFENING], 1.0 / (9.0 * law[BULK])
    scale, q = 1e-9 * law[BULK], 0.0
    for _ in range(ITERATIONS):
        trial = split * (strain - lateral * stress) - past[0]
        rho = max(UNIT_LENGTH * abs(trial), NOTHING)
        q, slope, push = solve(rho, q, alpha, -stress / 3.0, weights, law)
        secant, _, _ = borne(q / rho, 1.0, 0.0, weights)
        excess = 1.5 * (secant * trial + back[0]) - stress
        by_stress = -(split * slope + stiffening) * split * lateral - math.copysign(split * push / 3.0, trial)
        change = excess / (1.0 - 1.5 * by_stress)
        stress += change
        if not abs(change) > CLOSE * (abs(stress) + scale):
            return stress, q
    return math.nan, math.nan


@njit(cache=True)
def rho_at(stress, rho, back, alpha, weights, law):
    """Return rho at the end of a step to an axial `stress` [GPa], from a guess; and q.

    The stress along R grows with rho; Newton's method for its logarithm within brackets. NaN where it is not found.
    """
    split, stiffening = weights[SPLIT], weights[STIFFENING]
    wanted, q = UNIT_LENGTH * abs(stress / 1.5 - back[0]), 0.0
    if wanted <= NOTHING:
        return NOTHING, solve(NOTHING, 0.0, alpha, -stress / 3.0, weights, law)[0]
    elastic = wanted * weights[COMPLIANCE] / (split + stiffening * weights[COMPLIANCE])
    low, high, y = math.log(NOTHING), math.log(LARGEST), math.log(max(rho, elastic))
    for _ in range(ITERATIONS):
        rho = math.exp(y)
        q, slope, _ = solve(rho, q, alpha, -stress / 3.0, weights, law)
        along = split * q + stiffening * rho
        excess = math.log(along / wanted)
        if excess < 0.0:
            low = y
        else:
            high = y
        change = excess * along / max((split * slope + stiffening) * rho, 1e-12 * along)
        y = y - change if low < y - change < high else 0.5 * (low + high)
        if not abs(change) > CLOSE or high - low < CLOSE:
            return (rho if abs(excess) < 1e-6 else math.nan), q
    return math.nan, math.nan


@njit(cache=True)
def march(prescribed, stress_driven, weights, law, state, response):
    """Write the response to what is prescribed, and advance the `state` in place; NaN from a step on that fails."""
    past, back, trial = np.empty(3), np.empty(3), np.empty(3)
    direction = np.array([1.0, -0.5, -0.5])
    lateral, stress, rho = 1.0 / (9.0 * law[BULK]), 0.0, 0.0
    response[:] = math.nan
    for k in range(len(prescribed)):
        step = weights[k]
        alpha = history(state, step, law, past, back)
        if stress_driven:
            stress = prescribed[k]
            rho, q = rho_at(stress, rho, back, alpha, step, law)
            axial = math.copysign(rho / UNIT_LENGTH, stress / 1.5 - back[0])
            response[k] = (axial + past[0]) / step[SPLIT] + lateral * stress
        else:
            stress, q = stress_at(prescribed[k], stress, state, past, back, alpha, step, law)
            axial = residual(prescribed[k] - lateral * stress, past[0], step)
            response[k] = stress
        if math.isnan(response[k]):
            return
        trial[:] = axial * direction
        commit(state, trial, back, alpha, q, -stress / 3.0, step, law)


def response_to(row: np.ndarray, time: np.ndarray, prescribed: np.ndarray, control: str = STRAIN) -> np.ndarray:
    """Return the response of a law under uniaxial stress: the true stress [GPa], or the logarithmic strain.

    Tension is positive. A history that does not begin at zero begins with a jump.

    Parameters
    ----------
    row : ndarray, shape (c,)
        The law, see `palpate.materials.flow.row`.
    time : ndarray, shape (n,)
        Increasing [s].
    prescribed : ndarray, shape (n,)
        Logarithmic strain, or true stress [GPa].
    control
        Which of them is prescribed: ``strain`` or ``stress``.

    Returns
    -------
    ndarray, shape (n,)
        NaN from the point on where no strain bears the stress.
    """
    return response_in_steps(row, time, prescribed, control, steps_needed(row, time, prescribed, control))


def steps_needed(row: np.ndarray, time: np.ndarray, prescribed: np.ndarray, control: str = STRAIN) -> int:
    """Return the steps from a sample to the next beyond which `response_to` changes by no more than `TOLERANCE`."""
    coarse = response_in_steps(row, time, prescribed, control, 1)
    for halving in range(1, HALVINGS + 1):
        fine = response_in_steps(row, time, prescribed, control, 2**halving)
        if not np.nanmax(np.abs(fine - coarse), initial=0.0) > TOLERANCE * np.nanmax(np.abs(fine), initial=0.0):
            break
        coarse = fine
    return 2**halving


def response_in_steps(
    row: np.ndarray, time: np.ndarray, prescribed: np.ndarray, control: str, parts: int
) -> np.ndarray:
    """Return what `response_to` does, with so many steps, or `parts`, from each sample to the next."""
    places = np.arange((len(time) - 1) * parts + 1) / parts
    steps = np.diff(np.interp(places, np.arange(len(time)), time), prepend=time[0])
    drive = np.interp(places, np.arange(len(time)), prescribed)
    weights = step_weights(np.broadcast_to(row, (len(steps), len(row))), steps)
    response = np.empty(len(steps))
    march(drive, control == STRESS, weights, row, np.zeros(state_size(row, 3)), response)
    return response[::parts]
