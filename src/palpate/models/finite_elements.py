"""The finite elements as searches see them: the body's curves, anchored to accurate ones, and the instrument added.

Without anchors they are those of one level of fidelity. With anchors a fast level is scaled, see
`palpate.models.anchors`. Derivatives by the parameters of creep, and by what changes the shape of the tip, are off
by 1 to 3 % on the usual mesh. What friction, adhesion or yielding does depends on the edge of contact: derivatives by
the first two are off by 10 to 12 %, those by a hardening by tens of per cent, and least squares with them end elsewhere
than with a finer mesh. So there a search ends with derivatives of a mesh that is finer by one degree than the study's,
and with curves of one that is finer by two, extrapolated where the search arrived. Derivatives by the thickness of a
film, whose interface crosses elements, gain nothing by that.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.errors import PalpateError
from palpate.mechanisms import Mechanism, Scale
from palpate.models.anchors import Anchor, Anchors, anchors_at, richardson, richardson_at
from palpate.models.body_model import BodyModel
from palpate.models.coordinates import Coordinates
from palpate.models.fidelity import COARSE, FINE, MEDIUM, SEARCH, STUDY, Level, kept
from palpate.models.forward import Curves
from palpate.models.own_loads import brought_to_one_load
from palpate.solver.variation import applied_to_body
from palpate.study.specification import Specification

CLOSE = 0.005  # change of the curves, within which an anchor is as good as one at the point itself
PYRAMID_CLOSE = 0.05  # the same for the ratio of pyramid and cone
PYRAMID_NEAR = 0.2  # the same where the mechanisms that joined only add to the depth


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """The finite elements under some conditions, as a `palpate.models.forward.Forward`.

    Parameters
    ----------
    body
        The body under these conditions.
    level
        How closely it is simulated; with all samples under conditions that lack an anchor.
    anchors
        Accurate curves near by.
    """

    body: BodyModel
    level: Level = STUDY
    anchors: Anchors | None = None

    @classmethod
    def of(cls, study: Study, names: Collection[str]) -> FiniteElements:
        """Return the finite elements of a study under the conditions of these names, with its mesh."""
        conditions, coordinates = (
            [study.condition(name) for name in names],
            Coordinates.of(study.levels, study.declared),
        )
        return cls(BodyModel(study, conditions, coordinates))

    @property
    def coordinates(self) -> Coordinates:
        """See `Forward`."""
        return self.body.coordinates

    @property
    def conditions(self) -> Sequence[Condition]:
        """Conditions with the samples of the curves."""
        return self.body.conditions if self.anchors else self._simulated.conditions

    @property
    def refinements(self) -> dict[str, np.ndarray]:
        """See `Forward`; not known of a pyramid, and zero."""
        return {name: each.mesh_change for name, each in self._anchor.items()}

    @property
    def _anchor(self) -> Mapping[str, Anchor]:
        return self.anchors.of if self.anchors else {}

    @cached_property
    def _simulated(self) -> BodyModel:
        """The body at this level; with all samples where curves are to be scaled to an anchor and there is none."""
        lacking = [c.name for c in self.body.conditions if c.name not in self._anchor] if self.anchors else ()
        return self.body.at(self.level, lacking)

    def under(self, names: Collection[str]) -> FiniteElements:
        """See `Forward`."""
        return replace(self, body=self.body.under(names))

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """See `Forward`."""
        return brought_to_one_load(self.body.study, observed, values, report)

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> FiniteElements:
        """See `Forward`; how the accurate model's derivatives differ is not known beyond."""
        anchors = self.anchors
        if anchors:
            without = {name: replace(each, slope_correction=None) for name, each in anchors.of.items()}
            anchors = replace(anchors, of=without)
        return replace(self, body=self.body.joined(mechanisms, scale), anchors=anchors)

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """See `Forward`."""
        return self.body.specification(u, condition)

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """See `Forward`."""
        return self.body.amplitudes(u)

    def thinned(self) -> tuple[FiniteElements, Mapping[str, np.ndarray]]:
        """See `Forward`: few samples and sectors without anchors; with them there is none cheaper."""
        conditions = self.body.conditions
        if self.anchors:
            return self, {c.name: np.ones(len(c.protocol.sample_time), dtype=bool) for c in conditions}
        return replace(self, level=SEARCH), {c.name: kept(c.protocol) for c in conditions}

    def points_per_batch(self, u: np.ndarray) -> int:
        """See `Forward`: as many as fill the lanes of one run."""
        return self._simulated.points_per_batch(u)

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """See `Forward`."""
        return [
            found if isinstance(found, str) else self._with_instrument(u, found)
            for u, found in zip(points, self._bodies(points), strict=True)
        ]

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """See `Forward`."""
        found: list[tuple[Curves, Curves] | str] = []
        for u, outcome in zip(points, self._simulated.tangents(points), strict=True):
            if isinstance(outcome, str):
                found.append(outcome)
            else:
                bodies = self._scaled(u, outcome[0])
                found.append((self._with_instrument(u, bodies), self._scaled_slopes(u, bodies, outcome[1])))
        return found

    def reanchored(self, u: np.ndarray) -> FiniteElements:
        """See `Forward`; the same where the anchors lie near, and no mechanism has joined that acts on the body.

        Where one has joined that only adds to the depth, the anchors of a pyramid, whose curves cost as much as fifty
        of the cone, are kept from farther away. Friction and rounded tips change the ratio of pyramid and cone by 0.1
        to 0.2 %.
        """
        if self.anchors:
            joined = [each for each in self.body.mechanisms if each not in self.anchors.mechanisms]
            near = CLOSE if self.body.study.of_revolution else PYRAMID_NEAR if joined else PYRAMID_CLOSE
            if not any(mechanism.acts_on_body for mechanism in joined) and self._change(u) < near:
                return self
        known = {name: each.richardson for name, each in self._anchor.items()}
        found = Anchors(u, self.body.mechanisms, anchors_at(self._under_others(()), u))
        return replace(self, level=SEARCH, anchors=found.extrapolated(known))

    def refined(self, u: np.ndarray) -> FiniteElements | None:
        """See `Forward`; None for a pyramid, where the edge of contact matters, and where it is refined already."""
        if not self.anchors or self.anchors.refined or not self.body.study.of_revolution or self._at_edge(u):
            return None
        parts = richardson_at(self._under_others(()), u)
        if not parts.keys() >= {condition.name for condition in self.body.conditions}:
            return None
        record = self.reanchored(u)
        return replace(record, anchors=record.anchors and record.anchors.extrapolated(parts, refined=True))

    def extrapolated(self, u: np.ndarray) -> tuple[FiniteElements, Curves, Curves] | None:
        """See `Forward`; None for a pyramid, and where the anchors are consistent with finer meshes already."""
        if not self.anchors or not self.body.study.of_revolution or not self._at_edge(u):
            return None
        if any(anchor.slope_correction is not None for anchor in self._anchor.values()):
            return None
        record = self.reanchored(u)
        changes = record.refinements
        (tangents,), (finer,) = self.body.at(MEDIUM).tangents([u]), self.body.at(FINE).curves([u])
        (here,) = replace(record, anchors=record.anchors and record.anchors.extrapolated({}))._bodies([u])
        if isinstance(tangents, str) or isinstance(finer, str) or isinstance(here, str):
            return None
        anchors = {
            name: Anchor(here[name], curve, changes.get(name, np.zeros_like(here[name])), finer=finer[name] - curve)
            for name, curve in tangents[0].items()
        }
        model = replace(record, level=FINE, anchors=Anchors(u, self.body.mechanisms, anchors))
        bodies = model._scaled(u, finer)
        return model, model._with_instrument(u, bodies), model._scaled_slopes(u, bodies, tangents[1])

    def consistent(self, u: np.ndarray, curves: Curves, slopes: Curves) -> FiniteElements:
        """See `Forward`.

        The fast level gets all sectors: farther from there fewer of them would take away what the slopes gain.

        Raises
        ------
        PalpateError
            When the fast level fails there.
        """
        (coarse,) = self.body.at(COARSE).tangents([u])
        if isinstance(coarse, str):
            raise PalpateError(coarse)
        others = self._under_others([condition.name for condition in self.body.conditions])
        held_out = Anchors(u, self.body.mechanisms, anchors_at(others, u, COARSE))
        anchors = held_out.extrapolated(richardson_at(others, u), refined=True)
        found = dict(anchors.of)
        for condition in self.body.conditions:
            name, protocol, fine = condition.name, condition.protocol, self._anchor[condition.name]
            part = richardson(fine.fast, fine.finer, protocol)
            accurate = self.body.without_instrument(u, condition, curves[name])
            anchor = Anchor(accurate, coarse[0][name], fine.mesh_change, richardson=part)
            of_body = slopes[name] - self.body.instrument_slopes(u, condition, accurate, slopes[name])
            found[name] = replace(anchor, slope_correction=of_body - anchor.scaled(coarse[1][name], protocol))
        return replace(self, level=COARSE, anchors=replace(anchors, of=found))

    def _under_others(self, names: Collection[str]) -> BodyModel:
        """Return the body under every condition of the study, those that are held out among them, but for some."""
        return replace(self.body, conditions=[c for c in self.body.study.conditions if c.name not in names])

    def _at_edge(self, u: np.ndarray) -> bool:
        """Return whether derivatives on the usual mesh do not serve the body at coordinates u (k,)."""
        solids = [applied_to_body(self.specification(u, condition)) for condition in self.body.conditions]
        return any(s.specimen.yields or s.adhesion > 0.0 or s.indenter.friction > 0.0 for s in solids)

    def _change(self, u: np.ndarray) -> float:
        """Return by how much the body's curves at coordinates u (k,) differ from those of the anchors [-]."""
        (found,) = self._simulated.curves([u])
        if isinstance(found, str):
            return np.inf
        pairs = [(found[c.name], self._anchor[c.name].fast) for c in self.body.conditions if c.name in self._anchor]
        return max([float(np.linalg.norm(there - fast) / np.linalg.norm(fast)) for there, fast in pairs], default=0.0)

    def _bodies(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return the body's response (n_points,) under each condition at each of the points (k,)."""
        outcomes = self._simulated.curves(points)
        return [
            found if isinstance(found, str) else self._scaled(u, found)
            for u, found in zip(points, outcomes, strict=True)
        ]

    def _scaled(self, u: np.ndarray, curves: Curves) -> dict[str, np.ndarray]:
        """Return the body's curves (n_points,) at coordinates u (k,), of which these are the level's."""
        found = dict(curves)
        for condition in self.body.conditions:
            if self.anchors and (anchor := self.anchors.of.get(condition.name)):
                found[condition.name] = anchor.scaled(curves[condition.name] + anchor.finer, condition.protocol)
                if anchor.slope_correction is not None:
                    found[condition.name] += anchor.slope_correction @ (u - self.anchors.point)
        return found

    def _scaled_slopes(self, u: np.ndarray, bodies: Curves, slopes: Curves) -> dict[str, np.ndarray]:
        """Return the derivatives (n_points, k) of the response, of which these are the level's of the `bodies`."""
        found = {}
        for condition in self.conditions:
            name, of_body = condition.name, slopes[condition.name]
            if anchor := self._anchor.get(name):
                of_body = anchor.scaled(of_body, condition.protocol)
                of_body = of_body if anchor.slope_correction is None else of_body + anchor.slope_correction
            found[name] = of_body + self.body.instrument_slopes(u, condition, bodies[name], of_body)
        return found

    def _with_instrument(self, u: np.ndarray, bodies: Curves) -> dict[str, np.ndarray]:
        """Return the response (n_points,) of the body with what the instrument adds."""
        return {c.name: bodies[c.name] + self.body.instrument(u, c, bodies[c.name]) for c in self.conditions}
