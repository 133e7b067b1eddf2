r"""Genetic operators on a whole generation at once; coordinates are scaled to [0, 1] by the bounds.

They are those of the thesis' chapter 4 (MATLAB's intermediate crossover and Gaussian mutation). A mutant that leaves
the bounds is reflected back into them, so that the bounds do not collect mutants.
"""

from __future__ import annotations

import numpy as np


def uniform(rng: np.random.Generator, size: int, dimensions: int) -> np.ndarray:
    """First generation (size, dimensions), uniform within the bounds."""
    return rng.random((size, dimensions))


def tournament(rng: np.random.Generator, size: int, count: int, entrants: int) -> np.ndarray:
    """Rows (count,) of the winners among `size` individuals that are sorted best first.

    Parameters
    ----------
    rng
        Source of randomness.
    size
        Number of individuals.
    count
        Number of tournaments.
    entrants
        Number of individuals in each.
    """
    return rng.integers(size, size=(count, entrants)).min(axis=1)


def intermediate(rng: np.random.Generator, first: np.ndarray, second: np.ndarray, ratio: float) -> np.ndarray:
    """Children first + rand * ratio * (second - first), a random number for each coordinate; all (n, dimensions).

    Parameters
    ----------
    rng
        Source of randomness.
    first, second : ndarray, shape (n, dimensions)
        Parents.
    ratio
        Ratio of the intermediate crossover.
    """
    return reflect(first + rng.random(first.shape) * ratio * (second - first))


def gaussian(rng: np.random.Generator, parents: np.ndarray, deviation: float) -> np.ndarray:
    """Mutants: parents (n, dimensions) plus Gaussian noise of that standard deviation, in units of the range."""
    return reflect(parents + deviation * rng.standard_normal(parents.shape))


def deviation(generation: int, generations: int, scale: float, shrink: float) -> float:
    """Return the standard deviation of the mutation: from `scale`, linearly, to scale * (1 - shrink) at the end.

    Parameters
    ----------
    generation, generations
        Number of the generation, and of the last one.
    scale, shrink
        Standard deviation of the first mutation in units of the range, and the share it has lost at the last one.
    """
    return scale * (1.0 - shrink * generation / generations)


def reflect(points: np.ndarray) -> np.ndarray:
    """Return coordinates (n, dimensions) reflected at the bounds into [0, 1]."""
    periodic = np.mod(points, 2.0)
    return np.where(periodic > 1.0, 2.0 - periodic, periodic)
