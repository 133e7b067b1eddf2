"""The genetic algorithm of the thesis (its chapter 4) with DEAP; of several objectives by NSGA-II.

DEAP selects, sorts, migrates and records. Its operators work on one individual; those of the thesis (MATLAB's
intermediate crossover and a Gaussian mutation that shrinks) and the objectives are computed for a generation at once. A
mutant that leaves the bounds is reflected back into them, so that the bounds do not collect mutants.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from deap import base, tools

from palpate.configuration.settings import CalibrationSettings

Evaluate = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Evolution:
    """What the search found.

    Attributes
    ----------
    points : ndarray, shape (n, dimensions)
        The Pareto front, in coordinates scaled to [0, 1]; with one objective the best points.
    objectives : ndarray, shape (n, m)
        Their objectives.
    history : deap.tools.Logbook
        For each generation: `generation`, `evaluations` so far, `best` value of each objective, `best_sum`.
    """

    points: np.ndarray
    objectives: np.ndarray
    history: tools.Logbook


@dataclass(eq=False)
class Individual:
    """A point (dimensions,) with its fitness; those of larger `order` win tournaments."""

    point: np.ndarray
    fitness: base.Fitness
    order: int = 0


def evolve(evaluate: Evaluate, dimensions: int, settings: CalibrationSettings, rng: np.random.Generator) -> Evolution:
    """Minimise all objectives over the unit cube; the best of parents and children survive.

    Parameters
    ----------
    dimensions
        Number of parameters.
    settings
        Numbers of the genetic algorithm.
    rng
        Source of randomness.
    evaluate
        Objectives (n, m) of points (n, dimensions) in [0, 1]; called once for each generation.
    """
    toolbox, size = toolbox_of(settings, rng), settings.population // settings.subpopulations
    statistics = tools.Statistics(attrgetter("fitness.values"))
    statistics.register("best", lambda values: np.min(values, axis=0).tolist())
    statistics.register("best_sum", lambda values: float(np.sum(values, axis=1).min()))
    history = tools.Logbook()
    with _seeded(rng):
        parts: list[list[Individual]] = [[] for _ in range(settings.subpopulations)]
        offspring = rng.random((settings.subpopulations, size, dimensions))
        for generation in range(settings.generations + 1):
            children = individuals(offspring.reshape(-1, dimensions), evaluate)
            pools = [part + children[k * size : (k + 1) * size] for k, part in enumerate(parts)]
            parts = [toolbox.survive(pool, size) for pool in pools]
            everyone = [individual for part in parts for individual in part]
            evaluations = (generation + 1) * settings.population
            history.record(generation=generation, evaluations=evaluations, **statistics.compile(everyone))
            if generation == settings.generations or stalled(history, settings):
                break
            if generation and len(parts) > 1 and generation % settings.migration_interval == 0:
                toolbox.migrate(parts)
                parts = [toolbox.survive(part, size) for part in parts]
            spread = deviation(generation + 1, settings)
            offspring = np.array([_children(toolbox, part, settings.crossover_fraction, spread) for part in parts])
    front = tools.ParetoFront(similar=lambda one, other: np.array_equal(one.point, other.point))
    front.update(everyone)
    objectives = np.array([individual.fitness.values for individual in front])
    return Evolution(np.array([individual.point for individual in front]), objectives, history)


def toolbox_of(settings: CalibrationSettings, rng: np.random.Generator) -> base.Toolbox:
    """Operators of the search: `mate` and `mutate` take points (n, dimensions), the others lists of individuals."""
    migrants = round(settings.migration_fraction * settings.population / settings.subpopulations)
    toolbox = base.Toolbox()
    toolbox.register("select", tools.selTournament, tournsize=settings.tournament, fit_attr="order")
    toolbox.register("mate", intermediate, rng, ratio=settings.crossover_ratio)
    toolbox.register("mutate", gaussian, rng)
    toolbox.register("survive", survivors)
    toolbox.register(
        "migrate",
        tools.migRing,
        k=migrants,
        selection=lambda part, k: [toolbox.clone(individual) for individual in part[:k]],
        replacement=lambda part, k: part[len(part) - k :],
    )
    return toolbox


def survivors(individuals: Sequence[Individual], count: int) -> list[Individual]:
    """Return the best individuals, best first: by value, or by front and within one by crowding distance.

    This is NSGA-II's selection (Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182). DEAP's `selNSGA2` is the same, but
    for the order within a front, by which tournaments are won.
    """
    if len(individuals[0].fitness.weights) == 1:
        best = tools.selBest(individuals, count)
    else:
        best = []
        for front in tools.sortLogNondominated(individuals, count):
            tools.emo.assignCrowdingDist(front)
            best += sorted(front, key=attrgetter("fitness.crowding_dist"), reverse=True)
    for place, individual in enumerate(best):
        individual.order = -place
    return best[:count]


def intermediate(rng: np.random.Generator, first: np.ndarray, second: np.ndarray, ratio: float) -> np.ndarray:
    """Children first + rand * ratio * (second - first), `rng` drawing a number for each coordinate; (n, dimensions)."""
    return reflect(first + rng.random(first.shape) * ratio * (second - first))


def gaussian(rng: np.random.Generator, parents: np.ndarray, deviation: float) -> np.ndarray:
    """Mutants: parents (n, dimensions) plus Gaussian noise of `rng`, its deviation in units of the range."""
    return reflect(parents + deviation * rng.standard_normal(parents.shape))


def deviation(generation: int, settings: CalibrationSettings) -> float:
    """Return the standard deviation of a generation's mutation, in units of the range; it shrinks linearly."""
    return settings.mutation_scale * (1.0 - settings.mutation_shrink * generation / settings.generations)


