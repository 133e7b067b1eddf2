"""Surrogates in place of the finite elements, as a `palpate.inference.forward.Forward`, within their bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.configuration.study_file import Condition
from palpate.errors import InputError
from palpate.inference.coordinates import Coordinate, Coordinates
from palpate.inference.forward import Curves
from palpate.inference.genetic_stage import Predictor
from palpate.inference.observation import Observation
from palpate.mechanisms import Mechanism, Scale
from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Surrogates:
    """Surrogates under some conditions.

    Parameters
    ----------
    predictors
        By condition; columns in the order of `bounds`.
    bounds
        (lower, upper) of each parameter in its unit: its range, and its limits; equal bounds hold it.
    """

    predictors: Mapping[str, Predictor]
    bounds: Mapping[str, tuple[float, float]]

    @property
    def coordinates(self) -> Coordinates:
        """Of the free parameters, linear in them."""
        free = [Coordinate(name, *pair, *pair) for name, pair in self.bounds.items() if pair[0] < pair[1]]
        return Coordinates(free, {name: lower for name, (lower, upper) in self.bounds.items() if lower == upper})

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

    def of_record(self, u: np.ndarray) -> Surrogates:
        """See `Forward`: these."""
        return self

    def thinned(self) -> tuple[Surrogates, Mapping[str, np.ndarray]]:
        """See `Forward`: none is cheaper."""
        middle = self.coordinates.named(np.full(len(self.coordinates.free), 0.5))
        keep = {name: np.ones(len(curve), dtype=bool) for name, curve in self._at(middle).items()}
        return self, keep

    def together(self, u: np.ndarray) -> int:
        """See `Forward`."""
        return 4

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """See `Forward`: no mechanism acts."""
        return {}

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`."""
        return [self._at(self.coordinates.named(u)) for u in points]

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`."""
        found: list[tuple[Curves, Curves] | str] = []
        free = [list(self.bounds).index(name) for name in self.coordinates.names]
        for u in points:
            named = self.coordinates.named(u)
            x = np.array([named[name] for name in self.bounds])
            extent = np.array([each.slope(place) for each, place in zip(self.coordinates.free, u, strict=True)])
            slopes = {name: model.jacobian(x)[:, free] * extent for name, model in self.predictors.items()}
            found.append((self._at(named), slopes))
        return found

    def _at(self, named: Mapping[str, float]) -> dict[str, np.ndarray]:
        x = np.array([[named[name] for name in self.bounds]])
        return {name: model.predict(x)[0] for name, model in self.predictors.items()}
