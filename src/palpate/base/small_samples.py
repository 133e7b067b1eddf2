"""Intervals from few values: the difference of two means, a slope, and the scatter beyond the errors of the values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtri, ndtri, stdtrit

Interval = tuple[float, float, float]  # estimate, lower and upper end of the 95 % interval
NORMAL_95 = float(ndtri(0.975))


def difference(first: np.ndarray, second: np.ndarray, assumed: float) -> Interval:
    """Return the mean of `second` (m,) less that of `first` (n,), with the 95 % interval of B. L. Welch.

    Parameters
    ----------
    assumed
        Standard deviation of a single value, where a group has one only.

    Source: B. L. Welch, Biometrika 34 (1947) 28-35.
    """
    parts = [(np.var(v, ddof=1) if len(v) > 1 else assumed**2) / len(v) for v in (first, second)]
    per_freedom = sum(part**2 / (len(v) - 1) for part, v in zip(parts, (first, second), strict=True) if len(v) > 1)
    quantile = float(stdtrit(sum(parts) ** 2 / per_freedom, 0.975)) if per_freedom > 0.0 else NORMAL_95
    value, half = float(np.mean(second) - np.mean(first)), quantile * float(np.sqrt(sum(parts)))
    return value, value - half, value + half


def mean(values: np.ndarray) -> Interval:
    """Return the mean of two values (n,) or more with Student's 95 % interval."""
    half = float(stdtrit(len(values) - 1, 0.975) * np.std(values, ddof=1) / np.sqrt(len(values)))
    return float(np.mean(values)), float(np.mean(values)) - half, float(np.mean(values)) + half


def slope(places: np.ndarray, values: np.ndarray, own: np.ndarray) -> Interval | None:
    """Return the slope of values (n,) over their places, with a 95 % interval for errors of unlike size.

    The covariance is that of J. G. MacKinnon and H. White, J. Econometrics 29 (1985) 305-325 (HC3), which few values
    make too wide rather than too narrow. None with fewer than two degrees of freedom, or where the slope is open.

    Parameters
    ----------
    own : ndarray, shape (n, k)
        Further terms, such as a level for each group of values.
    """
    terms = np.column_stack([places, own])
    free = len(values) - terms.shape[1]
    if free < 2 or np.linalg.matrix_rank(terms) < terms.shape[1]:
        return None
    inverse = np.linalg.inv(terms.T @ terms)
    found = inverse @ terms.T @ values
    leverage = np.einsum("ij,jk,ik->i", terms, inverse, terms)
    left = (values - terms @ found) / np.maximum(1.0 - leverage, 1e-6)
    variance = float((inverse[0] @ terms.T) ** 2 @ left**2)
    half = float(stdtrit(free, 0.975)) * float(np.sqrt(variance))
    return float(found[0]), float(found[0]) - half, float(found[0]) + half


def scatter(groups: Sequence[np.ndarray], variances: Sequence[float]) -> Interval:
    """Return the standard deviation of values within groups beyond their own errors, with its 95 % interval.

    Q(tau^2) = sum_g sum_i (x_gi - mean_g)^2 / (v_g + tau^2) is chi-square of the groups' degrees of freedom at the true
    tau: the estimate makes it that number, the interval holds every tau at which it is not extreme.

    Parameters
    ----------
    groups : sequence of ndarray, shape (n_g,)
        Two values or more each.
    variances
        v_g, of the error of a single value.

    Sources: R. C. Paule and J. Mandel, J. Res. Natl. Bur. Stand. 87 (1982) 377-385; W. Viechtbauer, Stat. Med. 26
    (2007) 37-52.
    """
    squares = np.array([float(np.sum((values - values.mean()) ** 2)) for values in groups])
    errors, freedom = np.asarray(variances, dtype=float), sum(len(values) - 1 for values in groups)

    def where(wanted: float) -> float:
        def above(variance: float) -> float:
            return float(np.sum(squares / (errors + variance))) - wanted

        least = 1e-12 * float(squares.max())
        return brentq(above, least, squares.sum() / wanted + least, xtol=least) if above(least) > 0.0 else 0.0

    wanted = (freedom, chdtri(freedom, 0.025), chdtri(freedom, 0.975))
    value, lower, upper = (float(np.sqrt(where(float(number)))) for number in wanted)
    return value, lower, upper
