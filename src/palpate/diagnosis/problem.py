"""What a diagnosis works on: mean curves, their noise, and a forward model that any set of mechanisms can join.

Coordinates of an explanation are those of the free material parameters, scaled to their bounds, followed by the search
coordinates of its mechanisms, all within [0, 1].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palpate.calibration import Observation
from palpate.calibration.space import Space
from palpate.config import Condition, Study
from palpate.diagnosis.design import amplitudes, mechanism_dimensions
from palpate.diagnosis.effects import Effect, Effects
from palpate.mechanisms import MECHANISMS, Scale
from palpate.surrogate import PODRBF

Explanation = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Problem:
    """One set of recordings of a study.

    Parameters
    ----------
    conditions
        The conditions that take part.
    observed
        Their recordings.
    space
        The material parameters.
    base
        Surrogate of the base model for each condition.
    effects
        Effects of the mechanisms that act on the body, for each condition.
    refinement
        Factor (n_points,) for each condition that takes a simulated depth to the fine mesh.
    scale
        Size of the study.
    """

    conditions: tuple[Condition, ...]
    observed: Mapping[str, Observation]
    space: Space
    base: Mapping[str, PODRBF]
    effects: Mapping[str, Mapping[str, Effect]]
    refinement: Mapping[str, np.ndarray]
    scale: Scale

    @classmethod
    def of(
        cls,
        study: Study,
        observed: Mapping[str, Observation],
        base: Mapping[str, PODRBF],
        effects: Mapping[str, Effects],
        scale: Scale,
    ) -> Problem:
        """Put a study's calibrate conditions together."""
        conditions = tuple(condition for condition in study.conditions if condition.role == "calibrate")
        bounds = {name: (min(levels), max(levels)) for name, levels in study.levels.items()}
        learnt = {name: found.mechanisms for name, found in effects.items()}
        factors = {name: found.refinement for name, found in effects.items()}
        return cls(conditions, observed, Space(bounds), base, learnt, factors, scale)

    @property
    def mean(self) -> np.ndarray:
        """Mean depth of all conditions, one after the other [nm]."""
        return np.concatenate([self.observed[condition.name].mean for condition in self.conditions])

    def to_fine_mesh(self, condition: Condition, depth: np.ndarray) -> np.ndarray:
        """Return a simulated curve as the fine mesh would give it; by the mean factor where there is none."""
        known = self.refinement.get(condition.name)
        return depth * (known if known is not None else float(np.mean([f.mean() for f in self.refinement.values()])))

    def split(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Return the part of `values` (n_all, ...) that belongs to each condition."""
        ends = np.cumsum([len(self.observed[condition.name].time) for condition in self.conditions])
        return dict(zip((c.name for c in self.conditions), np.split(values, ends[:-1]), strict=True))

    def dimensions(self, explanation: Explanation) -> int:
        """Return the number of coordinates."""
        return self.space.dimensions + sum(mechanism_dimensions(MECHANISMS[key], self.scale) for key in explanation)

    def parts(self, explanation: Explanation, z: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Divide coordinates into those of the material and those of each mechanism."""
        u, rest, own = z[: self.space.dimensions], z[self.space.dimensions :], {}
        for key in explanation:
            count = mechanism_dimensions(MECHANISMS[key], self.scale)
            own[key], rest = rest[:count], rest[count:]
        return u, own

    def amplitudes(self, explanation: Explanation, z: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism."""
        own = self.parts(explanation, z)[1]
        return {key: amplitudes(MECHANISMS[key], self.scale, x) for key, x in own.items()}

    def recorded_effect(self, key: str, condition: Condition, values: Mapping[str, float]) -> np.ndarray:
        """Return what a mechanism adds to the depth that the instrument writes (n_points,) [nm]."""
        protocol = condition.protocol
        none = np.zeros(len(protocol.sample_time))
        return MECHANISMS[key].record(protocol.sample_time, protocol.sample_load, none, values)

    def effect(self, key: str, u: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the effect of one mechanism on all conditions (m, n_all) at material u and coordinates x (m, k)."""
        x = np.atleast_2d(x)
        material = self.space.physical(u)
        curves = []
        for condition in self.conditions:
            if MECHANISMS[key].needs_learning:
                points = np.column_stack([np.tile(material[:, self.space.free], (len(x), 1)), x])
                curves.append(self.effects[condition.name][key].predict(points))
            else:
                curves.append(self._derived_effect(key, condition, material, x))
        return np.concatenate(curves, axis=1)

    def _derived_effect(self, key: str, condition: Condition, material: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the effect (m, n_points) that follows from the base model's curve."""
        mechanism, protocol = MECHANISMS[key], condition.protocol
        plain = self.base[condition.name].predict(material)[0]
        return np.array(
            [
                mechanism.on_curve(
                    protocol.sample_time, protocol.sample_load, plain, amplitudes(mechanism, self.scale, row)
                )
                - plain
                for row in x
            ]
        )

    def curve(self, explanation: Explanation, z: np.ndarray) -> np.ndarray:
        """Return the surrogates' curves of all conditions (n_all,) [nm]."""
        u, own = self.parts(explanation, z)
        x = self.space.physical(u)
        total = np.concatenate([self.base[c.name].predict(x)[0] * self.refinement[c.name] for c in self.conditions])
        for key, coordinates in own.items():
            total = total + self.effect(key, u, coordinates)[0]
        return total

    def jacobian(self, explanation: Explanation, z: np.ndarray, step: float = 1e-4) -> np.ndarray:
        """Return the slope (n_all, k) of `curve` by the coordinates, by central differences."""
        u, own = self.parts(explanation, z)
        free, extent = self.space.free, self.space.extent
        physical = self.space.physical(u)[0]
        base = [
            self.base[c.name].jacobian(physical)[:, free] * self.refinement[c.name][:, None] for c in self.conditions
        ]
        slopes = [np.concatenate(base) * extent[free]]
        for key, x in own.items():
            slopes[0] = slopes[0] + self._material_slope(key, u, x)
            ahead, behind = np.split(
                self.effect(key, u, np.vstack([x + step * np.eye(len(x)), x - step * np.eye(len(x))])), 2
            )
            slopes.append((ahead - behind).T / (2 * step))
        return np.column_stack(slopes)

    def _material_slope(self, key: str, u: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the slope (n_all, p) by the material of an effect that was learnt; others hardly have one."""
        if not MECHANISMS[key].needs_learning:
            return np.zeros((len(self.mean), len(u)))
        point = np.concatenate([self.space.physical(u)[0][self.space.free], x])
        slopes = []
        for condition in self.conditions:
            effect = self.effects[condition.name][key]
            slopes.append(effect.spread @ effect.surrogate.jacobian(point)[:, : len(u)])
        return np.concatenate(slopes) * self.space.extent[self.space.free]
