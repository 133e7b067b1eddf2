"""Parts of a `Calibration`, in physical units and by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from palpate.inference.calibration_result import Estimate
from palpate.inference.coordinates import Coordinates
from palpate.inference.explanation import Fit
from palpate.inference.intervals import Intervals
from palpate.inference.measures import error_measures
from palpate.inference.noise import NoiseModel
from palpate.inference.observation import Observation
from palpate.inference.problem import Problem


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
    """Return estimates and intervals in their units, by name.

    None is identified in a failing fit, nor one whose interval ends at a limit of the law.

    Parameters
    ----------
    fit
        The fit of the base model.
    found
        Intervals and flags of its coordinates.
    explained
        Whether the fit explains the recordings.
    """
    coordinates, outside = fit.coordinates, np.abs(fit.z - 0.5) > 0.5 + 1e-9
    low, high = coordinates.named(found.lower), coordinates.named(found.upper)
    ended = coordinates.at_limit(found.lower) | coordinates.at_limit(found.upper)
    places = {name: k for k, name in enumerate(coordinates.names)}
    found_estimates = {}
    for name, value in coordinates.named(fit.z).items():
        free, k = name in places, places.get(name, 0)
        flags = [bool(free and flag[k]) for flag in (found.identified & explained & ~ended, found.at_bound, outside)]
        found_estimates[name] = Estimate(value, low[name], high[name], flags[0], not free, *flags[1:])
    return found_estimates


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
            f"sigma_{item.quantity.unit}": float(noise.sigma[k]) / problem.nm.get(name, 1.0),
            "correlation": float(noise.autocorrelation[k]),
            "site_scatter": float(np.sqrt(noise.variances["site"])) * abs(item.quantity.share),
            "replicates": len(item.response),
        }
    return rows
