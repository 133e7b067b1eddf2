"""Coulomb friction, as `palpate.fem.friction`, for `LANES` indentations at once.

Nodes of a lane without friction take part in nothing here: their ratio m stays zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.fem.batch_vector import LANES
from palpate.fem.friction import ELASTIC_SLIP


class Grip(NamedTuple):
    """The friction of the surface nodes.

    Attributes
    ----------
    coefficient : ndarray, shape (LANES,)
    reach : ndarray, shape (k, LANES)
        Slip at which a node that stuck reaches the limit.
    anchor : ndarray, shape (k, LANES)
        Distance from the axis at which a node sticks; NaN where it does not touch.
    pace : ndarray, shape (k, LANES)
        By how much the distance from the axis changed per time in the last step.
    start, drift, opening : ndarray, shape (k, LANES)
        That distance at the start of the step, by how much it will change at the same pace, and the gap at the start.
    slip : ndarray, shape (k, LANES)
        Slip since the anchor, in units of the reach.
    ratio, steepness : ndarray, shape (k, LANES)
        The ratio m of tangential to normal force, and dm/dR.
    changed : ndarray of bool, shape (LANES,)
        Whether nodes began or ceased to slip in this iteration.
    """

    coefficient: np.ndarray
    reach: np.ndarray
    anchor: np.ndarray
    pace: np.ndarray
    start: np.ndarray
    drift: np.ndarray
    opening: np.ndarray
    slip: np.ndarray
    ratio: np.ndarray
    steepness: np.ndarray
    changed: np.ndarray

    @classmethod
    def untouched(cls, coefficients: Sequence[float], heights: np.ndarray) -> Grip:
        """Return the friction of nodes that never touched, under these heights (k, LANES) of the indenters."""
        pace, start, drift, opening, slip, ratio, steepness = np.zeros((7, *heights.shape))
        return cls(
            np.array(coefficients),
            ELASTIC_SLIP * np.maximum(heights, heights[1]),
            np.full(heights.shape, np.nan),
            pace, start, drift, opening, slip, ratio, steepness,
            np.zeros(LANES, dtype=np.bool_),
        )  # fmt: skip


@njit(cache=True)
def reverses(grip, k, lane, distance):
    """Return whether the slip of a node at a `distance` from the axis has reversed since the iteration before."""
    slip, last = (distance - grip.anchor[k, lane]) / grip.reach[k, lane], grip.slip[k, lane]
    return grip.coefficient[lane] > 0.0 and slip * last < 0.0 and abs(slip) > 1.0 and abs(last) > 1.0


@njit(cache=True)
def anchor(grip, k, lane, gap):
    """Anchor a node that joins with a negative `gap`: where that first closed, by linear interpolation in the step."""
    opening = grip.opening[k, lane]
    if opening > 0.0 and np.isnan(grip.anchor[k, lane]):
        grip.anchor[k, lane] = grip.start[k, lane] + opening / (opening - gap) * grip.drift[k, lane]


@njit(cache=True)
def rub(grip, k, lane, distance):
    """Write the slip of a node at a `distance` from the axis, and what friction makes of it."""
    coefficient, reach = grip.coefficient[lane], grip.reach[k, lane]
    slip = (distance - grip.anchor[k, lane]) / reach
    slips = abs(slip) > 1.0
    if slips != (abs(grip.slip[k, lane]) > 1.0):
        grip.changed[lane] = True
    grip.slip[k, lane] = slip
    grip.ratio[k, lane], grip.steepness[k, lane] = 0.0, 0.0
    if slips:
        grip.ratio[k, lane] = coefficient if slip > 0.0 else -coefficient
    elif slip == slip:
        grip.ratio[k, lane], grip.steepness[k, lane] = coefficient * slip, coefficient / reach


@njit(cache=True)
def set_out(grip, k, lane, distance, opening, step):
    """Begin a step of so many seconds with a node at a `distance` from the axis, under a gap."""
    grip.start[k, lane], grip.opening[k, lane] = distance, opening
    grip.drift[k, lane], grip.slip[k, lane] = step * grip.pace[k, lane], 0.0


@njit(cache=True)
def arrive(grip, k, lane, distance, touching, step):
    """End a step of so many seconds with a node at a `distance` from the axis: it drags its anchor along."""
    reach = grip.reach[k, lane]
    dragged = min(max(grip.anchor[k, lane], distance - reach), distance + reach)
    grip.anchor[k, lane] = dragged if touching else np.nan
    grip.pace[k, lane] = (distance - grip.start[k, lane]) / step
