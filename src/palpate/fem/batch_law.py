"""The radial equation of `palpate.materials.radial` for `LANES` laws at once.

The unknown is y = ln q. On doubly logarithmic axes every power law is straight, so that Newton's method for

    G(y) = ln(V / rho) = 0,   V = q phi(q) = sum_j c_j q^(p_j),

gets there at once from anywhere near. The term of second order that Halley's method adds leaves an error of third
order; ln(V / rho) is 2 (z + z^3/3 + ...) with z = (V - rho) / (V + rho), and every power is exp(p y), so that no
logarithm is ever needed.

Where that q exceeds the yield stress, plastic flow adds (3/2) (q - q_Y) / H to V. V - rho is convex in y, and Newton's
method for its root comes back from above.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_vector import (
    LANES,
    exponential,
    greatest,
    load,
    log_of_one_plus,
    magnitude,
    rough_log,
    splat,
    store,
    where_less,
)
from palpate.materials.radial import BULK, HARDENING, SHEAR, STEADY_EXPONENT, VOIGT, YIELD, step_weights

ITERATIONS = 60
TOLERANCE = 1e-5  # of ln q; the change that is smaller is still made, so the error left is of its third power
SQUARED = 1e-7  # of q, with plastic flow: the error left is of its second power
NOTHING = 1e-150  # stands for rho = 0, so that the direction R / rho exists
UNKNOWN = -300.0  # below it ln q is no guess

ELASTIC, VOLUMETRIC, YIELDING, HARDENED, POWERS = range(5)
ROOT3 = math.sqrt(3.0)


class Points(NamedTuple):
    """What changes at the p Gauss points, `LANES` columns each.

    Attributes
    ----------
    past : ndarray, shape (p, 4, LANES)
        Strain that the history fixes.
    permanent : ndarray, shape (p, 4, LANES)
        Steady creep strain, with the part of the next step that the present stress decides.
    transient : ndarray, shape (p, elements, 4, LANES)
        Voigt strains, likewise.
    direction : ndarray, shape (p, 4, LANES)
        R / rho.
    rho, log_q, secant, order : ndarray, shape (p, LANES)
        Solution of the radial equation; q/rho; and d ln q / d ln rho.
    alpha : ndarray, shape (p, LANES)
        Accumulated plastic strain at the start of the step.
    """

    past: np.ndarray
    permanent: np.ndarray
    transient: np.ndarray
    direction: np.ndarray
    rho: np.ndarray
    log_q: np.ndarray
    secant: np.ndarray
    order: np.ndarray
    alpha: np.ndarray

    @classmethod
    def unloaded(cls, count: int, elements: int) -> Points:
        """Return `count` points at rest, of laws with so many Voigt elements."""
        past, permanent, direction = (np.zeros((count, 4, LANES)) for _ in range(3))
        transient = np.zeros((count, elements, 4, LANES))
        rho, secant, order, alpha = (np.zeros((count, LANES)) for _ in range(4))
        log_q = np.full((count, LANES), 2 * UNKNOWN)
        return cls(past, permanent, transient, direction, rho, log_q, secant, order, alpha)


def law_rows(coefficients: np.ndarray) -> np.ndarray:
    """Return 1/(2G), K, q_Y, (3/2)/H and the powers of q in the rates, as rows (4 + powers, LANES).

    Parameters
    ----------
    coefficients : ndarray, shape (LANES, c)
        See `palpate.materials.radial`.
    """
    shear, bulk, yielding, hardening = coefficients[:, [SHEAR, BULK, YIELD, HARDENING]].T
    powers = [2.0 * coefficients[:, STEADY_EXPONENT], *(2.0 * coefficients[:, VOIGT + 1 :: 3].T)]
    return np.array([0.5 / shear, bulk, yielding / ROOT3, 1.5 / np.maximum(hardening, 1e-9 * shear), *powers])


def weight_rows(coefficients: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return `step_weights` of steps (LANES,) [s] as rows (weights, LANES)."""
    return np.ascontiguousarray(
        np.transpose([step_weights(row, step) for row, step in zip(coefficients, steps, strict=True)])
    )


