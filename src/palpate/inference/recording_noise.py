r"""Noise of the recordings, from their replicates.

Replicate r of a condition is h_r = (1 + s_r) h + n_r: one factor s_r for the site (standard deviation tau, common to
all conditions) and point noise n_r of standard deviation sigma whose correlation falls as rho^|i - j| with the lag
(AR(1)). So the mean of R replicates has the covariance

    C = (sigma^2 rho^|i - j| + tau^2 h h^T) / R

Under displacement control h is the load, and tau the corresponding scatter of the load, see
`palpate.study.quantity.Quantity.share`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, toeplitz
from scipy.optimize import brentq

from palpate.inference.observation import Observation

FLOOR = 1e-5
MAX_RHO = 0.99
GRID = 0.005  # of the depth: largest error of grid convergence, of yielding bodies
SHAPE = 1.0 / 3.0  # of a law's discrepancy, which varies along a test
FADES_OVER = 0.1  # of a test


@dataclass(frozen=True)
class Noise:
    """Noise of one recording of a condition.

    Parameters
    ----------
    sigma
        Standard deviation of the point noise, in the unit of the response.
    correlation
        Correlation rho between neighbouring points.
    site_scatter
        Standard deviation tau of the site factor [-].
    site_freedom
        Degrees of freedom on which tau rests; infinite when it is assumed.
    """

    sigma: float
    correlation: float
    site_scatter: float
    site_freedom: float

    def points(self, n: int) -> np.ndarray:
        """Covariance (n, n) of the point noise of one recording [nm^2]."""
        return self.sigma**2 * toeplitz(self.correlation ** np.arange(n))

    def mean_covariance(self, curve: np.ndarray, replicates: int) -> np.ndarray:
        """Covariance C (n_points, n_points) of the mean of the replicates [nm^2], about a simulated curve h [nm].

        With the recorded mean as h its noise would count as depth and draw the fit to smaller depths (G. D'Agostini,
        Nucl. Instrum. Methods A 346 (1994) 306-311).
        """
        site = self.site_scatter**2 * np.outer(curve, curve)
        return (self.points(len(curve)) + site) / replicates


def point_noise(deviation: np.ndarray, mean: np.ndarray, freedom: int) -> tuple[float, float, float]:
    """Split deviations (k, n_points) from the mean curve into site factors and point noise.

    The part along the mean curve is taken for the site factors. Point noise has such a part too: sigma and rho are
    those whose AR(1) noise, less its part along the mean, has the variance and lag-one correlation that is left.

    Parameters
    ----------
    freedom
        Number of independent curves among the deviations.

    Returns
    -------
    sigma, rho, squares
        Sigma [nm], at least 1e-5 of the largest depth so that recordings without noise do no harm; rho; and
        the sum of squared site factors less what the point noise adds to it.
    """
    along = mean / np.linalg.norm(mean)
    site = deviation @ along
    rest = deviation - np.outer(site, along)
    total, lagged = float(np.sum(rest**2)), float(np.sum(rest[:, 1:] * rest[:, :-1]))

    def left(rho: float) -> np.ndarray:
        """Covariance of unit AR(1) noise less its part along the mean."""
        projection = np.eye(len(mean)) - np.outer(along, along)
        return projection @ toeplitz(rho ** np.arange(len(mean))) @ projection

    def correlation_difference(rho: float) -> float:
        """By how much the lag-one correlation that rho would leave exceeds the one found."""
        matrix = left(rho)
        return float(np.trace(matrix, offset=1) / np.trace(matrix) - lagged / total)

    floor = FLOOR * float(np.abs(mean).max())
    if total <= freedom * len(mean) * floor**2:
        return floor, 0.0, float(site @ site) / float(mean @ mean)
    low, high = correlation_difference(0.0) >= 0, correlation_difference(MAX_RHO) <= 0
    rho = 0.0 if low else MAX_RHO if high else float(brentq(correlation_difference, 0.0, MAX_RHO))
    sigma = float(np.sqrt(total / freedom / np.trace(left(rho))))
    by_noise = freedom * sigma**2 * float(along @ toeplitz(rho ** np.arange(len(mean))) @ along)
    return sigma, rho, (float(site @ site) - by_noise) / float(mean @ mean)


def replicate_noise(observations: Mapping[str, Observation]) -> dict[str, Noise]:
    """Noise of every condition that has replicates; tau is pooled over them."""
    points: dict[str, tuple[float, float]] = {}
    squares, freedom = 0.0, 0
    for name, observation in observations.items():
        independent = len(observation.response) - 1
        if independent:
            sigma, rho, site = point_noise(observation.response - observation.mean, observation.mean, independent)
            points[name] = sigma, rho
            squares, freedom = squares + site / observation.quantity.share**2, freedom + independent
    tau = np.sqrt(max(squares, 0.0) / freedom) if freedom else 0.0
    return {
        name: Noise(sigma, rho, float(tau) * abs(observations[name].quantity.share), freedom)
        for name, (sigma, rho) in points.items()
    }


def complete_noise(
    observations: Mapping[str, Observation], fitted: Mapping[str, np.ndarray], site_scatter: float
) -> dict[str, Noise]:
    """Noise of every condition; those without replicates take it from the residual of a fit.

    Parameters
    ----------
    fitted
        A fitted curve (n_points,) for each condition [nm]. Its misfit, less a common factor, counts as noise.
    site_scatter
        Assumed tau where no condition has replicates.
    """
    known = replicate_noise(observations)
    shares = {name: abs(observation.quantity.share) for name, observation in observations.items()}
    tau, freedom = next(
        ((noise.site_scatter / shares[name], noise.site_freedom) for name, noise in known.items()),
        (site_scatter, np.inf),
    )
    for name, observation in observations.items():
        if name not in known:
            sigma, rho, _ = point_noise(observation.response - fitted[name], observation.mean, 1)
            known[name] = Noise(sigma, rho, tau * shares[name], freedom)
    return {name: known[name] for name in observations}


def model_covariance(
    curves: Mapping[str, np.ndarray], relative_error: float, shares: Mapping[str, float] | None = None
) -> np.ndarray:
    """Covariance (n, n) of the forward model's error, all conditions one after the other [nm^2].

    A mesh whose rings grow by a constant ratio makes the same relative error at every depth: all curves differ by one
    common factor, of standard deviation `relative_error`. The default of 0.003 covers what ``accuracy: standard``
    differs from the depth extrapolated in the mesh ratio: up to 0.2 % of the depth in elastic and creeping bodies; up
    to `GRID` where yielding prevails, which a study may state.

    What a study states beyond `GRID` is a discrepancy of the law (M. C. Kennedy and A. O'Hagan, J. R. Statist. Soc. B
    63 (2001) 425-464). It has a shape as well: a third of it varies along each test, as a random function of the
    fraction of the test whose correlation falls to 1/e over a tenth; half of its variance is common to all conditions.

    Under displacement control the relative error is multiplied by `shares`, see
    `palpate.study.quantity.Quantity.share`.
    """
    shares = shares or {}
    depth = np.concatenate([shares.get(name, 1.0) * curve for name, curve in curves.items()])
    beyond = max(relative_error**2 - GRID**2, 0.0)
    relative = np.full((len(depth), len(depth)), relative_error**2)
    if beyond:
        place = np.concatenate([np.arange(len(curve)) / len(curve) for curve in curves.values()])
        same = block_diag(*(np.ones((len(curve), len(curve))) for curve in curves.values()))
        fades = np.exp(-np.abs(np.subtract.outer(place, place)) / FADES_OVER)
        relative += SHAPE**2 * beyond * fades * (1.0 + same) / 2.0
    return relative * np.outer(depth, depth)
