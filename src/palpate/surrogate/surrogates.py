"""Surrogates of several conditions over one box of parameters, whose coordinates are those of the unit cube."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from palpate.errors import InputError


class Predictor(Protocol):
    """What a surrogate must offer."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Return the curves (n, n_points) at parameters (n, p)."""


@dataclass(frozen=True, eq=False)
class Surrogates:
    """Surrogates under some conditions.

    Parameters
    ----------
    predictors
        By condition; columns in the order of `bounds`.
    bounds
        (lower, upper) of each parameter in its unit: its range, and its limits; equal bounds hold it.

    Raises
    ------
    InputError
        When bounds are in the wrong order or hold every parameter.
    """

    predictors: Mapping[str, Predictor]
    bounds: Mapping[str, tuple[float, float]]

    def __post_init__(self) -> None:
        for name, (lower, upper) in self.bounds.items():
            if not lower <= upper:
                problem = f"bounds of {name} are {lower!r} to {upper!r}"
                raise InputError(problem, remedy="put the smaller first", place=name)
        if not self.free:
            remedy = "give one of them at least two levels"
            raise InputError("every parameter is held", remedy=remedy, place="parameters")

    @cached_property
    def free(self) -> list[str]:
        """Names of the parameters that are not held, in the order of the coordinates."""
        return [name for name, (lower, upper) in self.bounds.items() if lower < upper]

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """Return the predictors' columns (n, p), in the parameters' units, at points (n, k) of the unit cube."""
        lower, upper = np.array(list(self.bounds.values())).T
        whole = np.zeros((len(points), len(lower)))
        whole[:, [name in self.free for name in self.bounds]] = points
        return np.clip(lower + whole * (upper - lower), lower, upper)

    def named(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameters by name at a point (k,)."""
        return dict(zip(self.bounds, map(float, self.parameters(point[None])[0]), strict=True))

    def at(self, points: np.ndarray) -> list[dict[str, np.ndarray]]:
        """Return the curve (n_points,) of each condition at each of the points (n, k)."""
        x = self.parameters(points)
        predicted = {name: model.predict(x) for name, model in self.predictors.items()}
        return [{name: curves[n] for name, curves in predicted.items()} for n in range(len(points))]
