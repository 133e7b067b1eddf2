"""What a diagnosis works on: mean curves, and a forward model that any set of mechanisms can join.

Coordinates of an explanation are those of the free material parameters, followed by those of its mechanisms'
amplitudes, see `palpate.inference.coordinates`. All curves are in nm: a load that answers to a displacement counts as
the depth that it amounts to (`palpate.study.quantity`), so that noise, drift and misfit of all conditions are of one
kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from palpate.configuration.study_file import Condition, Study
from palpate.errors import PalpateError
from palpate.inference.coordinates import Coordinates
from palpate.inference.forward import Curves, FiniteElements, Forward
from palpate.inference.observation import Observation
from palpate.mechanisms import MECHANISMS, Scale
from palpate.solver.variation import added_by_instrument
from palpate.study.protocol import LOAD

Explanation = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Problem:
    """One set of recordings of a study.

    Parameters
    ----------
    conditions
        The conditions that take part.
    observed
        The recordings of every condition [nm].
    forward
        The base model under the conditions that take part.
    scale
        Size of the study.
    nm
        Where the load answers: so many nm count as one mN.
    """

    conditions: tuple[Condition, ...]
    observed: Mapping[str, Observation]
    forward: Forward
    scale: Scale
    nm: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, study: Study, observed: Mapping[str, Observation], scale: Scale) -> Problem:
        """Put a study's calibrate conditions together."""
        conditions = tuple(condition for condition in study.conditions if condition.role == "calibrate")
        nm = {name: item.quantity.nm for name, item in observed.items() if item.quantity.unit != "nm"}
        seen = {name: _as_depth(item) for name, item in observed.items()}
        return cls(conditions, seen, FiniteElements.of(study, [c.name for c in conditions]), scale, nm)

    @property
    def names(self) -> list[str]:
        """Names of the conditions that take part."""
        return [condition.name for condition in self.conditions]

    @cached_property
    def mean(self) -> np.ndarray:
        """Mean depth of all conditions, one after the other [nm]."""
        return np.concatenate([self.observed[name].mean for name in self.names])

    @property
    def shares(self) -> dict[str, float]:
        """Relative change of each condition's curves where the same body is deeper under the same load."""
        return {name: item.quantity.share for name, item in self.observed.items()}

    @property
    def repeated(self) -> list[int]:
        """Numbers of the conditions that were tested more than once."""
        return [k for k, name in enumerate(self.names) if len(self.observed[name].response) > 1]

    @property
    def replicated(self) -> bool:
        """Whether most conditions were tested more than once, so that replicates fix the noise of all."""
        return 2 * len(self.repeated) > len(self.conditions)

    def split(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Return the part of `values` (n_all, ...) that belongs to each condition."""
        ends = np.cumsum([len(self.observed[name].time) for name in self.names])
        return dict(zip(self.names, np.split(values, ends[:-1]), strict=True))

    def stacked(self, parts: Curves) -> np.ndarray:
        """Return simulated curves or slopes (n_points, ...) of all conditions, one after the other, in nm."""
        return np.concatenate([self.nm.get(name, 1.0) * parts[name] for name in self.names])

    def model(self, explanation: Explanation) -> Forward:
        """Return the forward model with mechanisms, whose points are coordinates of the explanation."""
        if not explanation:
            return self.forward
        return self.forward.joined([MECHANISMS[key] for key in explanation], self.scale)

    def coordinates(self, explanation: Explanation) -> Coordinates:
        """Return the coordinates of an explanation."""
        return self.model(explanation).coordinates

    @property
    def material(self) -> int:
        """Number of free material parameters, whose coordinates come first."""
        return len(self.forward.coordinates.free)

    def places(self, explanation: Explanation) -> dict[str, list[int]]:
        """Return the places of each mechanism's coordinates."""
        found: dict[str, list[int]] = {key: [] for key in explanation}
        for place, name in enumerate(self.coordinates(explanation).names):
            if place >= self.material:
                found[name.split(".")[0]].append(place)
        return found

    def without(self, explanation: Explanation, z: np.ndarray, key: str) -> tuple[Explanation, np.ndarray]:
        """Return an explanation with one mechanism less, and what is left of its coordinates z (k,)."""
        places = self.places(explanation)[key]
        return tuple(other for other in explanation if other != key), np.delete(z, places)

    def amplitudes(self, explanation: Explanation, z: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates z (k,)."""
        return self.model(explanation).amplitudes(z)

    def amplitude(self, explanation: Explanation, z: np.ndarray, key: str) -> tuple[float, float]:
        """Return the value of the only parameter of a mechanism at coordinates z (k,), and its slope by its own."""
        (place,) = self.places(explanation)[key]
        coordinate = self.coordinates(explanation).free[place]
        return float(coordinate.physical(z[place])), coordinate.slope(float(z[place]))

    def felt(self, key: str) -> bool:
        """Return whether the body feels a mechanism under any of the conditions."""
        return any(MECHANISMS[key].felt_under(condition.protocol.control) for condition in self.conditions)

    def unit_effect(self, key: str, condition: Condition) -> np.ndarray:
        """Return what a mechanism that varies adds for one unit of its parameter (n_points,) [nm].

        Where a displacement is prescribed it is the slope at the middle material; of a condition that takes no part,
        what the same depth amounts to at the largest load.
        """
        protocol, one = condition.protocol, {p.name: 1.0 for p in MECHANISMS[key].parameters}
        if protocol.control == LOAD:
            return added_by_instrument({key: one}, protocol)
        if condition.name in self.names:
            return self._unit_loads[key][condition.name]
        none = np.zeros(len(protocol.sample_time))
        return -MECHANISMS[key].record(protocol.sample_time, none, none, one)

    def own_values(self, key: str) -> np.ndarray:
        """Return what one unit of a mechanism that varies adds under each condition (n_all, n_conditions) [nm]."""
        return block_diag(*(self.unit_effect(key, condition)[:, None] for condition in self.conditions))

    @cached_property
    def _unit_loads(self) -> dict[str, dict[str, np.ndarray]]:
        """Slopes by each mechanism that varies, where it does nothing, under a prescribed displacement [nm]."""
        found = {}
        for key in [key for key, mechanism in MECHANISMS.items() if mechanism.varies]:
            coordinate = self.coordinates((key,)).free[-1]
            z = np.append(np.full(self.material, 0.5), coordinate.scaled(0.0))
            (outcome,) = self.model((key,)).tangents([z])
            if isinstance(outcome, str):
                raise PalpateError(f"{key}, {outcome}")
            slopes = self.split(self.stacked(outcome[1])[:, -1] / coordinate.slope(float(z[-1])))
            found[key] = slopes
        return found

    def largest(self, key: str) -> float:
        """Return the largest plausible value, of either sign, of a mechanism that has a single parameter."""
        (plausible,) = MECHANISMS[key].searched(self.scale).values()
        return max(abs(plausible.lower), abs(plausible.upper))


def _as_depth(item: Observation) -> Observation:
    """Return what was measured in one condition in nm."""
    return replace(item, response=item.quantity.nm * item.response, quantity=replace(item.quantity, unit="nm", nm=1.0))
