"""A multi-objective genetic algorithm with the thesis' operators, put together in DEAP's toolbox.

Selection by rank and crowding is NSGA-II (Deb, Pratap, Agarwal & Meyarivan, IEEE Trans. Evol. Comput. 6 (2002)
182-197). All operators work on a whole generation at once: a population is an array (n, d) in units of the range, its
objectives an array (n, k); with one objective the algorithm is an elitist single-objective one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from deap import base, tools


@dataclass(frozen=True)
class GeneticSettings:
    """Numbers of the genetic algorithm; the defaults are the thesis'.

    Parameters
    ----------
    population, generations, tournament
        Individuals, generations, individuals in a tournament.
    crossover_fraction, crossover_ratio
        Share of children by intermediate crossover, child = p1 + rand * ratio * (p2 - p1).
    mutation_scale, mutation_shrink
        Standard deviation of the Gaussian mutation in units of the range at the start, and the share of it that is
        lost, linearly, by the last generation.
    islands, migration_fraction, migration_interval
        Subpopulations; every so many generations the best of each replace the worst of the next.
    tolerance, stall_generations
        Stop when the best aggregate has improved by less than this fraction over so many generations.
    """

    population: int = 200
    generations: int = 600
    tournament: int = 2
    crossover_fraction: float = 0.8
    crossover_ratio: float = 1.0
    mutation_scale: float = 1.0
    mutation_shrink: float = 1.0
    islands: int = 2
    migration_fraction: float = 0.2
    migration_interval: int = 20
    tolerance: float = 1e-4
    stall_generations: int = 100


@dataclass(frozen=True, eq=False)
class Evolution:
    """Outcome of a run.

    Attributes
    ----------
    best : ndarray, shape (d,)
        The individual with the least mean objective.
    front, front_objectives : ndarray, shape (m, d) and (m, k)
        Individuals that no other dominates.
    history : deap.tools.Logbook
        Least and mean aggregate, and evaluations so far, of each generation.
    evaluations : int
    """

    best: np.ndarray
    front: np.ndarray
    front_objectives: np.ndarray
    history: tools.Logbook
    evaluations: int


def ranks(objectives: np.ndarray) -> np.ndarray:
    """Return the front of each individual, 0 for those that none dominates; objectives are minimised."""
    no_worse = np.all(objectives[:, None] <= objectives[None], axis=-1)
    dominates = no_worse & ~no_worse.T
    rank = np.full(len(objectives), -1)
    waiting = dominates.sum(axis=0)
    front = 0
    while (rank < 0).any():
        members = (waiting == 0) & (rank < 0)
        rank[members] = front
        waiting -= dominates[members].sum(axis=0)
        front += 1
    return rank


def crowding(objectives: np.ndarray, rank: np.ndarray) -> np.ndarray:
    """Return the crowding distance of each individual within its front; infinite at the ends."""
    distance = np.zeros(len(objectives))
    for column in objectives.T:
        order = np.lexsort((column, rank))
        value, front = column[order], rank[order]
        gap = np.full(len(order), np.inf)
        inside = (front[2:] == front[1:-1]) & (front[:-2] == front[1:-1])
        starts = np.flatnonzero(np.r_[True, front[1:] != front[:-1]])
        ends = np.r_[starts[1:], len(front)] - 1
        width = np.repeat(value[ends] - value[starts], ends - starts + 1)[1:-1]
        gap[1:-1] = np.where(inside, (value[2:] - value[:-2]) / np.where(width > 0, width, 1.0), np.inf)
        distance[order] += gap
    return distance


def survivors(objectives: np.ndarray, count: int) -> np.ndarray:
    """Return the `count` best individuals, by front and then by crowding, best first."""
    rank = ranks(objectives)
    return np.lexsort((-crowding(objectives, rank), rank))[:count]


def tournament(size: int, count: int, contestants: int, rng: np.random.Generator) -> np.ndarray:
    """Return winners of tournaments among `size` individuals sorted from best to worst."""
    return rng.integers(size, size=(count, contestants)).min(axis=1)


def intermediate_crossover(first: np.ndarray, second: np.ndarray, ratio: float, rng: np.random.Generator) -> np.ndarray:
    """Return children p1 + rand * ratio * (p2 - p1), with one random number a coordinate."""
    return np.clip(first + rng.random(first.shape) * ratio * (second - first), 0.0, 1.0)


def gaussian_mutation(parents: np.ndarray, deviation: float, rng: np.random.Generator) -> np.ndarray:
    """Return parents with Gaussian noise of standard deviation `deviation`, in units of the range, on each coordinate."""
    return np.clip(parents + deviation * rng.standard_normal(parents.shape), 0.0, 1.0)


def evolve(
    evaluate: Callable[[np.ndarray], np.ndarray],
    lower: np.ndarray,
    upper: np.ndarray,
    settings: GeneticSettings,
    rng: np.random.Generator,
) -> Evolution:
    """Minimise.

    Parameters
    ----------
    evaluate
        Maps parameters (n, d) of a whole generation to objectives (n, k).
    lower, upper : ndarray, shape (d,)
        Bounds.
    """
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    toolbox = base.Toolbox()
    toolbox.register("evaluate", lambda unit: evaluate(lower + unit * (upper - lower)))
    toolbox.register("select", tournament, contestants=settings.tournament, rng=rng)
    toolbox.register("mate", intermediate_crossover, ratio=settings.crossover_ratio, rng=rng)
    toolbox.register("mutate", gaussian_mutation, rng=rng)
    history = tools.Logbook()
    sizes = [len(part) for part in np.array_split(np.arange(settings.population), settings.islands)]
    islands = [rng.random((size, len(lower))) for size in sizes]
    objectives = np.split(toolbox.evaluate(np.concatenate(islands)), np.cumsum(sizes)[:-1])
    for i, size in enumerate(sizes):
        order = survivors(objectives[i], size)
        islands[i], objectives[i] = islands[i][order], objectives[i][order]
    evaluations = settings.population
    _record(history, 0, objectives, evaluations)
    for generation in range(1, settings.generations + 1):
        deviation = settings.mutation_scale * (1 - settings.mutation_shrink * generation / settings.generations)
        broods = [_children(island, toolbox, settings.crossover_fraction, deviation) for island in islands]
        scores = np.split(toolbox.evaluate(np.concatenate(broods)), np.cumsum(sizes)[:-1])
        for i, size in enumerate(sizes):
            everyone = np.concatenate([islands[i], broods[i]])
            values = np.concatenate([objectives[i], scores[i]])
            order = survivors(values, size)
            islands[i], objectives[i] = everyone[order], values[order]
        evaluations += settings.population
        if settings.islands > 1 and generation % settings.migration_interval == 0:
            _migrate(islands, objectives, settings.migration_fraction)
        _record(history, generation, objectives, evaluations)
        if _stalled(history, settings):
            break
    everyone, values = np.concatenate(islands), np.concatenate(objectives)
    front = ranks(values) == 0
    scale = upper - lower
    return Evolution(
        lower + scale * everyone[np.argmin(values.mean(axis=1))],
        lower + scale * everyone[front],
        values[front],
        history,
        evaluations,
    )


def _children(island: np.ndarray, toolbox: base.Toolbox, fraction: float, deviation: float) -> np.ndarray:
    crossed = round(fraction * len(island))
    mothers, fathers = (island[toolbox.select(len(island), crossed)] for _ in range(2))
    mutants = island[toolbox.select(len(island), len(island) - crossed)]
    return np.concatenate([toolbox.mate(mothers, fathers), toolbox.mutate(mutants, deviation)])


def _migrate(islands: list[np.ndarray], objectives: list[np.ndarray], fraction: float) -> None:
    """Copy the best of each island over the worst of the next, forward and around; islands are sorted."""
    moving = [round(fraction * len(island)) for island in islands]
    best = [
        (island[:n].copy(), values[:n].copy()) for island, values, n in zip(islands, objectives, moving, strict=True)
    ]
    for i, (individuals, values) in enumerate(best):
        target = (i + 1) % len(islands)
        count = min(len(individuals), len(islands[target]))
        if count:
            islands[target][-count:], objectives[target][-count:] = individuals[:count], values[:count]
            order = survivors(objectives[target], len(islands[target]))
            islands[target], objectives[target] = islands[target][order], objectives[target][order]


def _record(history: tools.Logbook, generation: int, objectives: list[np.ndarray], evaluations: int) -> None:
    aggregate = np.concatenate(objectives).mean(axis=1)
    history.record(
        generation=generation, least=float(aggregate.min()), mean=float(aggregate.mean()), evaluations=evaluations
    )


def _stalled(history: tools.Logbook, settings: GeneticSettings) -> bool:
    if len(history) <= settings.stall_generations:
        return False
    before, now = history[-1 - settings.stall_generations]["least"], history[-1]["least"]
    return before - now <= settings.tolerance * abs(before)
