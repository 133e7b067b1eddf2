"""Curves and derivatives on finer meshes, where the edge of contact decides how a curve changes.

Derivatives by the parameters of creep, and by what changes the shape of the tip, are off by 1 to 3 % on the usual mesh.
What friction, adhesion or yielding does depends on the edge of contact: derivatives by the first two are off by 10 to
12 %, those by a hardening by tens of per cent, and least squares with them end elsewhere than with a finer mesh. So a
search ends with derivatives of a mesh that is finer by one degree than the study's, and with curves of one that is
finer by two, both of few samples. To these is added what the last degree changed where the search arrived: with an
error of second order in the spacing, about as much is left (L. F. Richardson, Phil. Trans. A 210 (1911) 307-357).
Derivatives by the thickness of a film, whose interface crosses elements, gain nothing by that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from palpate.errors import PalpateError
from palpate.inference.reference import Reference, rest_of

if TYPE_CHECKING:
    from palpate.inference.forward import Curves
    from palpate.inference.space_mapping import SpaceMapped
    from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Extrapolated:
    """Curves of finer meshes near one place, and derivatives there.

    Parameters
    ----------
    record
        The model of record.
    place : ndarray, shape (k,)
        Coordinates of the place.
    references
        Bring curves of the body at few samples on the coarser of the meshes to all samples, for each condition.
    slopes_of_few
        Derivatives (n_kept, k) of these curves by the coordinates.
    rest
        What the finer of the meshes adds to them (n_kept,), and once more what lies beyond.
    """

    record: SpaceMapped
    place: np.ndarray
    references: Mapping[str, Reference]
    slopes_of_few: Curves
    rest: Curves

    @staticmethod
    def needed(solid: Specification) -> bool:
        """Return whether derivatives on the usual mesh do not serve a body that is simulated."""
        return solid.specimen.yields or solid.adhesion > 0.0 or solid.indenter.friction > 0.0

    @classmethod
    def at(cls, record: SpaceMapped, u: np.ndarray) -> Extrapolated | None:
        """Return it for the place with coordinates u (k,), near the references; None where a simulation fails."""
        few, keep = record.full.thinned()
        (tangents,), (after,) = few.of_accuracy(1).tangents([u]), few.of_accuracy(2).curves([u])
        (here,) = record.with_rest({}).curves([u])
        if isinstance(tangents, str) or isinstance(after, str) or isinstance(here, str):
            return None
        references, slopes, rest = {}, {}, {}
        for condition in record.full.conditions:
            name, kept, added = condition.name, keep[condition.name], record.added(u, condition)
            coarser = tangents[0][name] - added[kept]
            references[name] = Reference(here[name] - added, coarser, kept, np.zeros(len(kept)))
            slopes[name] = tangents[1][name] - record.added_slopes(u, condition)[kept]
            rest[name] = after[name] - tangents[0][name]
        return cls(record, u, references, slopes, rest)

    @property
    def there(self) -> dict[str, np.ndarray]:
        """Response (n_points,) under each condition at the place."""
        return self._response(self.place, {n: each.fast + 2.0 * self.rest[n] for n, each in self.references.items()})

    @property
    def slopes(self) -> dict[str, np.ndarray]:
        """Its derivatives (n_points, k) by the coordinates."""
        found = {}
        for condition in self.record.full.conditions:
            name = condition.name
            of_body = self.references[name].carried(self.slopes_of_few[name], condition.protocol)
            found[name] = of_body + self.record.added_slopes(self.place, condition)
        return found

    def curves(self, u: np.ndarray) -> Curves | str:
        """Return the response (n_points,) at coordinates u (k,) near by, or why a simulation failed."""
        few, keep = self.record.full.thinned()
        (found,) = few.of_accuracy(2).curves([u])
        if isinstance(found, str):
            return found
        added = {c.name: self.record.added(u, c)[keep[c.name]] for c in self.record.full.conditions}
        return self._response(u, {name: found[name] - added[name] + self.rest[name] for name in found})

    def consistent(self, u: np.ndarray, curves: Curves, slopes: Curves) -> SpaceMapped:
        """Return the model of record with these curves (n_points,) and slopes (n_points, k) at coordinates u (k,).

        The fast model gets all sectors: farther from there fewer of them would take away what the slopes gain.

        Raises
        ------
        PalpateError
            When the fast model fails there.
        """
        record = self.record
        few, keep = record.full.thinned()
        (found,) = few.of_accuracy(0).tangents([u])
        if isinstance(found, str):
            raise PalpateError(found)
        every = record.held_out(u)
        for condition in record.full.conditions:
            name, time, kept = condition.name, condition.protocol.sample_time, keep[condition.name]
            added, own = record.added(u, condition), record.added_slopes(u, condition)
            rest = rest_of(self.references[name].fast, self.rest[name], time, kept)
            changed = record.refinements.get(name, np.zeros(len(time)))
            reference = Reference(curves[name] - added, found[0][name] - added[kept], kept, changed, rest=rest)
            steeper = slopes[name] - own - reference.carried(found[1][name] - own[kept], condition.protocol)
            every[name] = replace(reference, steeper=steeper)
        acting = record.full.mechanisms
        return replace(record, references=every, place=u, acting=acting, all_sectors=True)

    def _response(self, u: np.ndarray, few: Curves) -> dict[str, np.ndarray]:
        """Return the response (n_points,) at coordinates u (k,) of which these are the body's curves (n_kept,)."""
        found = {}
        for condition in self.record.full.conditions:
            body = self.references[condition.name].carried(few[condition.name], condition.protocol)
            found[condition.name] = body + self.record.added(u, condition)
        return found
