"""Surrogates of several conditions over one box of parameters, in the coordinates of a search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from palpate.errors import InputError
from palpate.inference.coordinates import Coordinate, Coordinates


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

    @cached_property
    def coordinates(self) -> Coordinates:
        """Of the free parameters, linear in them."""
        free = [Coordinate(name, *pair, *pair) for name, pair in self.bounds.items() if pair[0] < pair[1]]
        return Coordinates(free, {name: lower for name, (lower, upper) in self.bounds.items() if lower == upper})

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """Return the predictors' columns (n, p), in the parameters' units, at points (n, k)."""
        free = dict(zip(self.coordinates.names, zip(self.coordinates.free, points.T, strict=True), strict=True))
        columns = {name: coordinate.physical(column) for name, (coordinate, column) in free.items()}
        held = {name: np.full(len(points), value) for name, value in self.coordinates.held.items()}
        return np.column_stack([(columns | held)[name] for name in self.bounds])

    def at(self, points: np.ndarray) -> list[dict[str, np.ndarray]]:
        """Return the curve (n_points,) of each condition at each of the points (n, k)."""
        x = self.parameters(points)
        predicted = {name: model.predict(x) for name, model in self.predictors.items()}
        return [{name: curves[n] for name, curves in predicted.items()} for n in range(len(points))]
