"""What the mesh adds to a simulated curve: it ripples as the edge of contact passes from node to node.

At `accuracy: standard` that is about a thousandth of the depth from one sample to the next, which is much beside the
noise of a good instrument and would pull at the parameters. What two simulations differ by in earnest is smooth.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from palpate.diagnosis.segments import segments
from palpate.protocol import Protocol

DEGREE = 5
EDGE = 3
SHALLOW = 0.02


def without_ripple(protocol: Protocol, difference: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the smooth part of a difference (n_points,) between two simulations [nm].

    Relative to `depth` (n_points,) it becomes a polynomial in each segment. Next to the segments' ends, where something
    may begin at once, and where the indentation is shallow it stays as it is.
    """
    deep = np.abs(depth) > SHALLOW * np.abs(depth).max()
    smooth = difference.copy()
    for where in segments(protocol).values():
        inner = np.flatnonzero(where)[EDGE:-EDGE]
        place = inner[deep[inner]]
        if len(place) > 2 * DEGREE:
            x = np.linspace(-1.0, 1.0, len(place))
            relative = legendre.legfit(x, difference[place] / depth[place], DEGREE)
            smooth[place] = depth[place] * legendre.legval(x, relative)
    return smooth