def reflect(points: np.ndarray) -> np.ndarray:
    """Return coordinates (n, dimensions) reflected at the bounds into [0, 1]."""
    periodic = np.mod(points, 2.0)
    return np.where(periodic > 1.0, 2.0 - periodic, periodic)


def stalled(history: tools.Logbook, settings: CalibrationSettings) -> bool:
    """Whether the best values have not changed for `stall_generations`."""
    if settings.tolerance == 0 or len(history) <= settings.stall_generations:
        return False
    now, then = (np.append(history[i]["best"], history[i]["best_sum"]) for i in (-1, -1 - settings.stall_generations))
    return bool(np.all(np.abs(now - then) <= settings.tolerance * np.abs(then)))


def _children(toolbox: base.Toolbox, parents: list[Individual], crossovers: float, deviation: float) -> np.ndarray:
    """Return as many children (n, dimensions) as parents, of which a share comes from crossover; others are mutants."""
    pairs = round(crossovers * len(parents))
    chosen = np.array([individual.point for individual in toolbox.select(parents, pairs + len(parents))])
    mutants = toolbox.mutate(chosen[2 * pairs :], deviation=deviation)
    return np.vstack([toolbox.mate(chosen[:pairs], chosen[pairs : 2 * pairs]), mutants])


def individuals(points: np.ndarray, evaluate: Evaluate) -> list[Individual]:
    """Return individuals at points (n, dimensions) with their objectives, all of them minimised."""
    objectives = evaluate(points)
    kind = type("Minimised", (base.Fitness,), {"weights": (-1.0,) * objectives.shape[1]})
    return [Individual(point, kind(values)) for point, values in zip(points, objectives.tolist(), strict=True)]


@contextmanager
def _seeded(rng: np.random.Generator) -> Iterator[None]:
    """Draw the random numbers of Python's own generator, which DEAP uses, from another one's seed meanwhile."""
    before = random.getstate()
    random.seed(int(rng.integers(2**63)))
    try:
        yield
    finally:
        random.setstate(before)
