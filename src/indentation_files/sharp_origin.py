"""Where the law of a sharp tip begins, extrapolated from the loading curve."""

from __future__ import annotations

import numpy as np

from indentation_files.correlated_errors import Series, shared_coefficient

STARTS = (0.05, 0.1, 0.2, 0.4)  # of the largest load, where a fit begins
MAIN = 0.1  # the one of them that gives the estimate
LEVELS = 400  # of the load, even
RISING = 4  # points that determine a law


def sharp_origin(load: np.ndarray, depth: np.ndarray) -> tuple[float, float, float]:
    r"""Return the depth where a sharp tip's law :math:`P = C (h - h_0)^2` begins, and its 95 % interval [nm].

    Any body without a length or a time obeys it under a cone or pyramid while the load grows. Creep, as in every
    polymer, moves the origin to smaller depths, further than the interval allows. Load and depth (n,) are in mN and nm,
    the frame's deflection taken off.

    The points are those that reach each of 400 levels of load first (so holds and reloading count little), above a
    tenth of the largest load. Their errors are correlated, by an unknown amount
    (`indentation_files.correlated_errors`). The interval covers that, and how the origin moves when the fit begins at
    5, 20 or 40 % instead: a blunt tip, a film or a yielding frame shows there, which the residuals alone do not show.
    All three are NaN where fewer than four points rise to the largest load.
    """
    largest = np.maximum.accumulate(load)
    origins = {}
    for start in STARTS:
        levels = np.linspace(start, 1.0, LEVELS) * largest[-1]
        chosen = np.unique(np.searchsorted(largest, levels))
        if len(chosen) < RISING:
            return (np.nan,) * 3
        found = shared_coefficient([Series(depth[chosen], np.ones(len(chosen)), np.sqrt(load[chosen])[:, None])])
        origins[start] = found.value, found.half
    (origin, half), others = origins[MAIN], [value for value, _ in origins.values()]
    return origin, min(origin - half, *others), max(origin + half, *others)
