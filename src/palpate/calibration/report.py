"""Parts of a `Calibration`, in physical units and by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from palpate.calibration.genetic import Evolution
from palpate.calibration.intervals import Intervals
from palpate.calibration.measures import error_measures
from palpate.calibration.noise import Noise
from palpate.calibration.observation import Observation
from palpate.calibration.polish import Predictor
from palpate.calibration.result import Estimate
from palpate.calibration.space import Space
from palpate.errors import PalpateError


def predicted(
    surrogates: Mapping[str, Predictor], observations: Mapping[str, Observation], x: np.ndarray
) -> dict[str, np.ndarray]:
    """Surrogate curves at parameters x (1, p) of all observed conditions that have a surrogate."""
    return {name: surrogates[name].predict(x)[0] for name in observations if name in surrogates}


def reached(
    observations: Mapping[str, Observation], confirmed: Mapping[str, np.ndarray], report: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """Return the forward model's curves; what took no part and cannot be simulated is told and left out.

    Raises
    ------
    PalpateError
        When a condition cannot be simulated that took part.
    """
    found = {}
    for name in confirmed:
        try:
            found[name] = confirmed[name]
        except PalpateError as error:
            if name not in observations or observations[name].role == "calibrate":
                raise
            report(f"{name} is not judged: {error}")
    return found


def judged(
    observations: Mapping[str, Observation], curves: Mapping[str, np.ndarray], confirmed: Mapping[str, np.ndarray]
) -> dict[str, dict[str, Any]]:
    """Error table: of the forward model's curve where there is one, else of the surrogate's."""
    table: dict[str, dict[str, Any]] = {}
    for name, observation in observations.items():
        source, curve = ("fe", confirmed[name]) if name in confirmed else ("surrogate", curves.get(name))
        if curve is not None:
            table[name] = error_measures(observation.mean, curve, observation.quantity) | {
                "role": observation.role,
                "curve": source,
            }
    return table


def in_nm(runs: list[dict[str, Any]], observations: Mapping[str, Observation]) -> list[dict[str, Any]]:
    """Return runs of the forward model with the surrogates' errors there as depths, see `palpate.quantity`."""
    told = []
    for run in runs:
        errors = {name: observations[name].quantity.nm * error for name, error in run["surrogate_error"].items()}
        rest = {key: value for key, value in run.items() if key != "surrogate_error"}
        told.append(rest | {"surrogate_error_nm": errors})
    return told


def estimates(space: Space, u: np.ndarray, found: Intervals) -> dict[str, Estimate]:
    """Physical estimates and intervals by name; intervals are cut off at the bounds."""
    low, high = (space.physical(np.clip(u + sign * found.half_width, 0.0, 1.0))[0] for sign in (-1, 1))
    identified, at_bound = np.zeros((2, len(low)), dtype=bool)
    identified[space.free], at_bound[space.free] = found.identified, found.at_bound
    return {
        name: Estimate(value, float(low[i]), float(high[i]), bool(identified[i]), not space.free[i], bool(at_bound[i]))
        for i, (name, value) in enumerate(space.named(u).items())
    }


def named_matrix(space: Space, matrix: np.ndarray) -> dict[str, dict[str, float]]:
    """Matrix (k, k) of the free parameters, by name."""
    names = [name for name, free in zip(space.bounds, space.free, strict=True) if free]
    return {name: dict(zip(names, map(float, row), strict=True)) for name, row in zip(names, matrix, strict=True)}


def described(noise: Noise, observation: Observation) -> dict[str, float]:
    """Noise of a condition for the record."""
    return {
        f"sigma_{observation.quantity.unit}": noise.sigma,
        "correlation": noise.correlation,
        "site_scatter": noise.site_scatter,
        "replicates": len(observation.response),
    }


def front(space: Space, evolution: Evolution, names: list[str]) -> dict[str, dict[str, list[float]]]:
    """Pareto front in physical units."""
    points = space.physical(evolution.points)
    return {
        "parameters": {name: points[:, i].tolist() for i, name in enumerate(space.bounds)},
        "objectives": {name: evolution.objectives[:, i].tolist() for i, name in enumerate(names)},
    }
