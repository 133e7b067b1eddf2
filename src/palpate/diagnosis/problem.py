"""What a diagnosis works on: mean curves, their noise, and a forward model that any set of mechanisms can join.

Coordinates of an explanation are those of the free material parameters, scaled to their bounds, followed by the search
coordinates of its mechanisms, all within [0, 1].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from palpate.calibration import Observation
from palpate.calibration.space import Space
from palpate.config import Condition, Study
from palpate.diagnosis.as_depths import Scaled, effects_in_nm, observed_depth
from palpate.diagnosis.design import amplitudes, mechanism_dimensions, middle
from palpate.diagnosis.effects import Effect, Effects
from palpate.mechanisms import MECHANISMS, Scale
from palpate.protocol import LOAD
from palpate.surrogate import PODRBF

Explanation = tuple[str, ...]
HALF = 0.05  # of a search range, over which the slope by a value of a recording is taken to either side of none


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
    interior
        Error (n_points,) of each condition's surrogate in the middle of the grid [nm]. Leave-one-out errors do not see
        how the curves bend between the levels of a parameter that has only two.
    nm
        Where the load answers: so many nm count as one mN, see `palpate.diagnosis.as_depths`. All else is in nm.
    """

    conditions: tuple[Condition, ...]
    observed: Mapping[str, Observation]
    space: Space
    base: Mapping[str, PODRBF | Scaled]
    effects: Mapping[str, Mapping[str, Effect]]
    refinement: Mapping[str, np.ndarray]
    scale: Scale
    interior: Mapping[str, np.ndarray] = field(default_factory=dict)
    nm: Mapping[str, float] = field(default_factory=dict)

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
        nm = {name: item.quantity.nm for name, item in observed.items() if item.quantity.unit != "nm"}
        models = {name: Scaled(model, nm[name]) if name in nm else model for name, model in base.items()}
        learnt = {name: effects_in_nm(found, nm.get(name, 1.0)) for name, found in effects.items()}
        factors = {name: found.refinement for name, found in effects.items()}
        centre = np.array([list(middle(study).values())])
        interior = {
            name: nm.get(name, 1.0) * found.middle - models[name].evaluate(centre)[0] for name, found in effects.items()
        }
        seen = {name: observed_depth(item) for name, item in observed.items()}
        return cls(conditions, seen, Space(bounds), models, learnt, factors, scale, interior, nm)

    @property
    def mean(self) -> np.ndarray:
        """Mean depth of all conditions, one after the other [nm]."""
        return np.concatenate([self.observed[condition.name].mean for condition in self.conditions])

    @property
    def shares(self) -> dict[str, float]:
        """Relative change of each condition's curves where the same body is deeper under the same load."""
        return {name: item.quantity.share for name, item in self.observed.items()}

    @property
    def repeated(self) -> list[int]:
        """Numbers of the conditions that were tested more than once."""
        return [k for k, condition in enumerate(self.conditions) if len(self.observed[condition.name].response) > 1]

    @property
    def replicated(self) -> bool:
        """Whether most conditions were tested more than once, so that replicates fix the noise of all."""
        return 2 * len(self.repeated) > len(self.conditions)

    def mesh_factor(self, condition: Condition) -> np.ndarray | float:
        """Return what takes the depth of a condition to the fine mesh (n_points,); the mean where it took no part."""
        if condition.name in self.refinement:
            return self.refinement[condition.name]
        return float(np.mean([np.mean(self.refinement[c.name]) for c in self.conditions]))

    def split(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Return the part of `values` (n_all, ...) that belongs to each condition."""
        ends = np.cumsum([len(self.observed[condition.name].time) for condition in self.conditions])
        return dict(zip((c.name for c in self.conditions), np.split(values, ends[:-1]), strict=True))

    def dimensions(self, explanation: Explanation) -> int:
        """Return the number of coordinates."""
        return self.space.dimensions + sum(mechanism_dimensions(MECHANISMS[key], self.scale) for key in explanation)

    def parts(self, explanation: Explanation, z: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Divide coordinates z (..., k) into those of the material and those of each mechanism."""
        u, rest, own = z[..., : self.space.dimensions], z[..., self.space.dimensions :], {}
        for key in explanation:
            count = mechanism_dimensions(MECHANISMS[key], self.scale)
            own[key], rest = rest[..., :count], rest[..., count:]
        return u, own

    def amplitudes(self, explanation: Explanation, z: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism."""
        own = self.parts(explanation, z)[1]
        return {key: amplitudes(MECHANISMS[key], self.scale, x) for key, x in own.items()}

    def amplitude(self, explanation: Explanation, z: np.ndarray, key: str) -> tuple[float, float]:
        """Return the value of the only parameter of a mechanism at coordinates z (k,), and its slope by its own."""
        (place,) = self.parts(explanation, np.arange(len(z)))[1][key]
        (name,) = (parameter.name for parameter in MECHANISMS[key].parameters)
        ends = [np.where(np.arange(len(z)) == place, end, z) for end in (0.0, 1.0)]
        value, low, high = (self.amplitudes(explanation, at)[key][name] for at in (z, *ends))
        return value, high - low

    def recorded_effect(self, key: str, condition: Condition, values: Mapping[str, float]) -> np.ndarray:
        """Return what a mechanism adds to the depth that the instrument writes (n_points,) [nm].

        Nothing where a displacement is prescribed, in which the body feels it.
        """
        protocol = condition.protocol
        none = np.zeros(len(protocol.sample_time))
        if protocol.control != LOAD:
            return none
        return MECHANISMS[key].record(protocol.sample_time, protocol.sample_load, none, values)

    def recorded(self, explanation: Explanation, condition: Condition, z: np.ndarray) -> np.ndarray:
        """Return what the instrument adds to the depth under a condition (n_points,), at coordinates z (k,) [nm]."""
        values = self.amplitudes(explanation, z)
        effects = [self.recorded_effect(key, condition, values[key]) for key in explanation]
        return np.sum([np.zeros(len(condition.protocol.sample_time)), *effects], axis=0)

    def acts_on_body(self, explanation: Explanation) -> np.ndarray:
        """Return which coordinates (k,) change the body's depth; curves are linear in the others, the instrument's."""
        acts = np.ones(self.dimensions(explanation), dtype=bool)
        for key, places in self.parts(explanation, np.arange(len(acts)))[1].items():
            acts[places] = any(MECHANISMS[key].learnt_under(c.protocol.control) for c in self.conditions)
        return acts

    def slope_by_instrument(self, explanation: Explanation) -> np.ndarray:
        """Return the slope (n_all, k) of the curves by the coordinates that act on the instrument alone, else zero."""
        instrument = ~self.acts_on_body(explanation)
        none, *ends = np.vstack([np.zeros(len(instrument)), np.diag(1.0 * instrument)])
        return np.concatenate(
            [
                np.transpose([self.recorded(explanation, condition, z) for z in ends])
                - self.recorded(explanation, condition, none)[:, None]
                for condition in self.conditions
            ]
        )

    def unit_effect(self, key: str, condition: Condition) -> np.ndarray:
        """Return what a mechanism that varies adds for one unit of its parameter (n_points,) [nm].

        Where a displacement is prescribed it is the slope of what was learnt, for the middle material; of a condition
        of which nothing was learnt, what the same depth amounts to at the largest load.
        """
        protocol, one = condition.protocol, {p.name: 1.0 for p in MECHANISMS[key].parameters}
        if protocol.control == LOAD:
            return self.recorded_effect(key, condition, one)
        if key not in self.effects.get(condition.name, {}):
            none = np.zeros(len(protocol.sample_time))
            return -MECHANISMS[key].record(protocol.sample_time, none, none, one)
        (searched,) = MECHANISMS[key].searched(self.scale).values()
        width = searched.upper - searched.lower
        places = np.array([[-HALF], [HALF]]) - searched.lower / width
        material = np.full((2, self.space.dimensions), 0.5)
        points = np.column_stack([self.space.physical(material)[:, self.space.free], places])
        below, above = self.effects[condition.name][key].predict(points)
        return (above - below) / (2.0 * HALF * width)

    def largest(self, key: str) -> float:
        """Return the largest plausible value, of either sign, of a mechanism that has a single parameter."""
        (plausible,) = MECHANISMS[key].searched(self.scale).values()
        return max(abs(plausible.lower), abs(plausible.upper))

    def effect(self, key: str, u: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the effect of one mechanism on all conditions (m, n_all).

        Parameters
        ----------
        u : ndarray, shape (p,) or (m, p)
            Coordinates of the material, of one for all or of each.
        x : ndarray, shape (k,) or (m, k)
            Coordinates of the mechanism.
        """
        x = np.atleast_2d(x)
        material = np.broadcast_to(self.space.physical(u), (len(x), len(self.space.bounds)))
        points = np.column_stack([material[:, self.space.free], x])
        curves = []
        for condition in self.conditions:
            curve = np.zeros((len(x), len(condition.protocol.sample_time)))
            control = condition.protocol.control
            if MECHANISMS[key].derived_under(control):
                plain = self.base[condition.name].evaluate(material)
                curve += self._derived(key, condition, plain, x) - plain
            if MECHANISMS[key].learnt_under(control):
                curve += self.effects[condition.name][key].predict(points)
            curves.append(curve)
        return np.concatenate(curves, axis=1)

    def _derived(self, key: str, condition: Condition, curves: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return what a mechanism at coordinates x (m, k) makes of `curves` (m, n_points), as far as that follows."""
        mechanism, protocol = MECHANISMS[key], condition.protocol
        time, drive = protocol.sample_time, protocol.sample_drive
        return np.array(
            [
                mechanism.on_curve(time, drive, curve, amplitudes(mechanism, self.scale, row))
                for curve, row in zip(curves, x, strict=True)
            ]
        )

    def curves(self, explanation: Explanation, z: np.ndarray) -> np.ndarray:
        """Return the surrogates' curves of all conditions (m, n_all) at coordinates z (m, k) [nm].

        What was learnt of the mechanisms is added; what can be derived is made of the sum, last what the instrument
        adds.
        """
        u, own = self.parts(explanation, z)
        material, whole = self.space.physical(u), []
        for condition in self.conditions:
            control = condition.protocol.control
            derived = [key for key in own if MECHANISMS[key].derived_under(control)]
            curve = self.base[condition.name].evaluate(material)
            for key in [key for key in own if MECHANISMS[key].learnt_under(control)]:
                points = np.column_stack([material[:, self.space.free], own[key]])
                curve = curve + self.effects[condition.name][key].predict(points)
            curve = curve * self.mesh_factor(condition)
            for key in sorted(derived, key=lambda key: MECHANISMS[key].shortcut is None):
                curve = self._derived(key, condition, curve, own[key])
            whole.append(curve)
        return np.concatenate(whole, axis=1)

    def jacobian(self, explanation: Explanation, z: np.ndarray, step: float = 1e-4) -> np.ndarray:
        """Return the slope (n_all, k) of the curves by the coordinates z (k,), by differences.

        Where a curve has a kink, as where a lag passes a sample before which nothing was loaded, it is the slope of the
        flatter side: that of the mean would be one of a wall, and keep a search from leaving along the flat side.
        """
        steps = step * np.eye(len(z))
        here, ahead, behind = np.split(self.curves(explanation, np.vstack([z, z + steps, z - steps])), [1, 1 + len(z)])
        ahead, behind = (ahead - here) / step, (here - behind) / step
        flatter = np.where(np.abs(ahead) < np.abs(behind), ahead, behind)
        smooth = np.abs(ahead - behind) <= np.abs(flatter)
        return np.where(smooth, 0.5 * (ahead + behind), flatter).T
