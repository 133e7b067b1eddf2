"""The laws of `LANES` bodies: what of them depends on the place in the body, on depth and on the time step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.materials.flow.row import BACK_STRESS, step_weights, voigt_elements
from palpate.solver.axisymmetric.mesh import Mesh
from palpate.solver.axisymmetric.regions import laws_of
from palpate.study.specimen import Specimen


@dataclass(frozen=True, eq=False)
class Specimens:
    """The laws of `LANES` bodies of one shape: the same everywhere, or of each element in a film on a substrate.

    Parameters
    ----------
    specimens
        One for each lane.
    laws : ndarray, shape (1 or m, c, LANES)
        Their laws, see `palpate.materials.flow.row`.
    """

    specimens: Sequence[Specimen]
    laws: np.ndarray

    @classmethod
    def of(cls, specimens: Sequence[Specimen], mesh: Mesh, units: np.ndarray) -> Specimens:
        """Return the bodies that a mesh divides whose lengths are in `units` (LANES,) [um]."""
        laws = [laws_of(specimen, mesh, unit) for specimen, unit in zip(specimens, units, strict=True)]
        return cls(specimens, np.stack(laws, axis=2))

    @property
    def elements(self) -> int:
        """Number of Voigt elements."""
        return voigt_elements(self.specimens[0].coefficients)

    @property
    def backed(self) -> bool:
        """Whether their laws have a back stress."""
        return bool(self.specimens[0].coefficients[BACK_STRESS] > 0.0)

    def at(self, depth: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return `laws` and what `steps` (LANES,) [s] make of them at a `depth` (LANES,) [nm]: (1 or m, w, LANES)."""
        resistance = np.array([s.resistance(d) for s, d in zip(self.specimens, depth, strict=True)])
        return self.laws, step_weights(self.laws, steps, resistance)
