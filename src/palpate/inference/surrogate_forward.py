"""Surrogates in place of the finite elements, as a `palpate.inference.forward.Forward`, within their bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from palpate.configuration.study_file import Condition
from palpate.errors import InputError
from palpate.inference.coordinates import Coordinate, Coordinates
from palpate.inference.forward import Curves
from palpate.inference.observation import Observation
from palpate.mechanisms import Mechanism, Scale
from palpate.study.specification import Specification


class Predictor(Protocol):
    """What a surrogate must offer."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Return the curves (n, n_points) at parameters (n, p)."""

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return the slope (n_points, p) of the curve at parameters (p,)."""


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
        places = {each.name: k for k, each in enumerate(self.coordinates.free)}
        columns = [
            self.coordinates.free[places[name]].physical(points[:, places[name]])
            if name in places
            else np.full(len(points), self.coordinates.held[name])
            for name in self.bounds
        ]
        return np.column_stack(columns)

    def under(self, names: Sequence[str]) -> Surrogates:
        """See `Forward`."""
        return replace(self, predictors={name: self.predictors[name] for name in names})

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """Raise `InputError`: surrogates know one load alone."""
        raise InputError("surrogates know one load for each condition", remedy="fit on the finite elements")

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> Surrogates:
        """Raise `InputError`: surrogates know the base model alone."""
        raise InputError("surrogates know no mechanisms", remedy="diagnose on the finite elements")

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Raise `InputError`: surrogates simulate nothing."""
        raise InputError("surrogates simulate nothing", remedy="ask the finite elements")

    @property
    def refinements(self) -> dict[str, np.ndarray]:
        """Return nothing: what surrogates err by is not known from the mesh."""
        return {}

    def of_record(self, u: np.ndarray) -> Surrogates:
        """See `Forward`: these."""
        return self

    def extrapolated(self, u: np.ndarray) -> None:
        """See `Forward`: none is known."""

    def thinned(self) -> tuple[Surrogates, Mapping[str, np.ndarray]]:
        """See `Forward`: none is cheaper."""
        (middle,) = self.at(np.full((1, len(self.coordinates.free)), 0.5))
        keep = {name: np.ones(len(curve), dtype=bool) for name, curve in middle.items()}
        return self, keep

    def together(self, u: np.ndarray) -> int:
        """See `Forward`."""
        return 4

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """See `Forward`: no mechanism acts."""
        return {}

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`; none fails."""
        return list(self.at(np.array(points)))

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`; none fails."""
        free = [list(self.bounds).index(name) for name in self.coordinates.names]
        found: list[tuple[Curves, Curves] | str] = []
        for u, x, curves in zip(points, self.parameters(np.array(points)), self.at(np.array(points)), strict=True):
            extent = np.array([each.slope(place) for each, place in zip(self.coordinates.free, u, strict=True)])
            slopes = {name: model.jacobian(x)[:, free] * extent for name, model in self.predictors.items()}
            found.append((curves, slopes))
        return found

    def at(self, points: np.ndarray) -> list[dict[str, np.ndarray]]:
        """Return the curve (n_points,) of each condition at each of the points (n, k)."""
        x = self.parameters(points)
        predicted = {name: model.predict(x) for name, model in self.predictors.items()}
        return [{name: curves[n] for name, curves in predicted.items()} for n in range(len(points))]
