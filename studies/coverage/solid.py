"""The base model of the coverage study in closed form: a Burgers solid under a cone, as a forward model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.models.forward import Curves
from studies.coverage.creep import burgers, depth

RANGES = {
    "youngs_modulus": (1.5, 6.0),  # GPa
    "steady_coefficient": (1e-4, 4e-3),  # 1/(GPa s)
    "transient_coefficient": (0.03, 0.5),  # 1/GPa
    "retardation_time": (2.0, 200.0),  # s
}
MATERIAL = Coordinates([Coordinate(n, *ends, 1e-9, np.inf, logarithmic=True) for n, ends in RANGES.items()], {})
STEP = 1e-4  # of a range, over which derivatives are differenced


@dataclass(frozen=True, eq=False)
class BurgersSolid:
    """A Burgers solid under some conditions, as `palpate.models.forward.Forward`; no mechanism joins it.

    Parameters
    ----------
    conditions
    keep
        Samples that are kept, by condition; by default all.
    """

    conditions: tuple[Condition, ...]
    keep: Mapping[str, np.ndarray] = field(default_factory=dict)
    coordinates: Coordinates = MATERIAL

    def under(self, names: Sequence[str]) -> BurgersSolid:
        """Return the model under other conditions."""
        return replace(self, conditions=tuple(c for c in self.conditions if c.name in names))

    def joined(self, mechanisms: Sequence[object], scale: object) -> BurgersSolid:
        """Return the model: a calibration adds no mechanism."""
        return self

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of mechanisms: none."""
        return {}

    @property
    def refinements(self) -> Mapping[str, np.ndarray]:
        """What a refinement changed: there is no mesh."""
        return {}

    def reanchored(self, u: np.ndarray) -> BurgersSolid:
        """Return the most accurate model, which is this one."""
        return self

    def refined(self, u: np.ndarray) -> None:
        """Return the model of finer meshes: there is none."""

    def extrapolated(self, u: np.ndarray) -> None:
        """Return finer meshes: there are none."""

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """Return what was observed: all replicates have one load."""
        return dict(observed)

    def points_per_batch(self, u: np.ndarray) -> int:
        """Return how many points are computed together."""
        return 4

    def thinned(self) -> tuple[BurgersSolid, Mapping[str, np.ndarray]]:
        """Return the model with every third sample."""
        keep = {c.name: np.arange(len(c.protocol.sample_time)) % 3 == 2 for c in self.conditions}
        return replace(self, keep=keep), keep

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return the depth (n_points,) under each condition [nm] at points (k,)."""
        return [self._curves(u) for u in points]

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """Return the depths, and their central differences (n_points, k)."""
        found: list[tuple[Curves, Curves] | str] = []
        for u in points:
            ends = [(self._curves(u + step), self._curves(u - step)) for step in STEP * np.eye(len(u))]
            slopes = {
                c.name: np.stack([(a[c.name] - b[c.name]) / (2.0 * STEP) for a, b in ends], axis=1)
                for c in self.conditions
            }
            found.append((self._curves(u), slopes))
        return found

    def _curves(self, u: np.ndarray) -> dict[str, np.ndarray]:
        compliance, found = burgers(**self.coordinates.named(u)), {}
        for condition in self.conditions:
            curve = depth(compliance, condition.protocol)
            found[condition.name] = curve[self.keep[condition.name]] if self.keep else curve
        return found
