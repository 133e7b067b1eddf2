r"""By how much the depth lags behind the load where the load reverses, without any model of the body.

Where loading or a hold passes into unloading, and unloading into reloading, the rate of the load jumps, and an elastic
response makes that of the depth jump with it. Around each reversal both channels are fitted by

    y = a + b t + c t^2 + (d + e (t - t_0)) (t - t_0)_+

with a corner at t_0, each by itself, and the lag is the difference of the two. The start of a test is no reversal:
there the depth of a blunt body begins without a jump. A body that creeps by much within a few points after a reversal
shows a lag, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from palpate.errors import InputError
from palpate.recordings.segments import segments

REVERSED = {("loading", "unloading"), ("hold", "unloading"), ("reloading", "unloading"), ("unloading", "reloading")}
FEWEST, MOST = 8, 60  # points on either side of a reversal
PART = 0.4  # of the shorter segment beside it, that is fitted
TRIALS = 61  # corners on trial in each of two steps
NEAR = 0.3  # of the window on either side, where the corner is sought
CLEAR = 10.0  # times the residual variance and more, by which a corner improves the fit that counts
TERMS = 5  # of the fit, and the corner's time


@dataclass(frozen=True)
class Lag:
    """A lag of the depth behind the load.

    Attributes
    ----------
    lag, lower, upper
        Estimate and 95 % interval [s].
    reversals
        Over which it was averaged.
    """

    lag: float
    lower: float
    upper: float
    reversals: int


def lag_at_reversals(tests: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> Lag | None:
    """Return the lag that the reversals of tests made alike share; None where no reversal shows a corner in both.

    The mean is weighed by the variances of the single lags, and its error allows for their scatter.

    Parameters
    ----------
    tests
        Time [s], load [mN] and depth [nm] of each, all (n,).
    """
    found = np.array([each for test in tests for each in _of_test(*test)]).reshape(-1, 2)
    if not len(found):
        return None
    lags, deviations = found.T
    weight = deviations**-2.0
    mean = float(weight @ lags / weight.sum())
    scatter = float(weight @ (lags - mean) ** 2) / max(len(lags) - 1, 1)
    half = 1.96 * float(np.sqrt(max(scatter, 1.0) / weight.sum()))
    return Lag(mean, mean - half, mean + half, len(lags))


def _of_test(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> list[tuple[float, float]]:
    """Return the lag [s] and its standard deviation at each reversal of a test."""
    try:
        parts = segments(time, load)
    except InputError:
        return []
    found = []
    for before, after in pairwise(parts):
        width = min(int(PART * min(before.last - before.first, after.last - after.first)), MOST)
        if (before.kind, after.kind) not in REVERSED or width < FEWEST:
            continue
        window = slice(before.last - width, before.last + width + 1)
        of_load, of_depth = (_corner(time[window], channel[window]) for channel in (load, depth))
        if of_load and of_depth:
            found.append((of_depth[0] - of_load[0], float(np.hypot(of_load[1], of_depth[1]))))
    return found


def _corner(time: np.ndarray, values: np.ndarray) -> tuple[float, float] | None:
    """Return the time of a channel's corner (n,) [s] and its standard deviation; None where it has none.

    Weights of corners on trial are those of their likelihood, the residual variance integrated out.
    """
    middle, width = float(time[len(time) // 2]), float(np.ptp(time)) / 2
    step = float(np.median(np.diff(time)))
    clock = (time - middle) / width
    low, high = -2 * NEAR, 2 * NEAR
    plain = _squares(np.vander(clock, 3), values)
    mean = deviation = 0.0
    for _ in range(2):
        trials = np.linspace(low, high, TRIALS)
        squares = np.array([_squares(_terms(clock, trial), values) for trial in trials])
        degrees = len(time) - TERMS - 1
        least = max(float(squares.min()), 1e-12 * float(np.ptp(values)) ** 2)
        if plain < (1 + CLEAR / degrees) * least:
            return None
        weight = (np.maximum(squares, least) / least) ** (-0.5 * degrees)
        weight /= weight.sum()
        mean = float(weight @ trials)
        deviation = float(np.sqrt(weight @ (trials - mean) ** 2))
        reach = max(5 * deviation, 2 * (trials[1] - trials[0]))
        low, high = max(mean - reach, low), min(mean + reach, high)
    return middle + width * mean, float(np.hypot(width * deviation, step / TRIALS))


def _terms(clock: np.ndarray, corner: float) -> np.ndarray:
    """Return the terms (n, 5) of a fit with a corner."""
    beyond = np.maximum(clock - corner, 0.0)
    return np.column_stack([np.ones_like(clock), clock, clock**2, beyond, beyond**2])


def _squares(terms: np.ndarray, values: np.ndarray) -> float:
    """Return the sum of squares that terms (n, k) leave of values (n,)."""
    basis = np.linalg.qr(terms)[0]
    return float(np.sum((values - basis @ (basis.T @ values)) ** 2))
