r"""95 % intervals of the parameters of a fit, and whether the recordings fix them.

They are quantiles of the posterior, see `palpate.inference.posterior`: of curves to second order about the estimate,
with the noise of the recordings, the error of the solver, and the prior of `palpate.inference.coordinates`. Where the
model does not explain the recordings to these errors, chi-square is divided by its ratio to the degrees of freedom
(R. T. Birge, Phys. Rev. 40 (1932) 207-227), so that the intervals are wider by the root of that.

A parameter is identified when its interval is narrower than half its range and does not end at a limit of the law: an
interval that fills most of the range says little more than the range did.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.inference.explanation import Fit
from palpate.inference.posterior import posterior_draws

WIDEST_IDENTIFIED = 0.5  # of the range
CONFIDENCE = 0.95  # of the intervals


@dataclass(frozen=True, eq=False)
class Intervals:
    """Uncertainty of the coordinates of a fit.

    Attributes
    ----------
    lower, upper : ndarray, shape (k,)
        Ends of the intervals.
    at_bound : ndarray of bool, shape (k,)
        Whether the estimate lies on a limit of the law.
    identified : ndarray of bool, shape (k,)
        Whether the interval is narrow enough; `palpate.inference.estimates.estimates` asks where it ends, too.
    correlation : ndarray, shape (k, k)
        Of the posterior.
    misfit_ratio
        Chi-square per degree of freedom; well above 1 the model does not explain the recordings to their noise.
    """

    lower: np.ndarray
    upper: np.ndarray
    at_bound: np.ndarray
    identified: np.ndarray
    correlation: np.ndarray
    misfit_ratio: float


def intervals(fit: Fit, rng: np.random.Generator) -> Intervals:
    """Return the intervals about a fit; `rng` draws from its posterior."""
    draws = posterior_draws(fit, rng)
    lower, upper = np.quantile(draws, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], axis=0)
    lower, upper = np.minimum(lower, fit.z), np.maximum(upper, fit.z)
    at_bound = fit.coordinates.at_limit(fit.z)
    identified = upper - lower < WIDEST_IDENTIFIED
    return Intervals(lower, upper, at_bound, identified, np.atleast_2d(np.corrcoef(draws.T)), fit.misfit_ratio)
