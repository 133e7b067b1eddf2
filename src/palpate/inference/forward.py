"""What answers under the conditions of a study, with its derivatives, at several parameters at once."""

from __future__ import annotations

import typing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.config import Condition, Study
from palpate.inference.coordinates import Coordinates
from palpate.model import sensitivities_batch, simulate_batch
from palpate.protocol import Protocol
from palpate.specification import Specification

Curves = Mapping[str, np.ndarray]
STEP = 0.02  # of a range, over which curves under a pyramid are differenced
THINNING = 3  # of the samples, while a search is on its way


class Forward(typing.Protocol):
    """A forward model, of which a search asks curves and tangents.

    Both are lists with one entry for each of the points (k,), which says why where a simulation failed.
    """

    @property
    def coordinates(self) -> Coordinates:
        """Of the points."""

    def under(self, names: Sequence[str]) -> Forward:
        """Return the model under other conditions."""

    def thinned(self) -> tuple[Forward, Mapping[str, np.ndarray]]:
        """Return a cheaper model with fewer samples, and which of each condition's (n_points,) it keeps."""

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return what answers under each condition (n_points,)."""

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """Return what answers, and its derivatives by the coordinates (n_points, k)."""


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """The finite elements under some conditions of a study.

    Parameters
    ----------
    study
    conditions
    coordinates
        Of the study's free parameters.
    """

    study: Study
    conditions: Sequence[Condition]
    coordinates: Coordinates

    @classmethod
    def of(cls, study: Study, names: Sequence[str]) -> FiniteElements:
        """Return the finite elements under the conditions of these names."""
        return cls(study, [study.condition(name) for name in names], Coordinates.of(study.levels, study.declared))

    def under(self, names: Sequence[str]) -> FiniteElements:
        """Return the same under other conditions of the study."""
        return replace(self, conditions=[self.study.condition(name) for name in names])

    def thinned(self) -> tuple[FiniteElements, Mapping[str, np.ndarray]]:
        """Return the same with fewer samples, hence in fewer steps, and which are kept."""
        keep = {condition.name: kept(condition.protocol) for condition in self.conditions}
        fewer = [
            replace(c, protocol=replace(c.protocol, sample_time=c.protocol.sample_time[keep[c.name]]))
            for c in self.conditions
        ]
        return replace(self, conditions=fewer), keep

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`."""
        outcomes = simulate_batch(self._specifications(points))
        found: list[Curves | str] = []
        for own in self._by_condition(outcomes):
            failed = [f"{name}: {outcome.reason}" for name, outcome in own.items() if outcome.status != "ok"]
            found.append(failed[0] if failed else {name: outcome.response for name, outcome in own.items()})
        return found

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`; under a pyramid by differences over `STEP` of the ranges."""
        if not self.study.indenter.of_revolution:
            return self._differences(points)
        outcomes = sensitivities_batch(self._specifications(points), self.coordinates.names)
        found: list[tuple[Curves, Curves] | str] = []
        for u, own in zip(points, self._by_condition(outcomes), strict=True):
            failed = [f"{name}: {outcome.reason}" for name, (outcome, _) in own.items() if outcome.status != "ok"]
            failed += [f"{name}: a derivative is unknown" for name, (_, s) in own.items() if not np.isfinite(s).all()]
            by = self.coordinates.slopes(u)
            curves = {name: outcome.response for name, (outcome, _) in own.items()}
            found.append(failed[0] if failed else (curves, {name: slope * by for name, (_, slope) in own.items()}))
        return found

    def _differences(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        found: list[tuple[Curves, Curves] | str] = []
        for u in points:
            steps = np.where(u < 0.5, STEP, -STEP)
            outcomes = self.curves([u, *(u + step for step in np.diag(steps))])
            failed = [outcome for outcome in outcomes if isinstance(outcome, str)]
            here, *moved = [outcome for outcome in outcomes if not isinstance(outcome, str)]
            slopes = {
                name: np.column_stack([(there[name] - here[name]) / d for there, d in zip(moved, steps, strict=False)])
                for name in here
            }
            found.append(failed[0] if failed else (here, slopes))
        return found

    def _by_condition(self, outcomes: Sequence[typing.Any]) -> list[dict[str, typing.Any]]:
        """Return the outcomes of each point by the names of the conditions."""
        names = [condition.name for condition in self.conditions]
        rows = [outcomes[first : first + len(names)] for first in range(0, len(outcomes), len(names))]
        return [dict(zip(names, row, strict=True)) for row in rows]

    def _specifications(self, points: Sequence[np.ndarray]) -> list[Specification]:
        cells = [self.coordinates.named(u) for u in points]
        return [self.study.specification(cell, condition) for cell in cells for condition in self.conditions]


def kept(protocol: Protocol) -> np.ndarray:
    """Return which samples (n_points,) are enough while a search is on its way: every third, corners, and the last."""
    keep = np.isclose(protocol.sample_time[:, None], protocol.knot_time, rtol=1e-9, atol=0.0).any(axis=1)
    keep[::-THINNING] = True
    return keep
