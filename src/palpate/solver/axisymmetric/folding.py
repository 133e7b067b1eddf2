"""What to do where the innermost elements fold: put fewer and wider ones in their place.

The first elements to touch are there to resolve the first contact; later the flank carries nearly all of the load. At
large strains a body that yields flows out from the axis along the tip many times as far as these elements are wide,
until they turn inside out: under a rounded tip where it does not harden, as the cap is convex, and under tips as sharp
as a corner of a cube. Under a rounded tip five even rings in place of ten change the depth by a thousandth at the
smallest contact that counts, and by less than 1e-4 once that has doubled.
"""

from __future__ import annotations

import math

import numpy as np

from palpate.solver.axisymmetric.mesh import Resolution

RINGS = 5
DOUBLINGS = {True: 2, False: 3}  # under sharp tips and others


def mergings(sharp: bool, large: bool) -> int:
    """Return how many times the innermost rings may be merged under a `sharp` tip or another, at `large` strains."""
    return DOUBLINGS[sharp] if large else 0


def merged(radii: np.ndarray, resolution: Resolution, rounded: bool, times: int) -> np.ndarray:
    """Return the `radii` of the rings with the innermost merged so many times, or as they are; all beyond stay.

    Under a `rounded` tip what is merged reaches to the smallest contact that counts, then twice and four times as far.
    Under a sharp one the innermost ring becomes twice and four times as wide.

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
    doubled = math.log(2.0) / math.log(resolution.growth)
    if not rounded:
        return radii[round(times * doubled) :]
    last = resolution.even - 1 + round((times - 1) * doubled)
    return np.concatenate([radii[last] * np.arange(1, RINGS) / RINGS, radii[last:]])
