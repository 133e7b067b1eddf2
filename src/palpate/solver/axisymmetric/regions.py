"""Which law holds in which element of a specimen's mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from palpate.materials.flow.row import in_series
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.indenter import Indenter
from palpate.study.specimen import Specimen


class Divided(Protocol):
    """A mesh, in the plane or in space."""

    def share_above(self, height: float) -> np.ndarray:
        """Return the share (m,) of each element's volume above z = `height`."""


def laws_of(specimen: Specimen, mesh: Divided, unit: float = 1.0) -> np.ndarray:
    """Return the law of the body (1, c), or that of each element (m, c) of a mesh in `unit` um.

    An element that the interface cuts holds film and substrate in series, by their shares of its volume.
    """
    if specimen.substrate is None:
        return specimen.coefficients[None, :]
    share = mesh.share_above(-1e-3 * specimen.film_thickness / unit)
    return in_series(specimen.coefficients, specimen.substrate, share)


def resolved(specimen: Specimen, indenter: Indenter, first: float) -> Specimen:
    """Return the specimen with a size effect down to the depth at which the `first` ring of nodes [um] touches."""
    return replace(specimen, shallowest=1e3 * Profile.of(indenter).depth_for(first))
