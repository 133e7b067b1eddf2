"""What keeps the innermost elements from folding: fewer and wider ones in their place.

The first elements to touch are there to resolve the first contact; later the flank carries nearly all of the load. At
large strains a body that yields flows out along the tip, from under a sharp apex by about 0.4 of the depth, which in
the end is many times as far as these elements are wide. Where it hardly hardens all that stretch is within the
innermost element. Its neighbours are pushed together, stiffen the body by up to 5 %, and turn inside out. With the
rings merged once the law of cones, depth / sqrt(load) = const, holds within 1 % again; merging disturbs the first
samples alone. A body at large strains is therefore not pursued in ever smaller steps while its rings may still be
merged. Newton's method also finds bodies whose surface overlaps itself, which recover 4 % too little of the depth under
a rounded tip; that is no equilibrium of a body.
"""

from __future__ import annotations

import math

import numpy as np

from palpate.solver.axisymmetric.mesh import Mesh, Resolution

INNERMOST = 0.5  # of the smallest contact, the width of the innermost ring of a mesh that is merged once
MERGINGS = 3  # each but the first of which makes it twice as wide


def mergings(large: bool) -> int:
    """Return how many times the innermost rings may be merged, one wider than the other."""
    return MERGINGS if large else 0


def merged(radii: np.ndarray, resolution: Resolution, rounded: bool, times: int) -> np.ndarray:
    """Return the `radii` of the rings with the innermost merged so many times, or as they are; all beyond stay.

    Under a sharp tip the innermost ring ends at half of the smallest contact that counts, then at once and twice it;
    under a `rounded` one the two innermost do, each half as wide as that contact, then as wide and twice as wide.

    Parameters
    ----------
    radii : ndarray, shape (n,)
        Of the rings.
    resolution
        Of the mesh.
    rounded
        Whether the tip is rounded.
    times
        How many times rings are merged.
    """
    if times == 0:
        return radii
    width, rate = INNERMOST * 2.0 ** (times - 1), math.log(resolution.growth)
    if not rounded:
        return radii[round(math.log(width / resolution.inner) / rate) :]
    last = resolution.even - 1 + round(math.log(2.0 * width) / rate)
    return np.append(0.5 * radii[last], radii[last:])


def upright(mesh: Mesh, displacement: np.ndarray) -> np.ndarray:
    """Return in which lanes no part of the surface has passed its neighbour.

    Parameters
    ----------
    mesh
    displacement : ndarray, shape (size + 1, LANES)
        Of the nodes, by equation.
    """
    radial = displacement[mesh.equations[mesh.surface, 0]]
    return np.all(np.diff(mesh.nodes[mesh.surface, 0, None] + radial, axis=0) > 0.0, axis=0)
