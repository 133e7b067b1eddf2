"""Which law holds in which element of a specimen's mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from palpate.fem.profile import Profile
from palpate.indenters import Indenter
from palpate.specimen import Specimen, series


class Divided(Protocol):
    """A mesh, in the plane or in space."""

    @property
    def elements(self) -> np.ndarray:
        """Nodes of each element."""

    def share_above(self, height: float) -> np.ndarray:
        """Return the share (m,) of each element's volume above z = `height`."""


def laws_of(specimen: Specimen) -> np.ndarray:
    """Return the laws (regions, c): substrate and film in series, by shares of the film in steps of an eighth."""
    if specimen.substrate is None:
        return specimen.coefficients[None, :]
    return np.stack([series(specimen.coefficients, specimen.substrate, k / 8) for k in range(9)])


def regions(specimen: Specimen, mesh: Divided, unit: float = 1.0) -> np.ndarray:
    """Return the law of each element (m,), by the share of its volume above the interface; the mesh is in `unit` um."""
    if specimen.substrate is None:
        return np.zeros(len(mesh.elements), dtype=np.int64)
    return np.rint(8 * mesh.share_above(-1e-3 * specimen.film_thickness / unit)).astype(np.int64)


def resolved(specimen: Specimen, indenter: Indenter, first: float) -> Specimen:
    """Return the specimen with a size effect down to the depth at which the `first` ring of nodes [um] touches."""
    return replace(specimen, shallowest=1e3 * Profile.of(indenter).depth_for(first))
