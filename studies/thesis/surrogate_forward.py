"""Surrogates in place of the finite elements, as a `palpate.models.forward.Forward`, within their bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.errors import InputError
from palpate.mechanisms import Mechanism, Scale
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.models.forward import Curves
from palpate.study.specification import Specification
from palpate.surrogate.surrogates import Surrogates


class DifferentiablePredictor(Protocol):
    """What a surrogate must offer for least squares."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Return the curves (n, n_points) at parameters (n, p)."""

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return the slope (n_points, p) of the curve at parameters (p,)."""


@dataclass(frozen=True, eq=False)
class SurrogateForward(Surrogates):
    """Surrogates under some conditions; they know the base model alone, each condition under one load."""

    predictors: Mapping[str, DifferentiablePredictor]

    @cached_property
    def coordinates(self) -> Coordinates:
        """See `Forward`: linear in the parameters, within their bounds."""
        free = [Coordinate(name, *self.bounds[name], *self.bounds[name]) for name in self.free]
        return Coordinates(free, {name: lower for name, (lower, upper) in self.bounds.items() if lower == upper})

    def under(self, names: Sequence[str]) -> SurrogateForward:
        """See `Forward`."""
        return replace(self, predictors={name: self.predictors[name] for name in names})

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """Raise `InputError`: surrogates know one load alone."""
        raise InputError("surrogates know one load for each condition", remedy="fit on the finite elements")

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> SurrogateForward:
        """Raise `InputError`: surrogates know the base model alone."""
        raise InputError("surrogates know no mechanisms", remedy="diagnose on the finite elements")

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Raise `InputError`: surrogates simulate nothing."""
        raise InputError("surrogates simulate nothing", remedy="ask the finite elements")

    @property
    def refinements(self) -> dict[str, np.ndarray]:
        """Return nothing: the error of a surrogate is not known from the mesh."""
        return {}

    def reanchored(self, u: np.ndarray) -> SurrogateForward:
        """See `Forward`: these."""
        return self

    def refined(self, u: np.ndarray) -> None:
        """See `Forward`: none is known."""

    def extrapolated(self, u: np.ndarray) -> None:
        """See `Forward`: none is known."""

    def consistent(self, u: np.ndarray, curves: Curves, slopes: Curves) -> SurrogateForward:
        """See `Forward`: none is needed."""
        return self

    def thinned(self) -> tuple[SurrogateForward, Mapping[str, np.ndarray]]:
        """See `Forward`: none is cheaper."""
        (middle,) = self.at(np.full((1, len(self.free)), 0.5))
        return self, {name: np.ones(len(curve), dtype=bool) for name, curve in middle.items()}

    def points_per_batch(self, u: np.ndarray) -> int:
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
        free = [list(self.bounds).index(name) for name in self.free]
        found: list[tuple[Curves, Curves] | str] = []
        for u, x, curves in zip(points, self.parameters(np.array(points)), self.at(np.array(points)), strict=True):
            extent = np.array([each.slope(place) for each, place in zip(self.coordinates.free, u, strict=True)])
            slopes = {name: model.jacobian(x)[:, free] * extent for name, model in self.predictors.items()}
            found.append((curves, slopes))
        return found