@njit(cache=True, inline="always")
def compliance(log_q, law, weights):
    """Return phi(q), d(q phi)/dq, and q d2(q phi)/dq2 plus the latter, of what flows without a yield stress."""
    elastic, power = load(law, ELASTIC), load(law, POWERS)
    term = load(weights, 0) * exponential(power * log_q)
    total, growth, bend = elastic + term, elastic + term, elastic + term
    term = power * term
    growth, bend = growth + term, bend + (2.0 + power) * term
    for k in range((weights.shape[0] - 1) // 4):
        exponent = load(law, POWERS + 1 + k)
        term = load(weights, 3 + 4 * k) * exponential(exponent * log_q)
        total, growth, bend = total + term, growth + term, bend + term
        term = exponent * term
        growth, bend = growth + term, bend + (2.0 + exponent) * term
    return total, growth, bend


@njit(cache=True, inline="always")
def region_of(element, laws):
    """Return which of the `laws` (1 or m, rows, LANES) an element takes: the only one, or its own."""
    return element if len(laws) > 1 else 0


@njit(cache=True, inline="always")
def threshold(law, alpha):
    """Return the q at which plastic flow begins after a plastic strain `alpha`."""
    return load(law, YIELDING) + (1.5 / ROOT3) * alpha / load(law, HARDENED)


@njit(cache=True)
def solve_radial(rho, last, log_q, order, alpha, law, weights):
    """Solve q phi(q) = rho > 0, from the `last` rho, its ln q and d ln q / d ln rho, after a plastic strain `alpha`.

    Returns
    -------
    q, log_q, order
        Vectors: the solution, its logarithm, and d ln q / d ln rho.
    """
    further = log_q + order * 2.0 * (rho - last) / (rho + last)
    log_q = where_less(log_q, splat(UNKNOWN), rough_log(rho) - rough_log(load(law, ELASTIC)), further)
    q, order, change = rho, rho, rho
    for _ in range(ITERATIONS):
        q = exponential(log_q)
        total, growth, bend = compliance(log_q, law, weights)
        value = total * q
        both = value + rho
        inverse = 1.0 / (both * total * growth)
        excess = (value - rho) * inverse * total * growth
        order = both * inverse * total * total
        change = (2.0 + (2.0 / 3.0) * excess * excess) * excess * order
        curve = 0.5 * change * (both * inverse * total * bend - both * inverse * growth * growth)
        change = change + where_less(magnitude(curve), splat(0.05), change * curve, splat(0.0))
        log_q = log_q - change
        order = order + 2.0 * curve * order
        if greatest(magnitude(change)) < TOLERANCE:
            break
    q = q * (1.0 - change * (1.0 - change * (0.5 - change * (1.0 / 6.0))))
    if greatest(q - threshold(law, alpha)) > 0.0:
        q, log_q, order = flow(rho, q, log_q, order, alpha, law, weights)
    return q, log_q, order


@njit(cache=True)
def flow(rho, q, log_q, order, alpha, law, weights):
    """Return what `solve_radial` does, from the solution without plastic flow."""
    least, plastic = threshold(law, alpha), load(law, HARDENED)
    for _ in range(ITERATIONS):
        total, growth, _ = compliance(log_q, law, weights)
        slope = growth + plastic
        change = (total * q - rho + plastic * (q - least)) / (q * slope)
        change = where_less(least, q, change, splat(0.0))
        log_q = log_q + log_of_one_plus(splat(0.0) - change)
        order = where_less(least, q, rho / (q * slope), order)
        q = q * (1.0 - change)
        if greatest(magnitude(change)) < SQUARED:
            break
    return q, log_q, order


@njit(cache=True)
def turn(points, laws, done, following):
    """Close a step of `laws` and weights `done` at all points and open the one of weights `following`.

    Both halves of a rate are parallel to the stress that the two steps share, and so is plastic flow; see
    `palpate.materials.radial.commit` and `history`.
    """
    elements = (done.shape[1] - 1) // 4
    for p in range(points.rho.shape[0]):
        region = region_of(p // 4, laws)
        law, before, after = laws[region], done[region], following[region]
        rho, log_q, alpha = load(points.rho, p), load(points.log_q, p), load(points.alpha, p)
        q = rho * load(points.secant, p)
        least = threshold(law, alpha)
        plastic = splat(0.0)
        if greatest(q - least) > 0.0:
            total, _, _ = compliance(log_q, law, before)
            plastic = where_less(least, q, rho - total * q, plastic)
            store(points.alpha, p, alpha + (2.0 / ROOT3) * plastic)
        steady = (load(before, 0) + load(after, 0)) * q * exponential(load(law, POWERS) * log_q) + plastic
        for i in range(4):
            strain = load(points.permanent, 4 * p + i) + steady * load(points.direction, 4 * p + i)
            store(points.permanent, 4 * p + i, strain)
            store(points.past, 4 * p + i, strain)
        for k in range(elements):
            driven = q * exponential(load(law, POWERS + 1 + k) * log_q)
            decay, closing = load(after, 1 + 4 * k), load(before, 3 + 4 * k)
            amplitude = (decay * closing + load(after, 2 + 4 * k)) * driven
            row = 4 * (elements * p + k)
            for i in range(4):
                strain = decay * load(points.transient, row + i) + amplitude * load(points.direction, 4 * p + i)
                store(points.transient, row + i, strain)
                store(points.past, 4 * p + i, load(points.past, 4 * p + i) + strain)
