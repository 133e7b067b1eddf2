"""The data of a diagnosis: mean curves, and a forward model to which any set of mechanisms can be added.

Coordinates of an explanation are those of the free material parameters, followed by those of its mechanisms'
amplitudes, see `palpate.models.coordinates`. All curves are in nm: other observables than depth are converted to
equivalent depths (`palpate.observables.observable`), so that noise, drift and misfit of all conditions have one unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import block_diag

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation, in_order
from palpate.errors import PalpateError
from palpate.inference.amplitude import Amplitude
from palpate.inference.bulk_likelihood import BulkLikelihood
from palpate.inference.law_structure import Indentation
from palpate.mechanisms import MECHANISMS, Scale
from palpate.models.bulk_model import BulkModel
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.models.finite_elements import FiniteElements
from palpate.models.forward import Curves, Forward
from palpate.models.imprints import Imprint, imprints
from palpate.solver.study_scale import scale_of
from palpate.solver.variation import added_by_instrument, applied_to_body
from palpate.study.indenter import Indenter

Explanation = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Problem:
    """One set of recordings of a study.

    Parameters
    ----------
    conditions
        The conditions that take part.
    recorded
        The recordings of every condition, each in the unit of its quantity.
    forward
        The base model under the conditions that take part.
    scale
        Size of the study.
    tips
        What presses, by the names of tips; one that is not among them is sharp.
    at : ndarray, shape (k,), optional
        Coordinates of the material at which effects on a load are taken, where a displacement is prescribed; by default
        the middle of the ranges.
    bulk, bulk_likelihood
        The law under uniaxial tests of the study, and the likelihood of those that calibrate.
    imprints
        Residual profiles that judge the law.
    """

    conditions: tuple[Condition, ...]
    recorded: Mapping[str, Observation]
    forward: Forward
    scale: Scale
    tips: Mapping[str, Indenter] = field(default_factory=dict)
    at: np.ndarray | None = None
    bulk: BulkModel = field(default_factory=BulkModel)
    bulk_likelihood: BulkLikelihood = field(default_factory=BulkLikelihood)
    imprints: tuple[Imprint, ...] = ()

    @classmethod
    def of(cls, study: Study, recorded: Mapping[str, Observation]) -> Problem:
        """Put those conditions of a study together whose recordings have the role ``calibrate``."""
        study = replace(study, conditions=in_order(study.conditions, recorded))
        conditions = tuple(c for c in study.conditions if c.name in recorded and recorded[c.name].role == "calibrate")
        forward = FiniteElements.of(study, [c.name for c in conditions])
        bulk = BulkModel.of(study)
        likelihood = BulkLikelihood.of(bulk, forward.coordinates, study.calibration.law_error)
        found = cls(conditions, recorded, forward, scale_of(study), {"": study.indenter, **study.tips})
        return replace(found, bulk=bulk, bulk_likelihood=likelihood, imprints=tuple(imprints(study)))

    def at_one_load(self, values: Mapping[str, float], report: Callable[[str], None]) -> Problem:
        """Return the problem with each replicate brought to the load of its condition, with the material's `values`.

        See `palpate.models.own_loads`.
        """
        if not any(item.own for item in self.recorded.values()):
            return self
        return replace(self, recorded=self.forward.at_one_load(self.recorded, values, report))

    @cached_property
    def observed(self) -> dict[str, Observation]:
        """The recordings of every condition [nm]."""
        return {name: item.as_depth() for name, item in self.recorded.items()}

    @cached_property
    def nm(self) -> dict[str, float]:
        """So many nm count as one unit of each condition's response."""
        return {name: item.quantity.nm for name, item in self.recorded.items()}

    @property
    def names(self) -> list[str]:
        """Names of the conditions that take part."""
        return [condition.name for condition in self.conditions]

    @cached_property
    def mean(self) -> np.ndarray:
        """Mean depth of all conditions (n_all,), one after the other [nm]."""
        return np.concatenate([self.observed[name].mean for name in self.names])

    @cached_property
    def indentations(self) -> tuple[Indentation, ...]:
        """What the discrepancy of the law depends on under each condition that takes part."""
        return tuple(self.indentation(condition) for condition in self.conditions)

    def indentation(self, condition: Condition) -> Indentation:
        """Return the same of a condition."""
        tip = self.tips.get(condition.tip)
        tests = [each for each in self.conditions if each.tip == condition.tip]
        if tip is None or not tests:
            return Indentation(condition.protocol, condition.tip, tip is not None and not tip.sharp)
        depths = [float(self.observed[each.name].mean.max()) for each in tests]
        return Indentation.under(condition.tip, tip, condition.protocol, [each.protocol for each in tests], depths)

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
        return np.concatenate([self.nm[name] * parts[name] for name in self.names])

    def responses(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Return stacked curves or slopes (n_all, ...) [nm] of each condition, in the unit of its response."""
        return {name: part / self.nm[name] for name, part in self.split(values).items()}

    def refinement(self, model: Forward, condition: Condition) -> np.ndarray:
        """Return what the last refinement of a model changed (n_points,) [nm], none where that is not known."""
        none = np.zeros(len(condition.protocol.sample_time))
        return self.nm.get(condition.name, 1.0) * model.refinements.get(condition.name, none)

    def refinements(self, model: Forward) -> list[np.ndarray]:
        """Return the same for each condition, a list of (n_points,)."""
        return [self.refinement(model, condition) for condition in self.conditions]

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

    def special_case(
        self, explanation: Explanation, z: np.ndarray, key: str, included: str
    ) -> tuple[Explanation, np.ndarray]:
        """Return an explanation with a mechanism that `key` includes in its place, and its coordinates (k,).

        Parameters
        ----------
        explanation
            Keys of its mechanisms.
        z : ndarray, shape (k,)
            Coordinates.
        key
            Mechanism that is replaced.
        included
            Its special case.
        """
        smaller, rest = self.without(explanation, z, key)
        values, own = self.amplitudes(explanation, z)[key], self.coordinates((included,)).free[self.material :]
        return (*smaller, included), np.append(rest, [each.scaled(values[each.name.split(".")[1]]) for each in own])

    def bulk_departures(self, explanation: Explanation, z: np.ndarray) -> np.ndarray:
        """Return the departures (m,) [standard deviations] of the uniaxial tests that calibrate, at coordinates z (k,).

        A mechanism that changes the law, such as a second Voigt element, changes it there as well.
        """
        if not self.bulk_likelihood.tests:
            return np.empty(0)
        if not explanation:
            values = {**self.bulk.fixed, **self.forward.coordinates.named(z)}
            return self.bulk_likelihood.departures(self.bulk.model, values)
        body = applied_to_body(self.model(explanation).specification(z, self.conditions[0]))
        return self.bulk_likelihood.departures(body.model, body.parameters)

    def amplitudes(self, explanation: Explanation, z: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates z (k,)."""
        return self.model(explanation).amplitudes(z)

    def place(self, explanation: Explanation, name: str) -> int:
        """Return the place of the coordinate of a quantity that is searched, ``key.name``."""
        return self.coordinates(explanation).names.index(name)

    def quantity(self, explanation: Explanation, z: np.ndarray, name: str) -> tuple[float, float]:
        """Return the value of such a quantity at coordinates z (k,), and its derivative by its coordinate."""
        place = self.place(explanation, name)
        coordinate = self.coordinates(explanation).free[place]
        return float(coordinate.physical(z[place])), coordinate.slope(float(z[place]))

    def is_simulated(self, key: str) -> bool:
        """Return whether a mechanism's effect must be simulated under any of the conditions."""
        return any(MECHANISMS[key].is_simulated_under(condition.protocol.control) for condition in self.conditions)

    def typical(self, key: str) -> tuple[Amplitude, ...]:
        """Return the amplitudes of a mechanism that only adds to the depth, its other parameters mid-range."""
        mechanism = MECHANISMS[key]
        ranges = mechanism.searched(self.scale).items()
        return Amplitude.of(key, {n: float(Coordinate.of_amplitude(mechanism, n, r).physical(0.5)) for n, r in ranges})

    def unit_effect(self, amplitude: Amplitude, condition: Condition) -> np.ndarray:
        """Return what one unit of an amplitude adds (n_points,) [nm], to the mean recorded depth where it follows it.

        Where a displacement is prescribed it is the derivative at the material of `at`; for a condition that takes no
        part, the equivalent depth at the largest load.
        """
        protocol = condition.protocol
        if condition.observable.adds_instrument:
            item = self.observed.get(condition.name)
            depth = np.zeros(len(protocol.sample_time)) if item is None else item.mean
            return added_by_instrument({amplitude.key: amplitude.parameters(1.0)}, protocol, depth, condition.order)
        if condition.name in self.names:
            return _unit_loads(self, amplitude)[condition.name]
        return -amplitude.added(protocol.sample_time, np.zeros(len(protocol.sample_time)))

    def unit_effects(self, amplitude: Amplitude) -> np.ndarray:
        """Return what one unit of an amplitude adds under all conditions (n_all,) [nm]."""
        return np.concatenate([self.unit_effect(amplitude, condition) for condition in self.conditions])

    def effects_by_test(self, key: str) -> np.ndarray:
        """Return what one unit of each amplitude of a mechanism adds in each condition alone (n_all, k) [nm]."""
        columns = [self.split(self.unit_effects(amplitude)) for amplitude in self.typical(key)]
        return block_diag(*(np.column_stack([of[name] for of in columns]) for name in self.names))

    def largest(self, amplitude: Amplitude) -> float:
        """Return the largest plausible value of an amplitude, of either sign."""
        plausible = MECHANISMS[amplitude.key].searched(self.scale)[amplitude.name]
        return max(abs(plausible.lower), abs(plausible.upper))

    def typical_size(self, amplitude: Amplitude) -> float:
        """Return the typical value of an amplitude, of either sign."""
        plausible = MECHANISMS[amplitude.key].searched(self.scale)[amplitude.name]
        return 0.1 * self.largest(amplitude) if plausible.typical is None else plausible.typical


@lru_cache(maxsize=64)
def _unit_loads(problem: Problem, amplitude: Amplitude) -> dict[str, np.ndarray]:
    """Return derivatives by an amplitude, at zero, under a prescribed displacement [nm]."""
    explanation, none = (amplitude.key,), amplitude.parameters(0.0)
    coordinates = problem.coordinates(explanation).free[problem.material :]
    beside = [float(coordinate.scaled(none[coordinate.name.split(".")[1]])) for coordinate in coordinates]
    material = np.full(problem.material, 0.5) if problem.at is None else problem.at
    z = np.concatenate([material, beside])
    (outcome,) = problem.model(explanation).tangents([z])
    if isinstance(outcome, str):
        raise PalpateError(f"{amplitude.key}, {outcome}")
    slope = problem.quantity(explanation, z, str(amplitude))[1]
    return problem.split(problem.stacked(outcome[1])[:, problem.place(explanation, str(amplitude))] / slope)
