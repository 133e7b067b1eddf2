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
from palpate.inference.body_curves import bodies
from palpate.inference.coordinates import Coordinates
from palpate.inference.extrapolated import Extrapolated
from palpate.inference.observation import Observation
from palpate.inference.reference import Reference, rest_of
from palpate.mechanisms import Mechanism, Scale
from palpate.solver.variation import added_by_instrument, applied_to_body
from palpate.study.specification import Specification

if TYPE_CHECKING:
    from palpate.inference.forward import Curves, FiniteElements

STEP = 1e-4  # of a range, over which what the instrument adds is differenced: it is linear or nearly so
CLOSE = 0.005  # change of the curves, within which a reference is as good as one at the point itself
PYRAMID_CLOSE = 0.05  # the same for the ratio of pyramid and cone
PYRAMID_NEAR = 0.2  # the same where the mechanisms that joined only add to the depth


@dataclass(frozen=True, eq=False)
class SpaceMapped:
    """The finite elements of record under some conditions, as a `palpate.inference.forward.Forward`.

    Parameters
    ----------
    full
        The finite elements with all samples, of which few on a coarser mesh are the fast model.
    references
        For each condition; where there is none, the fast model's curve is taken.
    place : ndarray, shape (k,)
        Coordinates at which they were simulated.
    acting
        Mechanisms that acted there.
    refined_here
        Whether the references' rest was found near that place, with these mechanisms.
    all_sectors
        Whether the fast model's mesh has all sectors of the study's.
    """

    full: FiniteElements
    references: Mapping[str, Reference]
    place: np.ndarray
    acting: Sequence[Mechanism] = ()
    refined_here: bool = False
    all_sectors: bool = False

    @classmethod
    def of(cls, full: FiniteElements, u: np.ndarray) -> SpaceMapped:
        """Return the model of record, with references at coordinates u (k,) under every condition of the study.

        That is a finer mesh or, where that fails, the study's; or the pyramid in place of the equivalent cone, of which
        few samples are simulated. A condition under which a model fails there has none.
        """
        return cls(full, _references(_under_every(full), u), u, full.mechanisms)

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
        near = CLOSE if self.full.study.indenter.of_revolution else PYRAMID_NEAR if joined else PYRAMID_CLOSE
        if not any(mechanism.acts_on_body for mechanism in joined) and self._change(u) < near:
            return self
        return SpaceMapped.of(self.full, u).with_rest({name: each.rest for name, each in self.references.items()})

    def held_out(self, u: np.ndarray) -> dict[str, Reference]:
        """Return references at coordinates u (k,) under the study's other conditions, of a mesh with all sectors.

        They hold what finer meshes add.
        """
        own = {condition.name for condition in self._conditions}
        full = replace(self.full, conditions=[each for each in self.full.study.conditions if each.name not in own])
        if not full.conditions:
            return {}
        found, rest = _references(full, u, all_sectors=True), _rest(full, u)
        return {name: each.with_rest(rest.get(name, 0.0)) for name, each in found.items()}

    def _change(self, u: np.ndarray) -> float:
        """Return by how much the body's curves at coordinates u (k,) differ from those of the references [-]."""
        (found,) = self._fast.curves([u])
        if isinstance(found, str):
            return np.inf
        changes = [0.0]
        for condition in self._conditions:
            if reference := self.references.get(condition.name):
                there = found[condition.name] - self.added(u, condition)[reference.kept]
                changes.append(float(np.linalg.norm(there - reference.fast) / np.linalg.norm(reference.fast)))
        return max(changes)

    def with_rest(self, rest: Mapping[str, np.ndarray | float]) -> SpaceMapped:
        """Return the same with what finer meshes add under each condition, see `Reference`; nothing where not given."""
        found = {name: each.with_rest(rest.get(name, 0.0)) for name, each in self.references.items()}
        return replace(self, references=found)

    def refined(self, u: np.ndarray) -> SpaceMapped | None:
        """See `Forward`; None for a pyramid, where the edge of contact matters, and where it is refined already."""
        if not self.full.study.indenter.of_revolution or self._depends_on_edge(u) or self.refined_here:
            return None
        rest = _rest(_under_every(self.full), u)
        if not rest.keys() >= {condition.name for condition in self._conditions}:
            return None
        return replace(self.of_record(u).with_rest(rest), refined_here=True)

    def extrapolated(self, u: np.ndarray) -> Extrapolated | None:
        """See `Forward`; None for a pyramid, and where the references are consistent with finer meshes already."""
        if not self.full.study.indenter.of_revolution or any(r.steeper is not None for r in self.references.values()):
            return None
        return Extrapolated.at(self.of_record(u), u) if self._depends_on_edge(u) else None

    def _depends_on_edge(self, u: np.ndarray) -> bool:
        return Extrapolated.needed(applied_to_body(self.specification(u, self.full.conditions[0])))

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
        """See `Forward`; not known of a pyramid, and zero."""
        return {name: each.changed for name, each in self.references.items()}

    @property
    def _conditions(self) -> Sequence[Condition]:
        return self.full.conditions

    @property
    def _fast(self) -> FiniteElements:
        """The fast model, with all samples of conditions that have no reference."""
        model = self.full.thinned()[0]
        model = model.of_accuracy(0) if self.all_sectors else model
        few = zip(self._conditions, model.conditions, strict=True)
        return replace(model, conditions=[thin if c.name in self.references else c for c, thin in few])

    def _carried(self, u: np.ndarray, condition: Condition, curve: np.ndarray) -> np.ndarray:
        if condition.name not in self.references:
            return curve
        reference, added = self.references[condition.name], self.added(u, condition)
        body = reference.carried(curve - added[reference.kept], condition.protocol)
        return body + added if reference.steeper is None else body + added + reference.steeper @ (u - self.place)

    def _carried_slopes(self, u: np.ndarray, condition: Condition, slopes: np.ndarray) -> np.ndarray:
        if condition.name not in self.references:
            return slopes
        reference, added = self.references[condition.name], self.added_slopes(u, condition)
        body = reference.carried(slopes - added[reference.kept], condition.protocol)
        return body + added if reference.steeper is None else body + added + reference.steeper

    def added_slopes(self, u: np.ndarray, condition: Condition) -> np.ndarray:
        """Return the derivatives (n_points, k) of what the instrument adds."""
        here = self.added(u, condition)
        moved = [self.added(u + step, condition) for step in STEP * np.eye(len(u))]
        return np.stack([there - here for there in moved], axis=1) / STEP

    def added(self, u: np.ndarray, condition: Condition) -> np.ndarray:
        """Return what the instrument adds to the depth (n_points,) [nm]."""
        return added_by_instrument(self.amplitudes(u), condition.protocol)


