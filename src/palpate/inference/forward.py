"""Forward models: responses under the conditions of a study, and their derivatives, at several parameters at once."""

from __future__ import annotations

import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.configuration.study_file import Condition, Study
from palpate.errors import InputError
from palpate.inference.coordinates import Coordinates
from palpate.inference.extrapolated import Extrapolated
from palpate.inference.observation import Observation
from palpate.inference.own_loads import brought_to_one_load
from palpate.inference.space_mapping import SpaceMapped
from palpate.mechanisms import Mechanism, Scale
from palpate.solver.simulation import differentiated, simulate_batch, together
from palpate.solver.variation import Variation
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification, finer, of_equivalent_cone

Curves = Mapping[str, np.ndarray]
NEAR = 3e-5  # of a range, over which a neighbour is carried along; derivatives err by about as much
THINNING = 4  # one of so many samples is kept where curves of another simulation interpolate the rest
FEWEST = 25  # samples that are kept


class Forward(typing.Protocol):
    """A forward model, which gives a search curves and tangents.

    Both are lists with one entry for each of the points (k,); where a simulation failed, or a body is none that can be
    simulated, it is the reason.
    """

    @property
    def coordinates(self) -> Coordinates:
        """Of the points."""

    def under(self, names: Sequence[str]) -> Forward:
        """Return the model under other conditions."""

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """Return what was observed with each replicate under the load of its condition, by the material's `values`."""

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> Forward:
        """Return the model with mechanisms, whose amplitudes are further coordinates."""

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Return what is simulated at coordinates u (k,) under a condition."""

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates u (k,), by its key."""

    def of_record(self, u: np.ndarray) -> Forward:
        """Return the model of record, the most accurate one, with references near coordinates u (k,)."""

    def refined(self, u: np.ndarray) -> Forward | None:
        """Return the same with the curves of finer meshes at coordinates u (k,) and near by; None without."""

    def extrapolated(self, u: np.ndarray) -> Extrapolated | None:
        """Return finer meshes at coordinates u (k,) where the model of record's derivatives err; None elsewhere."""

    def thinned(self) -> tuple[Forward, Mapping[str, np.ndarray]]:
        """Return a cheaper model with fewer samples, and which of each condition's (n_points,) it keeps."""

    @property
    def refinements(self) -> Mapping[str, np.ndarray]:
        """What the refinement to the model of record changed (n_points,), by condition, where that is known."""

    def together(self, u: np.ndarray) -> int:
        """Return how many points near coordinates u (k,) are simulated in about the time of one."""

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return the response under each condition (n_points,), in nm or mN."""

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """Return the responses (n_points,) and their derivatives by the coordinates (n_points, k)."""


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """The finite elements under some conditions of a study.

    Parameters
    ----------
    study
    conditions
    coordinates
        Of the study's free parameters, and of the amplitudes of mechanisms.
    mechanisms
        That act, too.
    scale
        Size of the study, in which their amplitudes are searched for.
    finer
        By so many degrees the mesh is finer than the study's.
    few_sectors
        Whether its mesh has few sectors.
    """

    study: Study
    conditions: Sequence[Condition]
    coordinates: Coordinates
    mechanisms: Sequence[Mechanism] = ()
    scale: Scale | None = None
    finer: int = 0
    few_sectors: bool = False

    @classmethod
    def of(cls, study: Study, names: Sequence[str]) -> FiniteElements:
        """Return the finite elements under the conditions of these names."""
        return cls(study, [study.condition(name) for name in names], Coordinates.of(study.levels, study.declared))

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """See `Forward`."""
        return brought_to_one_load(self.study, observed, values, report)

    def under(self, names: Sequence[str]) -> FiniteElements:
        """Return the same under other conditions of the study."""
        return replace(self, conditions=[self.study.condition(name) for name in names])

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> FiniteElements:
        """See `Forward`."""
        coordinates = self.coordinates.joined(mechanisms, scale)
        return replace(self, coordinates=coordinates, mechanisms=(*self.mechanisms, *mechanisms), scale=scale)

    def of_record(self, u: np.ndarray) -> SpaceMapped:
        """See `Forward`."""
        return SpaceMapped.of(self, u)

    def refined(self, u: np.ndarray) -> None:
        """See `Forward`: only the model of record is."""

    def extrapolated(self, u: np.ndarray) -> None:
        """See `Forward`: only the model of record is compared with finer meshes."""

    def of_accuracy(self, degrees: int) -> FiniteElements:
        """Return the same on a mesh that is so many degrees finer than the study's, with all of its sectors."""
        return replace(self, finer=degrees, few_sectors=False)

    def thinned(self) -> tuple[FiniteElements, Mapping[str, np.ndarray]]:
        """Return the same with fewer sectors and samples, hence in fewer steps, and which samples are kept."""
        keep = {condition.name: kept(condition.protocol) for condition in self.conditions}
        fewer = [
            replace(c, protocol=replace(c.protocol, sample_time=c.protocol.sample_time[keep[c.name]]))
            for c in self.conditions
        ]
        return replace(self, conditions=fewer, few_sectors=True), keep

    @property
    def refinements(self) -> dict[str, np.ndarray]:
        """See `Forward`: it is not refined."""
        return {}

    def together(self, u: np.ndarray) -> int:
        """See `Forward`: as many as fill the lanes of one run."""
        return together(self._specifications([u]))

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`."""
        try:
            outcomes = simulate_batch(self._specifications(points))
        except InputError as error:
            return [found for u in points for found in self.curves([u])] if points[1:] else [str(error)]
        found: list[Curves | str] = []
        for own in self._by_condition(outcomes):
            failed = [f"{name}: {outcome.reason}" for name, outcome in own.items() if outcome.status != "ok"]
            found.append(failed[0] if failed else {name: outcome.response for name, outcome in own.items()})
        return found

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`."""
        try:
            beside = [row for u in points for row in self._neighbours(u)]
            outcomes = differentiated(self._specifications(points), beside)
        except InputError as error:
            return [found for u in points for found in self.tangents([u])] if points[1:] else [str(error)]
        found: list[tuple[Curves, Curves] | str] = []
        for own in self._by_condition(outcomes):
            failed = [f"{name}: {outcome.reason}" for name, (outcome, _) in own.items() if outcome.status != "ok"]
            failed += [f"{name}: a derivative is unknown" for name, (_, s) in own.items() if not np.isfinite(s).all()]
            curves = {name: outcome.response for name, (outcome, _) in own.items()}
            found.append(failed[0] if failed else (curves, {name: slope for name, (_, slope) in own.items()}))
        return found

    def _neighbours(self, u: np.ndarray) -> list[list[Variation]]:
        """Return the specifications that differ a little from u (k,) in each coordinate, for each condition."""
        largest = self.coordinates.limits[1]
        steps = np.where(u + NEAR <= largest, NEAR, -NEAR)
        moved = [self._specifications([place]) for place in u + np.diag(steps)]
        return [
            [Variation(row[number], step) for row, step in zip(moved, steps, strict=True)]
            for number in range(len(self.conditions))
        ]

    def _by_condition(self, outcomes: Sequence[typing.Any]) -> list[dict[str, typing.Any]]:
        """Return the outcomes of each point by the names of the conditions."""
        names = [condition.name for condition in self.conditions]
        rows = [outcomes[first : first + len(names)] for first in range(0, len(outcomes), len(names))]
        return [dict(zip(names, row, strict=True)) for row in rows]

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """See `Forward`; under the equivalent cone in place of a pyramid."""
        return of_equivalent_cone(self.of_study(u, condition))

    def of_study(self, u: np.ndarray, condition: Condition) -> Specification:
        """Return the study's specification at coordinates u (k,) under a condition."""
        named = self.coordinates.named(u)
        accuracy = finer(self.study.accuracy, self.finer)
        found = self.study.specification({name: named[name] for name in self.study.levels}, condition, accuracy)
        return replace(found, mechanisms=self.amplitudes(u), few_sectors=self.few_sectors)

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """See `Forward`."""
        if self.scale is None:
            return {}
        named, found = self.coordinates.named(u), {}
        for mechanism in self.mechanisms:
            searched = {name: named[f"{mechanism.key}.{name}"] for name in mechanism.searched(self.scale)}
            found[mechanism.key] = dict(mechanism.from_search(searched, self.scale))
        return found

    def _specifications(self, points: Sequence[np.ndarray]) -> list[Specification]:
        return [self.specification(u, condition) for u in points for condition in self.conditions]


def under_each(model: Forward, names: Sequence[str], u: np.ndarray) -> dict[str, np.ndarray | str]:
    """Return the curve (n_points,) at coordinates u (k,) under each condition, or why the model failed there."""
    if not names:
        return {}
    (together,) = model.under(names).curves([u])
    if not isinstance(together, str):
        return dict(together)
    if len(names) == 1:
        return {names[0]: together}
    return {name: curve for each in names for name, curve in under_each(model, [each], u).items()}


def kept(protocol: Protocol) -> np.ndarray:
    """Return which samples (n_points,) suffice for slowly varying curves: a few, corners, the first and last ones.

    Effects change fastest late in unloading, and at the beginning, where the load comes late by as much as it lasts.
    """
    keep = np.isclose(protocol.sample_time[:, None], protocol.knot_time, rtol=1e-9, atol=0.0).any(axis=1)
    every = min(THINNING, max(1, len(keep) // FEWEST))
    keep[::-every] = True
    keep[:3] = keep[-every:] = True
    return keep
