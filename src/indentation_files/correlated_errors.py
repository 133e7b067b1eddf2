r"""A coefficient that several series share, when neighbouring errors are correlated by an unknown amount.

    y_s = c x_s + T_s b_s + e_s        e_i = rho e_(i-1) + independent errors of one variance, in each series s

Neighbouring points of an instrument share most of their noise, and taking them for independent makes the interval of c
several times too narrow. So does estimating rho from what a fit leaves: b and c absorb of the noise what is most
correlated. Therefore c is estimated at every rho, and the estimates are weighed by the restricted likelihood of rho,

    L(rho) = (1 - rho^2)^(m / 2) |X^T W X|^(-1/2) Q^(-(n - p) / 2)

with m series, n points, p coefficients, the whitening W = W(rho) of all terms X, and Q what is left after whitening.
Few points leave rho open; its prior is the reference prior with the density (1 - rho^2)^(-1/2): the
correlations on trial are the sines of even steps.

Sources: H.D. Patterson and R. Thompson, Biometrika 58 (1971) 545-554; S.J. Prais and C.B. Winsten, Cowles Commission
Discussion Paper 383 (1954), on whitening; J.O. Berger and R.-Y. Yang, Econometric Theory 10 (1994) 461-482, on the
prior.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.special import stdtrit

CORRELATIONS = np.sin(np.linspace(0.0, np.arcsin(0.99), 100))  # on trial
ROUNDING = np.finfo(float).eps
LEAST = 1e-300  # in place of zero, where a fit leaves nothing


@dataclass(frozen=True)
class Series:
    """Points in their order, whose errors are correlated with those of their neighbours.

    `values` (n,) are y_s, `common` (n,) is x_s, whose coefficient all series share, and `own` (n, k) are T_s.
    """

    values: np.ndarray
    common: np.ndarray
    own: np.ndarray


@dataclass(frozen=True)
class Shared:
    """The coefficient that series share: its estimate, and half its 95 % interval.

    The `likelihood` is the logarithm of the largest one, to compare fits with other terms.
    """

    value: float
    half: float
    likelihood: float


def shared_coefficient(series: Sequence[Series]) -> Shared:
    """Return the coefficient c that the series share; they have more points than coefficients.

    With whitening the sums of products that the normal equations need are quadratics in the correlation, so that all
    correlations are tried at once. The errors count for no less than the rounding of the values.
    """
    terms = np.column_stack([np.concatenate([one.common for one in series]), block_diag(*(one.own for one in series))])
    values = np.concatenate([one.values for one in series])
    count, width = terms.shape
    begin = np.linalg.lstsq(terms, values, rcond=None)[0]
    columns = np.column_stack([values - terms @ begin, terms])
    parts = np.split(columns, np.cumsum([len(one.values) for one in series])[:-1])
    rho = CORRELATIONS[:, None, None]
    lagged, inner = sum(part[1:].T @ part[:-1] for part in parts), sum(part[1:-1].T @ part[1:-1] for part in parts)
    products = columns.T @ columns - rho * (lagged + lagged.T) + rho**2 * inner
    information, along = products[:, 1:, 1:], products[:, 1:, :1]
    solution = np.linalg.solve(information, along)
    least = max((ROUNDING * float(np.linalg.norm(values))) ** 2, LEAST)
    power = np.maximum(products[:, 0, 0] - np.sum(along * solution, axis=(1, 2)), least)
    whitened = 0.5 * len(parts) * np.log(1 - CORRELATIONS**2)
    restricted = whitened - 0.5 * ((count - width) * np.log(power) + np.linalg.slogdet(information)[1])
    weight = np.exp(restricted - restricted.max())
    weight /= weight.sum()
    change = float(weight @ solution[:, 0, 0])
    variance = np.linalg.inv(information)[:, 0, 0] * power / (count - width) + (solution[:, 0, 0] - change) ** 2
    half = float(stdtrit(count - width, 0.975) * np.sqrt(weight @ variance))
    return Shared(float(begin[0]) + change, half, float((whitened - 0.5 * count * np.log(power / count)).max()))
