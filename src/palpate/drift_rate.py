r"""The rate of thermal drift, from a hold under a low load, with the uncertainty that correlated noise leaves it.

    h(t) = a + r t + c exp(-(t - t_0) / tau) + e(t)

The exponential is what recovery after unloading leaves, over within the hold (tau is at most a fifth of it; slower
recovery cannot be told from drift); it is kept when the Bayesian information criterion speaks
very strongly for it (by more than 10: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773).
The errors are autoregressive of first order: neighbouring points of an instrument share most of their noise, and
taking them for independent makes the interval several times too narrow. How correlated they are is not known from a
hold either: the rates at all correlations are weighed by the restricted likelihood, which allows for what a, r and c
absorb of the noise (Patterson and Thompson, Biometrika 58 (1971) 545).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from palpate.errors import InputError
from palpate.segments import Segment

MOST = 400
FEWEST = 20
CORNER = 2
CORRELATIONS = np.linspace(0.0, 0.99, 100)
TRANSIENTS = 12
VERY_STRONG = 10.0
LEAST = 1e-300
PROFILE = 0.5 * stats.chi2.ppf(0.95, 1)


@dataclass(frozen=True)
class DriftRate:
    """A rate of drift.

    Attributes
    ----------
    rate, lower, upper
        Estimate and 95 % interval [nm/s].
    start, end
        The hold it was measured in [s].
    """

    rate: float
    lower: float
    upper: float
    start: float
    end: float


def measured_in(time: np.ndarray, depth: np.ndarray, segments: Iterable[Segment]) -> DriftRate | None:
    """Return the rate in the longest drift hold of a test, or None where none is long enough.

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
    its second half. What a falling load gives back is allowed for, at most depth / load for each mN.
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
    """Return the rate of drift in a hold.

    Where a transient is kept, the interval is the hull of those at all times tau within the 95 % profile of the
    likelihood.

    Parameters
    ----------
    time, depth : ndarray, shape (n,)
        [s], [nm], of the hold alone; more than 400 points are brought to as many medians.

    Raises
    ------
    InputError
        When the hold has fewer than 20 points.
    """
    if len(time) < FEWEST:
        raise InputError(
            f"the hold has {len(time)} points, too few for a drift", remedy=f"record at least {FEWEST}", place="time_s"
        )
    blocks = np.array_split(np.arange(len(time)), min(MOST, len(time)))
    moments, values = (np.array([np.median(channel[block]) for block in blocks]) for channel in (time, depth))
    span = moments[-1] - moments[0]
    since = moments - moments[0]
    line = np.column_stack([np.ones_like(since), since])

    def with_transient(tau: float) -> tuple[float, float, float, int]:
        return (*_fitted(values, np.column_stack([line, np.exp(-since / tau)])), 5)

    coarse = np.geomspace(span / 50, span / 5, TRANSIENTS)
    fits = [with_transient(tau) for tau in coarse]
    near = int(np.argmax([fit[2] for fit in fits]))
    fits += [
        with_transient(tau)
        for tau in np.geomspace(coarse[max(near - 1, 0)], coarse[min(near + 1, TRANSIENTS - 1)], 2 * TRANSIENTS)
    ]
    fits.append((*_fitted(values, line), 3))
    count = len(values)
    best = min(fits, key=lambda fit: fit[3] * np.log(count) - 2 * fit[2] + (VERY_STRONG if fit[3] > 3 else 0.0))
    likely = [fit for fit in fits if fit[3] == best[3] and fit[2] >= best[2] - PROFILE]
    lower, upper = min(fit[0] - fit[1] for fit in likely), max(fit[0] + fit[1] for fit in likely)
    return DriftRate(best[0], lower, upper, float(time[0]), float(time[-1]))


def _fitted(values: np.ndarray, terms: np.ndarray) -> tuple[float, float, float]:
    """Return the second coefficient, half its 95 % interval and the largest log-likelihood, over all correlations.

    The points are whitened by Prais and Winsten's transform. With it the sums of products that the normal equations
    need are a quadratic in the correlation, so that all correlations are tried at once.
    """
    count, width = terms.shape
    begin = np.linalg.lstsq(terms, values, rcond=None)[0]
    columns = np.column_stack([values - terms @ begin, terms])
    rho = CORRELATIONS[:, None, None]
    lagged, inner = columns[1:].T @ columns[:-1], columns[1:-1].T @ columns[1:-1]
    products = columns.T @ columns - rho * (lagged + lagged.T) + rho**2 * inner
    information, along = products[:, 1:, 1:], products[:, 1:, :1]
    solution = np.linalg.solve(information, along)
    power = np.maximum(products[:, 0, 0] - np.sum(along * solution, axis=(1, 2)), LEAST)
    shared = 0.5 * np.log(1 - CORRELATIONS**2)
    restricted = shared - 0.5 * ((count - width) * np.log(power) + np.linalg.slogdet(information)[1])
    weight = np.exp(restricted - restricted.max())
    weight /= weight.sum()
    rate = float(weight @ solution[:, 1, 0])
    variance = np.linalg.inv(information)[:, 1, 1] * power / (count - width) + (solution[:, 1, 0] - rate) ** 2
    half = float(stats.t.ppf(0.975, count - width) * np.sqrt(weight @ variance))
    return float(begin[1]) + rate, half, float((shared - 0.5 * count * np.log(power / count)).max())
