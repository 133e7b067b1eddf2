"""Space mapping: curves of an accurate model at one point, scaled to others by a fast model.

The accurate model's curve h at some parameters u_0 and all samples, and the fast one's f at few samples, give

    h(u, t) = h(u_0, t) f(u, t) / f(u_0, t),

where the ratio of the fast curves varies slowly in time, so that few samples suffice, and the ratio of both models
hardly changes with u (space mapping; Bakr, Bandler et al., Optim. Eng. 1 (2000) 241-276). What the instrument adds to
the depth of the body is added last, since both models treat it exactly. With a pyramid as the accurate model, the cone
of equal cross-sections is the fast one.

Where derivatives of the accurate model are known at u_0, the mapping is made consistent with them: the difference of
both models' derivatives, times u - u_0, is added (N. M. Alexandrov et al., J. Aircraft 38 (2001) 1093-1101).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from palpate.configuration.study_file import Condition
from palpate.errors import PalpateError
from palpate.inference.coordinates import Coordinates
from palpate.inference.extrapolated import Extrapolated
from palpate.inference.observation import Observation
from palpate.inference.reference import Reference, part_of
from palpate.mechanisms import Mechanism, Scale
from palpate.solver.simulation import Simulation, simulate_batch
from palpate.solver.variation import added_by_instrument, applied_to_body
from palpate.study.specification import Specification, finer

if TYPE_CHECKING:
    from palpate.inference.forward import Curves, FiniteElements

STEP = 1e-4  # of a range, over which what the instrument adds is differenced: it is linear or nearly so
CLOSE = 0.1  # of a range, within which a reference is as good as one at the point itself
PYRAMID_NEAR = 0.5  # of a range, the same for the ratio of pyramid and cone when mechanisms only add to the depth


@dataclass(frozen=True, eq=False)
class SpaceMapped:
    """The finite elements of record under some conditions, as a `palpate.inference.forward.Forward`.

    Parameters
    ----------
    full
        The fast model with all samples.
    references
        For each condition; where there is none, the fast model's curve is taken.
    place : ndarray, shape (k,)
        Coordinates at which they were simulated.
    acting
        Mechanisms that acted there.
    refined_here
        Whether the references' rest was found near that place, with these mechanisms.
    """

    full: FiniteElements
    references: Mapping[str, Reference]
    place: np.ndarray
    acting: Sequence[Mechanism] = ()
    refined_here: bool = False

    @classmethod
    def of(cls, full: FiniteElements, u: np.ndarray) -> SpaceMapped:
        """Return the model of record, with references at coordinates u (k,) under every condition of the study.

        That is a finer mesh, or the pyramid in place of the equivalent cone, of which few samples are simulated. A
        condition under which a model fails there has none.
        """
        every = replace(full, conditions=full.study.conditions)
        few, keep = every.thinned()
        fast, usual = ([each.specification(u, c) for c in each.conditions] for each in (few, every))
        if full.study.indenter.of_revolution:
            outcomes = simulate_batch([*fast, *(replace(each, accuracy=finer(each.accuracy)) for each in usual)])
            pyramids: Sequence[Simulation | None] = [None] * len(fast)
        else:
            outcomes = simulate_batch([*fast, *usual])
            pyramids = simulate_batch([few.of_study(u, condition) for condition in few.conditions])
        references = {}
        for condition, thin, whole, pyramid in zip(
            every.conditions, outcomes, outcomes[len(fast) :], pyramids, strict=False
        ):
            if not all(each.status == "ok" for each in (thin, whole, pyramid) if each):
                continue
            added, kept = added_by_instrument(full.amplitudes(u), condition.protocol), keep[condition.name]
            reference = Reference(whole.response - added, thin.response - added[kept], kept)
            if pyramid:
                accurate = reference.carried(pyramid.response - added[kept], condition.protocol.sample_time)
                reference = replace(reference, accurate=accurate)
            references[condition.name] = reference
        return cls(full, references, u, full.mechanisms)

    @property
    def coordinates(self) -> Coordinates:
        """See `Forward`."""
        return self.full.coordinates

    def under(self, names: Sequence[str]) -> SpaceMapped:
        """See `Forward`."""
        return replace(self, full=self.full.under(names))

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """See `Forward`."""
        return self.full.at_one_load(observed, values, report)

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> SpaceMapped:
        """See `Forward`; how the accurate model's derivatives differ is not known beyond."""
        without = {name: replace(each, steeper=None) for name, each in self.references.items()}
        return replace(self, full=self.full.joined(mechanisms, scale), references=without)

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """See `Forward`."""
        return self.full.specification(u, condition)

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """See `Forward`."""
        return self.full.amplitudes(u)

    def of_record(self, u: np.ndarray) -> SpaceMapped:
        """See `Forward`; the same where the references lie near, and no mechanism has joined that acts on the body.

        Where one has joined that only adds to the depth, the references of a pyramid, whose curves cost as much as
        fifty of the cone, are kept from farther away. Friction and rounded tips change the ratio of pyramid and cone by
        0.1 to 0.2 %.
        """
        joined = [mechanism for mechanism in self.full.mechanisms if mechanism not in self.acting]
        near = PYRAMID_NEAR if joined and not self.full.study.indenter.of_revolution else CLOSE
        moved = np.abs(u[: len(self.place)] - self.place[: len(u)]).max()
        if moved < near and not any(mechanism.acts_on_body for mechanism in joined):
            return self
        return SpaceMapped.of(self.full, u)._with_rest({name: each.rest for name, each in self.references.items()})

    def _with_rest(self, rest: Mapping[str, np.ndarray | float]) -> SpaceMapped:
        """Return the same with what finer meshes add under each condition, see `Reference`; nothing where not given."""
        found = {name: each.with_rest(rest.get(name, 0.0)) for name, each in self.references.items()}
        return replace(self, references=found)

    def refined(self, u: np.ndarray) -> SpaceMapped | None:
        """See `Forward`; None for a pyramid, where the edge of contact matters, and where it is refined already."""
        if not self.full.study.indenter.of_revolution or self._depends_on_edge(u) or self.refined_here:
            return None
        (before,), (after,) = self._with_rest({}).curves([u]), self.full.of_accuracy(2).curves([u])
        if isinstance(before, str) or isinstance(after, str):
            return None
        rest = {}
        for condition in self._conditions:
            body = before[condition.name] - self._added(u, condition)
            rest[condition.name] = part_of(2.0 * (after[condition.name] - before[condition.name]), body)
        return replace(self._with_rest(rest), refined_here=True)

    def extrapolated(self, u: np.ndarray) -> Extrapolated | None:
        """See `Forward`; None for a pyramid, and where the references are consistent with finer meshes already."""
        if not self.full.study.indenter.of_revolution or any(r.steeper is not None for r in self.references.values()):
            return None
        return Extrapolated.at(self, u) if self._depends_on_edge(u) else None

    def _depends_on_edge(self, u: np.ndarray) -> bool:
        return Extrapolated.needed(applied_to_body(self.specification(u, self.full.conditions[0])))

    def consistent(self, u: np.ndarray, curves: Curves, slopes: Curves) -> SpaceMapped:
        """Return the model with these curves (n_points,) and slopes (n_points, k) at coordinates u (k,).

        Raises
        ------
        PalpateError
            When the fast model fails there.
        """
        (few, keep), references = self.full.thinned(), dict(self.references)
        (found,) = few.tangents([u])
        if isinstance(found, str):
            raise PalpateError(found)
        for condition in self.full.conditions:
            name, time, kept = condition.name, condition.protocol.sample_time, keep[condition.name]
            added, own = self._added(u, condition), self._added_slopes(u, condition)
            reference = Reference(curves[name] - added, found[0][name] - added[kept], kept)
            steeper = slopes[name] - own - reference.carried(found[1][name] - own[kept], time)
            references[name] = replace(reference, steeper=steeper)
        return SpaceMapped(self.full, references, u, self.full.mechanisms)

    def together(self, u: np.ndarray) -> int:
        """See `Forward`."""
        return self._fast.together(u)

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`."""
        outcomes = self._fast.curves(points)
        return [
            found if isinstance(found, str) else {c.name: self._carried(u, c, found[c.name]) for c in self._conditions}
            for u, found in zip(points, outcomes, strict=True)
        ]

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`."""
        found: list[tuple[Curves, Curves] | str] = []
        for u, outcome in zip(points, self._fast.tangents(points), strict=True):
            if isinstance(outcome, str):
                found.append(outcome)
                continue
            curves, slopes = outcome
            found.append(
                (
                    {c.name: self._carried(u, c, curves[c.name]) for c in self._conditions},
                    {c.name: self._carried_slopes(u, c, slopes[c.name]) for c in self._conditions},
                )
            )
        return found

    def thinned(self) -> tuple[SpaceMapped, Mapping[str, np.ndarray]]:
        """See `Forward`: there is none cheaper."""
        return self, {c.name: np.ones(len(c.protocol.sample_time), dtype=bool) for c in self._conditions}

    @property
    def refinements(self) -> dict[str, np.ndarray]:
        """See `Forward`; a pyramid differs from its cone by more than the error of a mesh."""
        study = self.full.study
        known = self.references.items() if study.indenter.of_revolution else ()
        return {name: each.change(study.condition(name).protocol.sample_time) for name, each in known}

    @property
    def _conditions(self) -> Sequence[Condition]:
        return self.full.conditions

    @property
    def _fast(self) -> FiniteElements:
        """The fast model, with few samples of conditions that have a reference."""
        few = dict(zip([c.name for c in self._conditions], self.full.thinned()[0].conditions, strict=True))
        chosen = [few[c.name] if c.name in self.references else c for c in self._conditions]
        return replace(self.full, conditions=chosen)

    def _carried(self, u: np.ndarray, condition: Condition, curve: np.ndarray) -> np.ndarray:
        if condition.name not in self.references:
            return curve
        reference, added = self.references[condition.name], self._added(u, condition)
        body = reference.carried(curve - added[reference.kept], condition.protocol.sample_time)
        return body + added if reference.steeper is None else body + added + reference.steeper @ (u - self.place)

    def _carried_slopes(self, u: np.ndarray, condition: Condition, slopes: np.ndarray) -> np.ndarray:
        if condition.name not in self.references:
            return slopes
        reference, added = self.references[condition.name], self._added_slopes(u, condition)
        body = reference.carried(slopes - added[reference.kept], condition.protocol.sample_time)
        return body + added if reference.steeper is None else body + added + reference.steeper

    def _added_slopes(self, u: np.ndarray, condition: Condition) -> np.ndarray:
        """Return the derivatives (n_points, k) of what the instrument adds."""
        here = self._added(u, condition)
        moved = [self._added(u + step, condition) for step in STEP * np.eye(len(u))]
        return np.stack([there - here for there in moved], axis=1) / STEP

    def _added(self, u: np.ndarray, condition: Condition) -> np.ndarray:
        return added_by_instrument(self.amplitudes(u), condition.protocol)
