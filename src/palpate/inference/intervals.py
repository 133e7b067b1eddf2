r"""95 % intervals of the calibrated parameters, and whether the data determine them.

With the whitened Jacobian J in coordinates scaled to the bounds, the information of the data is J^T J. The prior, that
each parameter lies within its bounds, is approximated by a Gaussian of the same variance, 1/12. The covariance is P =
(J^T J + 12 I)^-1, and for the parameter's own interval its own prior is removed again,

    v_k = 1 / (1 / P_kk - 12),

so an interval rests on the data and on the bounds of the *other* parameters: one that the data do not determine widens
the intervals of those it is correlated with only as far as its bounds allow. The interval is estimate +- t sqrt(v_k),
with Student's t for Satterthwaite's degrees of freedom, since the scatter between sites rests on a handful of
recordings; v_k is multiplied by chi^2 per degree of freedom where that exceeds 1 (Birge's ratio).

A parameter is identified when its interval is narrower than half the range between its bounds and its estimate does
not lie on one of them: an interval that fills most of the range says little more than the range did. On a bound the
least sum of squares lies outside, the quadratic approximation does not hold, and the interval is the whole range. An
estimate on surrogates ends at the bounds of their snapshots; one on the finite elements at the limits of the law.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from palpate.inference.observation import Observation
from palpate.inference.on_finite_elements import Linearised
from palpate.inference.recording_noise import Noise
from palpate.inference.surrogate_fit import WeightedFit

PRIOR_INFORMATION = 12.0
WIDEST_IDENTIFIED = 0.5


@dataclass(frozen=True, eq=False)
class Intervals:
    """Uncertainty of the free parameters, in coordinates scaled to the bounds.

    Attributes
    ----------
    half_width : ndarray, shape (k,)
        t sqrt(v_k), before truncation at the bounds; infinite where the data give no information.
    at_bound, identified : ndarray of bool, shape (k,)
        See the module.
    correlation : ndarray, shape (k, k)
        Of P.
    misfit_ratio
        chi^2 per degree of freedom; well above 1 the model does not explain the recordings to their noise.
    """

    half_width: np.ndarray
    at_bound: np.ndarray
    identified: np.ndarray
    correlation: np.ndarray
    misfit_ratio: float


def intervals(
    fit: WeightedFit | Linearised,
    u: np.ndarray,
    noise: Mapping[str, Noise],
    observations: Mapping[str, Observation],
    confidence: float = 0.95,
) -> Intervals:
    """Intervals about the estimate u (k,) of a weighted fit.

    Parameters
    ----------
    fit
        The least-squares problem around the estimate.
    u : ndarray, shape (k,)
        The estimate.
    noise
        Noise of each condition.
    observations
        Recordings of each condition.
    confidence
        Probability that an interval contains the truth.
    """
    jacobian = fit.jacobian(u)
    size, k = jacobian.shape
    information = jacobian.T @ jacobian
    covariance = np.linalg.inv(information + PRIOR_INFORMATION * np.eye(k))
    spread = np.sqrt(np.diag(covariance))
    own = 1.0 / np.diag(covariance) - PRIOR_INFORMATION
    ratio = float(np.sum(fit.residual(u) ** 2)) / max(size - k, 1)
    with np.errstate(divide="ignore", over="ignore"):
        variance = max(ratio, 1.0) / np.maximum(own, 0.0)
        half_width = student.ppf(0.5 + confidence / 2, freedom(fit, jacobian, covariance, noise, observations))
        half_width = half_width * np.sqrt(variance)
    at_bound = fit.at_bound(u)
    half_width = np.where(at_bound, np.inf, half_width)
    correlation = covariance / np.outer(spread, spread)
    return Intervals(half_width, at_bound, (2 * half_width < WIDEST_IDENTIFIED) & ~at_bound, correlation, ratio)


def freedom(
    fit: WeightedFit | Linearised,
    jacobian: np.ndarray,
    covariance: np.ndarray,
    noise: Mapping[str, Noise],
    observations: Mapping[str, Observation],
) -> np.ndarray:
    """Satterthwaite's degrees of freedom (k,): the share of the site scatter in each variance decides.

    Parameters
    ----------
    fit
        The least-squares problem around the estimate.
    jacobian : ndarray, shape (n, k)
        Whitened derivatives.
    covariance : ndarray, shape (k, k)
        Of the coordinates.
    noise, observations
        Noise and recordings of each condition.
    """
    site = np.zeros(len(covariance))
    for name in fit.measured:
        tau, count = noise[name].site_scatter, len(observations[name].response)
        factor = {n: tau / np.sqrt(count) * mean * (n == name) for n, mean in fit.measured.items()}
        site += (covariance @ jacobian.T @ fit.whiten(factor)) ** 2
    total = np.einsum("ij,jk,ki->i", covariance, jacobian.T @ jacobian, covariance)
    share = np.divide(site, total, out=np.zeros_like(site), where=total > 0).clip(0.0, 1.0 - 1e-9)
    return 1.0 / (share**2 / max(n.site_freedom for n in noise.values()) + (1.0 - share) ** 2 / len(jacobian))