def _under_every(full: FiniteElements) -> FiniteElements:
    """Return the same under every condition of the study, those that are held out among them."""
    return replace(full, conditions=full.study.conditions)


def _rest(full: FiniteElements, u: np.ndarray) -> dict[str, np.ndarray]:
    """Return the part of the curves (n_points,) at coordinates u (k,) that finer meshes add, where both succeed."""
    few, keep = full.thinned()
    before, after = (bodies(few.of_accuracy(degrees), u) for degrees in (1, 2))
    times = {condition.name: condition.protocol.sample_time for condition in full.conditions}
    return {n: rest_of(before[n], after[n] - before[n], times[n], keep[n]) for n in before.keys() & after.keys()}


def _references(full: FiniteElements, u: np.ndarray, all_sectors: bool = False) -> dict[str, Reference]:
    """Return references at coordinates u (k,) under each condition, where both models succeed."""
    few, keep = full.thinned()
    study = bodies(few.of_accuracy(0), u)
    fast = study if all_sectors else bodies(few, u)
    accurate, found, known = _accurate(full, study, u), {}, float(full.study.indenter.of_revolution)
    for condition in full.conditions:
        name, time, kept = condition.name, condition.protocol.sample_time, keep[condition.name]
        if name in fast and name in study and name in accurate:
            changed = known * np.interp(time, time[kept], accurate[name][kept] - study[name])
            found[name] = Reference(accurate[name], fast[name], kept, changed)
    return found


def _accurate(full: FiniteElements, study: Mapping[str, np.ndarray], u: np.ndarray) -> dict[str, np.ndarray]:
    """Return the curve (n_points,) of the body at coordinates u (k,) that is most accurate, under each condition.

    Parameters
    ----------
    full
        The finite elements with all samples.
    study
        Curves (n_kept,) of few samples on the study's mesh.
    u
    """
    if full.study.indenter.of_revolution:
        found = bodies(full.of_accuracy(1), u)
        return found | bodies(full.under([name for name in study if name not in found]), u)
    (few, keep), cone, found = full.thinned(), bodies(full, u), {}
    for name, pyramid in bodies(few.of_accuracy(0), u, pyramid=True).items():
        if name in cone and name in study:
            protocol = full.study.condition(name).protocol
            reference = Reference(cone[name], study[name], keep[name], np.zeros(len(cone[name])))
            found[name] = reference.carried(pyramid, protocol)
    return found
