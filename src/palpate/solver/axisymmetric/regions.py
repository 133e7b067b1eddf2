"""Which law holds in which element of a specimen's mesh."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Protocol

import numpy as np

from palpate.materials.flow.row import BULK, SHEAR, in_series
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.indenter import Indenter
from palpate.study.specimen import Specimen

LAYERS = np.append(0.0, np.geomspace(1e-4, 12.0, 48))  # of a skin, where they end in its depths; chosen


class Divided(Protocol):
    """A mesh, in the plane or in space."""

    def share_above(self, height: float) -> np.ndarray:
        """Return the share (m,) of each element's volume above z = `height`."""


def laws_of(specimen: Specimen, mesh: Divided, unit: float = 1.0) -> np.ndarray:
    """Return the law of the body (1, c), or that of each element (m, c) of a mesh in `unit` um.

    An element that the interface cuts holds film and substrate in series, by their shares of its volume; so it holds
    the layers of a skin.
    """
    if specimen.is_uniform:
        return specimen.coefficients[None, :]

    def above(depth: float) -> np.ndarray:
        return mesh.share_above(-1e-3 * depth / unit)

    if specimen.substrate is None:
        laws = np.tile(specimen.coefficients, (len(above(0.0)), 1))
    else:
        laws = in_series(specimen.coefficients, specimen.substrate, above(specimen.film_thickness))
    if specimen.skin_depth:
        ends = specimen.skin_depth * LAYERS
        shares = np.diff([above(depth) for depth in ends], axis=0)
        softer = [specimen.softening(*pair) - 1.0 for pair in itertools.pairwise(ends)]
        laws[:, [SHEAR, BULK]] /= 1.0 + (softer @ shares)[:, None]
    return laws


def resolved(specimen: Specimen, indenter: Indenter, first: float) -> Specimen:
    """Return the specimen with a size effect down to the depth at which the `first` ring of nodes [um] touches."""
    return replace(specimen, shallowest=1e3 * Profile.of(indenter).depth_for(first))
