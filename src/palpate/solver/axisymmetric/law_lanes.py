"""The state of the material in `LANES` bodies, and how it passes from one time step to the next.

The radial equation is that of `palpate.materials.flow.radial`, at `LANES` laws at once.

Arguments of the functions, vectors of lanes: `rho`, `q`, `log_q`, `alpha`, `pressure`, `law` and `step` are those of
`palpate.materials.flow.radial`; `at` is where the block of a term begins in the row.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.arithmetic import whole
from palpate.materials.flow.dispatch import fluidity_of
from palpate.materials.flow.radial import AT_YIELD, UNKNOWN, borne, compliance, threshold
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
    LOG_RESISTANCE,
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
)
from palpate.solver.axisymmetric.lanes import LANES, greatest, load, magnitude, splat, store, where_less
from palpate.solver.axisymmetric.rows import put_rows

STEEPEST = 2.0  # factor between the rates that end a step and begin the next one, where the resistance falls


class Points(NamedTuple):
    """What changes at the p Gauss points, `LANES` columns each.

    Attributes
    ----------
    past, back : ndarray, shape (p, 4, LANES)
        Strain and back stress that the history fixes, see `palpate.materials.flow.radial`; no rows of back stress where
        the law has none.
    permanent : ndarray, shape (p, 4, LANES)
        Creep and plastic strain, with the part of the next step that the present stress decides.
    transient : ndarray, shape (p, elements, 4, LANES)
        Voigt strains, likewise.
    direction : ndarray, shape (p, 4, LANES)
        R / rho.
    rho, log_q, secant, order, push : ndarray, shape (p, LANES)
        Solution of the radial equation; q/rho; d ln q / d ln rho; and dq/dp.
    alpha : ndarray, shape (p, LANES)
        Hardening variable that the history fixes.
    pressure : ndarray, shape (p / 4, LANES)
        Of each element [GPa], positive in compression.
    """

    past: np.ndarray
    back: np.ndarray
    permanent: np.ndarray
    transient: np.ndarray
    direction: np.ndarray
    rho: np.ndarray
    log_q: np.ndarray
    secant: np.ndarray
    order: np.ndarray
    push: np.ndarray
    alpha: np.ndarray
    pressure: np.ndarray

    @classmethod
    def unloaded(cls, count: int, elements: int, backed: bool = False) -> Points:
        """Return `count` points at rest, of laws with so many Voigt elements, `backed` by a back stress or not."""
        back = np.zeros((count if backed else 0, 4, LANES))
        past, permanent, direction = (np.zeros((count, 4, LANES)) for _ in range(3))
        transient = np.zeros((count, elements, 4, LANES))
        rho, secant, order, push, alpha = (np.zeros((count, LANES)) for _ in range(5))
        pressure = np.zeros((count // 4, LANES))
        log_q = np.full((count, LANES), 2 * UNKNOWN)
        return cls(past, back, permanent, transient, direction, rho, log_q, secant, order, push, alpha, pressure)


@inner_kernel(cache=True)
def save_solution(points, solved, lanes):
    """Note the solution of the radial equation in some lanes: it is found again while others go on, but for rounding.

    Parameters
    ----------
    points
        See `Points`.
    solved : ndarray, shape (4, p, LANES)
        In and out: what is noted.
    lanes : ndarray of bool, shape (LANES,)
        Which lanes.
    """
    for k, rows in enumerate((points.log_q, points.secant, points.order, points.push)):
        put_rows(rows, solved[k], lanes)


@inner_kernel(cache=True)
def restore_solution(points, solved, lanes):
    """Write to the points what `save_solution` noted of some lanes; the parameters are the same."""
    for k, rows in enumerate((points.log_q, points.secant, points.order, points.push)):
        put_rows(solved[k], rows, lanes)


@inner_kernel(cache=True, inline="always")
def region_of(element, laws):
    """Return which of the `laws` (1 or m, rows, LANES) an element takes: the only one, or its own."""
    return element if len(laws) > 1 else 0


@inner_kernel(cache=True)
def driving(law, at, step, q, log_q, pressure, alpha, gain):
    """Return phi q of a term whose block begins at `at`, at the stress over the resistance.

    The `gain` is what a fluidity of one adds to alpha over that stress.
    """
    inverse = load(step, INVERSE_RESISTANCE)
    scaled, log_q, pressure = q * inverse, log_q - load(step, LOG_RESISTANCE), pressure * inverse
    number = whole(law, at + FUNCTION)
    value, _, _, _ = fluidity_of(number, law, at + NUMBERS, scaled, log_q, pressure, alpha, gain * scaled)
    return value * q


@inner_kernel(cache=True)
def plastic_strain(rho, q, log_q, alpha, pressure, law, step):
    """Return the length of the plastic strain deviator of a step."""
    if whole(law, YIELD) > 0:
        least, _, _ = threshold(alpha, pressure, law, step)
        least = AT_YIELD * least
        if greatest(q - least) > 0.0:
            total, _, _, _ = compliance(q, log_q, alpha, pressure, law, step)
            slip = where_less(least, q, rho - total * q, splat(0.0))
            return where_less(slip, splat(0.0), splat(0.0), slip)
    return splat(0.0)


@njit(cache=True, nogil=True)
def commit_and_begin(points, laws, done, following):
    """Commit a step of `laws` and weights `done` at all points, and begin the one of weights `following`.

    Both halves of a rate are parallel to the stress that the two steps share, and so is plastic flow.
    """
    elements, driven = points.transient.shape[1], np.empty((4, LANES))
    for p in range(points.rho.shape[0]):
        region = region_of(p // 4, laws)
        law, before, after = laws[region], done[region], following[region]
        rho, log_q, alpha = load(points.rho, p), load(points.log_q, p), load(points.alpha, p)
        q, pressure = rho * load(points.secant, p), load(points.pressure, p // 4)
        growing = greatest(magnitude(load(after, LOG_RESISTANCE) - load(before, LOG_RESISTANCE))) > 0.0
        flown = plastic_strain(rho, q, log_q, alpha, pressure, law, before)
        share = where_less(load(law, SHARE), splat(NO_SHARE), splat(1.0), FLOWING * load(law, SHARE))
        end = alpha + flown / share
        backed, split, stiffening = law[BACK_STRESS, 0] > 0.0, load(after, SPLIT), load(after, STIFFENING)
        secant, _, _ = borne(load(points.secant, p), splat(1.0), splat(0.0), before)
        for i in range(4):
            store(points.past, 4 * p + i, splat(0.0))
            store(driven, i, splat(0.0))
        at, k, element = FIRST, FACTORS, 0
        while at < law.shape[0]:
            kind = whole(law, at + KIND)
            if kind != PLASTIC and kind != BACK:
                closing = rho * secant
                if kind != LINEAR:
                    closing = driving(law, at, before, q, log_q, pressure, alpha, load(before, k + GAIN))
                opening = closing
                if growing and kind != LINEAR:
                    strained = alpha + load(before, k + CLOSING) * closing / share
                    opening = driving(law, at, after, q, log_q, pressure, strained, splat(0.0))
                    limit = STEEPEST * closing
                    opening = where_less(limit, opening, limit, opening)
                closing, opening = load(before, k + CLOSING) * closing, load(after, k + OPENING) * opening
                if kind == HARDENING:
                    end = alpha + (closing + opening) / share
                if kind in (CREEP, HARDENING):
                    flown = flown + closing + opening
                else:
                    decay, row = load(after, k + DECAY), 4 * (elements * p + element)
                    amplitude = decay * closing + opening
                    beside = decay * load(before, k + CLOSING) + load(after, k + OPENING)
                    for i in range(4):
                        strain = decay * load(points.transient, row + i)
                        strain = strain + amplitude * load(points.direction, 4 * p + i)
                        if backed and kind == LINEAR:
                            strain = strain + beside * load(points.back, 4 * p + i)
                        store(points.transient, row + i, strain)
                        if kind == LINEAR:
                            strain = split * strain
                        elif backed:
                            store(driven, i, load(driven, i) + strain)
                        store(points.past, 4 * p + i, load(points.past, 4 * p + i) + strain)
                    element += 1
                k += PER_TERM
            at += whole(law, at + SIZE)
        store(points.alpha, p, end)
        for i in range(4):
            strain = load(points.permanent, 4 * p + i) + flown * load(points.direction, 4 * p + i)
            store(points.permanent, 4 * p + i, strain)
            if backed:
                store(points.back, 4 * p + i, stiffening * (load(driven, i) + strain))
            store(points.past, 4 * p + i, load(points.past, 4 * p + i) + strain)


def deviator(points: Points, weights: np.ndarray, lane: int) -> np.ndarray:
    """Return the stress deviator (p, 4) [GPa] of a lane at the solution of the `points` under `weights`."""
    own = np.repeat(weights[:, :, lane], 4 * len(points.pressure) // len(weights), axis=0)
    secant = own[:, SPLIT] * points.secant[:, lane] + own[:, STIFFENING]
    stress = (points.rho[:, lane] * secant)[:, None] * points.direction[:, :, lane]
    return stress + points.back[:, :, lane] if len(points.back) else stress
