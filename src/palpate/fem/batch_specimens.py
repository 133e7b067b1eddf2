"""The laws of `LANES` bodies: what of them depends on the place in the body, on depth and on the time step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.fem.batch_law import law_rows, weight_rows
from palpate.fem.mesh import Mesh
from palpate.fem.regions import laws_of, regions
from palpate.materials.radial import VOIGT
from palpate.specimen import Specimen, resisted


@dataclass(frozen=True, eq=False)
class Specimens:
    """The laws of `LANES` bodies of one shape: the same everywhere, or of each element in a film on a substrate.

    Parameters
    ----------
    specimens
        One for each lane.
    coefficients : ndarray, shape (regions, LANES, c)
        Their laws at large depth.
    region : ndarray of int, shape (m, LANES)
        The law of each element.
    """

    specimens: Sequence[Specimen]
    coefficients: np.ndarray
    region: np.ndarray

    @classmethod
    def of(cls, specimens: Sequence[Specimen], mesh: Mesh, units: np.ndarray) -> Specimens:
        """Return the bodies that a mesh divides whose lengths are in `units` (LANES,) [um]."""
        region = [regions(specimen, mesh, unit) for specimen, unit in zip(specimens, units, strict=True)]
        return cls(specimens, np.stack([laws_of(s) for s in specimens], axis=1), np.stack(region, axis=1))

    @property
    def elements(self) -> int:
        """Number of Voigt elements."""
        return len(range(VOIGT, self.coefficients.shape[2], 3))

    def at(self, depth: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return `law_rows` and `weight_rows` of `steps` (LANES,) [s] at a `depth` (LANES,) [nm].

        Each of the body, or of each element: (1 or m, rows, LANES).
        """
        resisting = self._resisted(depth)
        laws, weights = [law_rows(row) for row in resisting], [weight_rows(row, steps) for row in resisting]
        return self._spread(np.stack(laws)), self._spread(np.stack(weights))

    def _resisted(self, depth: np.ndarray) -> np.ndarray:
        if not any(specimen.size_length for specimen in self.specimens):
            return self.coefficients
        resistance = [specimen.resistance(d) for specimen, d in zip(self.specimens, depth, strict=True)]
        rows = [resisted(self.coefficients[:, lane], factor) for lane, factor in enumerate(resistance)]
        return np.stack(rows, axis=1)

    def _spread(self, rows: np.ndarray) -> np.ndarray:
        return rows if len(rows) == 1 else np.take_along_axis(rows, self.region[:, None, :], axis=0)
