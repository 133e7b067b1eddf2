"""Parts of a `Calibration`, in physical units and by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from palpate.inference.calibration_result import Estimate
from palpate.inference.coordinates import Coordinates
from palpate.inference.forward import Forward, under_each
from palpate.inference.genetic import Evolution
from palpate.inference.intervals import Intervals
from palpate.inference.measures import error_measures
from palpate.inference.observation import Observation
from palpate.inference.recording_noise import Noise
from palpate.inference.surrogate_fit import Predictor
from palpate.inference.surrogate_space import Space


def predicted(
    surrogates: Mapping[str, Predictor], observations: Mapping[str, Observation], x: np.ndarray
) -> dict[str, np.ndarray]:
    """Surrogate curves at parameters x (1, p) of all observed conditions that have a surrogate."""
    return {name: surrogates[name].predict(x)[0] for name in observations if name in surrogates}


def simulated(
    forward: Forward, names: Sequence[str], u: np.ndarray, report: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """Return the forward model's curves at coordinates u (k,) of conditions that took no part; failures are told."""
    found: dict[str, np.ndarray] = {}
    for name, curve in under_each(forward, names, u).items():
        if isinstance(curve, str):
            report(f"{name} is not judged: {curve.removeprefix(f'{name}: ')}")
        else:
            found[name] = curve
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


def estimates(
    coordinates: Space | Coordinates, u: np.ndarray, found: Intervals, explained: bool
) -> dict[str, Estimate]:
    """Physical estimates and intervals by name, these within what is plausible.

    None is identified in a failing fit, nor one whose interval ends where it is cut off.
    """
    beyond = np.where(np.isinf(found.half_width), 0.0, float(isinstance(coordinates, Coordinates)))
    first, last = np.minimum(u, 0.0) - beyond, np.maximum(u, 1.0) + beyond
    if isinstance(coordinates, Coordinates):
        first, last = np.maximum(first, coordinates.walls[0]), np.minimum(last, coordinates.walls[1])
    ends = np.clip(u - found.half_width, first, last), np.clip(u + found.half_width, first, last)
    low, high = map(coordinates.named, ends)
    ended = (ends[0] <= first) | (ends[1] >= last)
    outside = np.abs(u - 0.5) > 0.5 + 1e-9
    places = {name: k for k, name in enumerate(coordinates.names)}
    told = {}
    for name, value in coordinates.named(u).items():
        free, k = name in places, places.get(name, 0)
        flags = [bool(free and flag[k]) for flag in (found.identified & explained & ~ended, found.at_bound, outside)]
        told[name] = Estimate(value, low[name], high[name], flags[0], not free, *flags[1:])
    return told


def named_matrix(coordinates: Space | Coordinates, matrix: np.ndarray) -> dict[str, dict[str, float]]:
    """Matrix (k, k) of the free parameters, by name."""
    names = coordinates.names
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
