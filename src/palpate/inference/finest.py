"""The finite elements on finer meshes, where those of the usual one do not tell how a curve changes.

Derivatives by the parameters of creep, and by what changes the shape of the tip, are off by 1 to 3 % on the usual mesh.
What friction, adhesion or yielding does depends on the edge of contact: derivatives by the first two are off by 10 to
12 %, those by a hardening by tens of per cent, and least squares with them end elsewhere than with a finer mesh. So a
search ends with curves of a mesh that is finer by two degrees than the study's, and with derivatives of one that is
finer by one, of few samples: where the first errs by 0.1 % of the depth, the second by a few per cent of the
derivative. Derivatives by the thickness of a film, whose interface crosses elements, gain nothing by that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from palpate.inference.forward import Curves
    from palpate.inference.space_mapping import SpaceMapped
    from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Finest:
    """Curves and derivatives as a `palpate.inference.forward.Forward` gives them, from finer meshes.

    Parameters
    ----------
    record
        The model of record, with the finite elements on the study's mesh.
    """

    record: SpaceMapped

    @staticmethod
    def needed(solid: Specification) -> bool:
        """Return whether derivatives on the usual mesh do not serve a body that is simulated."""
        return solid.specimen.yields or solid.adhesion > 0.0 or solid.indenter.friction > 0.0

    def curves(self, u: np.ndarray) -> Curves | str:
        """Return the response (n_points,) at coordinates u (k,), or why a simulation failed."""
        return self.record.full.of_accuracy(2).curves([u])[0]

    def tangents(self, u: np.ndarray) -> tuple[Curves, Curves] | str:
        """Return the response (n_points,) at coordinates u (k,) and its derivatives (n_points, k)."""
        few, keep = self.record.full.of_accuracy(1).thinned()
        curves, found = self.curves(u), few.tangents([u])[0]
        if isinstance(curves, str) or isinstance(found, str):
            return curves if isinstance(curves, str) else str(found)
        slopes = {}
        for condition in self.record.full.conditions:
            time, columns = condition.protocol.sample_time, found[1][condition.name].T
            knots = time[keep[condition.name]]
            slopes[condition.name] = np.stack([np.interp(time, knots, column) for column in columns], axis=1)
        return curves, slopes
