r"""Parts of a `CalibrationOutcome`: estimates with 95 % intervals, errors and noise, in physical units and by name.

Intervals are quantiles of the posterior, see `palpate.inference.posterior`: of curves to second order about the
estimate, with the noise of the recordings, the error of the solver, the discrepancy of the law, and the prior of
`palpate.models.coordinates`.

A parameter is identified when its estimate lies within its range, and its interval is narrower than half of that and
does not end at a limit of the law: an interval that fills most of the range says little more than the range did.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palpate.data.measures import error_measures
from palpate.data.noise import NoiseModel
from palpate.data.observation import Observation
from palpate.inference.bulk_prediction import predicted
from palpate.inference.calibration_result import Estimate
from palpate.inference.explanation import Fit
from palpate.inference.posterior import posterior_draws
from palpate.inference.problem import Problem
from palpate.models.coordinates import Coordinates

WIDEST_IDENTIFIED = 0.5  # of the range
CONFIDENCE = 0.95  # of the intervals


@dataclass(frozen=True, eq=False)
class Intervals:
    """Uncertainty of the coordinates of a fit.

    Attributes
    ----------
    lower, upper : ndarray, shape (k,)
        Ends of the intervals.
    correlation : ndarray, shape (k, k)
        Of the posterior.
    draws : ndarray, shape (m, k)
        From the posterior.
    """

    lower: np.ndarray
    upper: np.ndarray
    correlation: np.ndarray
    draws: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))


def intervals(fit: Fit) -> Intervals:
    """Return the intervals about a fit."""
    draws = posterior_draws(fit)
    lower, upper = np.quantile(draws, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], axis=0)
    return Intervals(np.minimum(lower, fit.z), np.maximum(upper, fit.z), np.atleast_2d(np.corrcoef(draws.T)), draws)


def condition_errors(
    observations: Mapping[str, Observation], curves: Mapping[str, np.ndarray]
) -> dict[str, dict[str, Any]]:
    """Return the errors of simulated curves (n_points,), by condition."""
    return {
        name: error_measures(observations[name].mean, curve, observations[name].quantity)
        | {"role": observations[name].role}
        for name, curve in curves.items()
    }


def estimates(fit: Fit, found: Intervals, explained: bool) -> dict[str, Estimate]:
    """Return estimates and intervals in their units, by name; none is identified in a fit that does not explain.

    Parameters
    ----------
    fit
        The fit of the base model.
    found
        Intervals of its coordinates.
    explained
        Whether the fit explains the recordings.
    """
    coordinates = fit.coordinates
    low, high = coordinates.named(found.lower), coordinates.named(found.upper)
    at_bound, outside = coordinates.at_limit(fit.z), np.abs(fit.z - 0.5) > 0.5 + 1e-9
    identified = determined(coordinates, found.lower, found.upper) & explained & ~outside
    flags = dict(zip(coordinates.names, zip(identified, at_bound, outside, strict=True), strict=True))
    estimated = {}
    for name, value in coordinates.named(fit.z).items():
        identifies, bound, beyond = map(bool, flags.get(name, (False, False, False)))
        estimated[name] = Estimate(value, low[name], high[name], identifies, name not in flags, bound, beyond)
    return estimated


def determined(coordinates: Coordinates, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return which coordinates (k,) recordings determine, by the ends of their intervals (k,)."""
    ended = coordinates.at_limit(lower) | coordinates.at_limit(upper)
    return (upper - lower < WIDEST_IDENTIFIED) & ~ended


def law_discrepancy(fit: Fit) -> dict[str, float] | None:
    """Return `share`, `lower` and `upper` of what the law leaves at its best parameters [-], if that is allowed for.

    Median and 95 % interval of a root mean square without noise, as a share of the depth.
    """
    if fit.errors.law is None:
        return None
    share, lower, upper = fit.law_share([0.5, 0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2])
    return {"share": float(share), "lower": float(lower), "upper": float(upper)}


def bulk_predictions(fit: Fit, found: Intervals) -> dict[str, dict[str, Any]]:
    """Return what a fit predicts of each uniaxial test, see `palpate.inference.bulk_prediction.predicted`."""
    draws = [fit.coordinates.named(z) for z in found.draws] if fit.problem.bulk.tests else []
    return predicted(fit.problem.bulk, fit.coordinates.named(fit.z), draws, CONFIDENCE)


def named_matrix(coordinates: Coordinates, matrix: np.ndarray) -> dict[str, dict[str, float]]:
    """Return a matrix (k, k) of the free parameters, by name."""
    names = coordinates.names
    return {name: dict(zip(names, map(float, row), strict=True)) for name, row in zip(names, matrix, strict=True)}


def noise_table(problem: Problem, noise: NoiseModel) -> dict[str, dict[str, float]]:
    """Return the noise of each condition that takes part, in the unit of its response."""
    rows = {}
    for k, name in enumerate(problem.names):
        item = problem.recorded[name]
        rows[name] = {
            item.quantity.observable.column("sigma"): float(noise.sigma[k]) / problem.nm[name],
            "correlation": float(noise.autocorrelation[k]),
            "site_scatter": float(np.sqrt(noise.variances["site"])) * abs(item.quantity.share),
            "replicates": len(item.response),
        }
    return rows
