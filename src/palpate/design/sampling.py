"""Points in a box of parameters: full factorial, mid-points of a grid, Sobol sequence, Latin hypercube."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

Point = dict[str, float]


def factorial(levels: Mapping[str, Sequence[float]]) -> list[Point]:
    """Return every combination of the levels, the last parameter running fastest."""
    return [dict(zip(levels, point, strict=True)) for point in itertools.product(*levels.values())]


def midpoints(levels: Mapping[str, Sequence[float]]) -> list[Point]:
    """Return the centre of every cell of the grid; a parameter with one level keeps it."""
    halfway = {
        name: [0.5 * (a + b) for a, b in itertools.pairwise(values)] or list(values) for name, values in levels.items()
    }
    return factorial(halfway)


def sobol(bounds: Mapping[str, tuple[float, float]], count: int, seed: int) -> list[Point]:
    """Return the first `count` points of a scrambled Sobol sequence; a longer sequence begins with a shorter one."""
    from scipy.stats import qmc

    unit = qmc.Sobol(len(bounds), rng=np.random.default_rng(seed)).random_base2(int(np.ceil(np.log2(count))))[:count]
    return _within(bounds, unit)


def latin_hypercube(bounds: Mapping[str, tuple[float, float]], count: int, seed: int) -> list[Point]:
    """Return a Latin hypercube: every parameter visits each of `count` equal parts of its range once."""
    from scipy.stats import qmc

    return _within(bounds, qmc.LatinHypercube(len(bounds), rng=np.random.default_rng(seed)).random(count))


def _within(bounds: Mapping[str, tuple[float, float]], unit: np.ndarray) -> list[Point]:
    lower, upper = np.array(list(bounds.values()), dtype=float).T
    return [dict(zip(bounds, map(float, row), strict=True)) for row in lower + unit * (upper - lower)]
