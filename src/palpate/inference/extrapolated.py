"""Curves and derivatives on finer meshes, where the edge of contact decides how a curve changes.

Derivatives by the parameters of creep, and by what changes the shape of the tip, are off by 1 to 3 % on the usual mesh.
What friction, adhesion or yielding does depends on the edge of contact: derivatives by the first two are off by 10 to
12 %, those by a hardening by tens of per cent, and least squares with them end elsewhere than with a finer mesh. So a
search ends with derivatives of a mesh that is finer by one degree than the study's, of few samples, and with curves of
one that is finer by two. To these is added what the last degree changed where the search arrived: with an error of
second order in the spacing, about as much is left (L. F. Richardson, Phil. Trans. A 210 (1911) 307-357). Derivatives by
the thickness of a film, whose interface crosses elements, gain nothing by that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from palpate.base.interpolation import interpolated

if TYPE_CHECKING:
    from palpate.inference.forward import Curves
    from palpate.inference.space_mapping import SpaceMapped
    from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Extrapolated:
    """Curves, and their derivatives at one place.

    Parameters
    ----------
    record
        The model of record, with the finite elements on the study's mesh.
    there
        Response (n_points,) under each condition at that place.
    slopes
        Its derivatives (n_points, k) by the coordinates.
    rest
        What is added to curves of the finest of the meshes (n_points,).
    """

    record: SpaceMapped
    there: Curves
    slopes: Curves
    rest: Curves

    @staticmethod
    def needed(solid: Specification) -> bool:
        """Return whether derivatives on the usual mesh do not serve a body that is simulated."""
        return solid.specimen.yields or solid.adhesion > 0.0 or solid.indenter.friction > 0.0

    @classmethod
    def at(cls, record: SpaceMapped, u: np.ndarray) -> Extrapolated | None:
        """Return it for the place with coordinates u (k,); None where a simulation fails."""
        finer, finest = (record.full.of_accuracy(degrees) for degrees in (1, 2))
        few, keep = finer.thinned()
        (tangents,), (before,), (after,) = few.tangents([u]), finer.curves([u]), finest.curves([u])
        if isinstance(tangents, str) or isinstance(before, str) or isinstance(after, str):
            return None
        slopes = {}
        for condition in finer.conditions:
            name, time = condition.name, condition.protocol.sample_time
            slopes[name] = interpolated(time, time[keep[name]], tangents[1][name].T)
        rest = {name: after[name] - before[name] for name in after}
        return cls(record, {name: after[name] + rest[name] for name in after}, slopes, rest)

    def curves(self, u: np.ndarray) -> Curves | str:
        """Return the response (n_points,) at coordinates u (k,) near by, or why a simulation failed."""
        (found,) = self.record.full.of_accuracy(2).curves([u])
        return found if isinstance(found, str) else {name: found[name] + self.rest[name] for name in found}
