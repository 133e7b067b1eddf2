r"""The rate of thermal drift, from a hold under a low load, with the uncertainty that correlated noise leaves it.

    h(t) = a + r t + c exp(-(t - t_0) / tau) + e(t)

The exponential is what recovery after unloading leaves, over within the hold (tau is at most a fifth of it; slower
recovery cannot be distinguished from drift); it is kept when the Bayesian information criterion favours
it very strongly (by more than 10: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773).
Neighbouring errors are correlated by an amount that a hold does not determine: see
`indentation_files.correlated_errors`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from indentation_files.correlated_errors import Series, Shared, shared_coefficient
from indentation_files.errors import InputError
from indentation_files.segments import Segment

MOST = 400  # points of a fit; more are brought to medians
FEWEST = 20  # points of a hold that shows a drift
CORNER = 2  # points at each end of a hold, which may be its neighbours'
TRANSIENTS = 12  # times tau on trial, then twice as many about the best
VERY_STRONG = 10.0  # of the Bayesian information criterion, see above
PROFILE = 0.5 * chdtri(1, 0.05)  # of the log-likelihood, at the ends of a 95 % interval


@dataclass(frozen=True)
class DriftRate:
    """A rate of drift [nm/s]: estimate and 95 % interval."""

    rate: float
    lower: float
    upper: float


def measured_in(time: np.ndarray, depth: np.ndarray, segments: Iterable[Segment]) -> DriftRate | None:
    """Return the rate in the longest drift hold of a test, of times and depths (n,) [s], [nm]; None if all are short.

    Two points are left off at each end: a segment's ends are known to about that.
    """
    holds = [part for part in segments if part.kind == "drift_hold" and part.last - part.first >= FEWEST + 2 * CORNER]
    if not holds:
        return None
    longest = max(holds, key=lambda part: part.duration)
    inside = slice(longest.first + CORNER, longest.last + 1 - CORNER)
    return drift_rate(time[inside], depth[inside])


def fastest_in(
    time: np.ndarray, load: np.ndarray, depth: np.ndarray, segments: Iterable[Segment]
) -> tuple[float, float] | None:
    """Return the fastest drift [nm/s] that a test's holds under load admit, and its upper 95 % limit, or None without.

    Under a constant load creep only adds to the depth, so no drift is faster than what is recorded late in a hold: in
    its second half. What a falling load gives back is allowed for, at most depth / load for each mN. `time`, `load` and
    `depth` (n,) are in s, mN and nm, and `segments` are those of the test.
    """
    found = []
    for part in segments:
        first = (part.first + part.last) // 2
        if part.kind == "hold" and part.last - first >= FEWEST + CORNER:
            inside = slice(first, part.last + 1 - CORNER)
            seen = drift_rate(time[inside], depth[inside])
            falling = max(-float(np.polyfit(time[inside] - time[first], load[inside], 1)[0]), 0.0)
            given_back = falling * abs(float(np.median(depth[inside] / load[inside])))
            found.append((seen.rate + given_back, seen.upper + given_back))
    return min(found, key=lambda pair: pair[1]) if found else None


def drift_rate(time: np.ndarray, depth: np.ndarray) -> DriftRate:
    """Return the rate of drift in a hold of times and depths (n,) [s], [nm].

    More than 400 points are brought to as many medians. Where a transient is kept, the interval is the hull of those at
    all times tau within the 95 % profile of the likelihood. Raises `InputError` when the hold has fewer than 20 points.
    """
    if len(time) < FEWEST:
        raise InputError(
            f"the hold has {len(time)} points, too few for a drift", remedy=f"record at least {FEWEST}", place="time_s"
        )
    blocks = np.array_split(np.arange(len(time)), min(MOST, len(time)))
    moments, values = (np.array([np.median(channel[block]) for block in blocks]) for channel in (time, depth))
    span = moments[-1] - moments[0]
    since = moments - moments[0]
    level = np.ones_like(since)

    def with_transient(tau: float) -> tuple[Shared, int]:
        return shared_coefficient([Series(values, since, np.column_stack([level, np.exp(-since / tau)]))]), 5

    coarse = np.geomspace(span / 50, span / 5, TRANSIENTS)
    fits = [with_transient(tau) for tau in coarse]
    near = int(np.argmax([fit.likelihood for fit, _ in fits]))
    fits += [
        with_transient(tau)
        for tau in np.geomspace(coarse[max(near - 1, 0)], coarse[min(near + 1, TRANSIENTS - 1)], 2 * TRANSIENTS)
    ]
    fits.append((shared_coefficient([Series(values, since, level[:, None])]), 3))
    penalty = np.log(len(values))
    best, size = min(fits, key=lambda fit: fit[1] * penalty - 2 * fit[0].likelihood + VERY_STRONG * (fit[1] > 3))
    likely = [fit for fit, free in fits if free == size and fit.likelihood >= best.likelihood - PROFILE]
    lower, upper = min(fit.value - fit.half for fit in likely), max(fit.value + fit.half for fit in likely)
    return DriftRate(best.value, lower, upper)
