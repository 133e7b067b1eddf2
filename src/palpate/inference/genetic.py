"""The genetic algorithm of the thesis, with one objective (ranked by value) or several (NSGA-II)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from deap import base, tools

from palpate.errors import InputError
from palpate.inference import genetic_operators
from palpate.inference.nsga2 import best_first, ranks

Evaluate = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class GeneticSettings:
    """Numbers of the genetic algorithm; the defaults are those of the thesis (chapter 4).

    Parameters
    ----------
    population
        Number of individuals, all subpopulations together.
    generations
        Largest number of generations.
    subpopulations
        Number of equal parts that evolve side by side. The thesis does not give it; with 1 there is no migration.
    tournament
        Number of entrants of a tournament.
    crossover_fraction
        Share of the children made by crossover; the others are mutants.
    crossover_ratio
        Ratio of the intermediate crossover.
    mutation_scale, mutation_shrink
        Standard deviation of the first mutation in units of the range, and the share it has lost at the last one.
    migration_fraction, migration_interval
        Share of a subpopulation whose copies replace the worst of the next one, and the generations between.
    tolerance
        The search ends early when, over `stall_generations`, the best value of no objective, nor of their sum, has
        changed by more than this fraction; 0 never ends early.
    stall_generations
        See `tolerance`; MATLAB's default for several objectives.
    """

    population: int = 200
    generations: int = 600
    subpopulations: int = 4
    tournament: int = 2
    crossover_fraction: float = 0.8
    crossover_ratio: float = 1.0
    mutation_scale: float = 1.0
    mutation_shrink: float = 1.0
    migration_fraction: float = 0.2
    migration_interval: int = 20
    tolerance: float = 1e-4
    stall_generations: int = 100

    def __post_init__(self) -> None:
        for field in fields(self):
            value, whole = getattr(self, field.name), field.type == "int"
            if value < whole or (field.name.endswith(("fraction", "shrink")) and value > 1):
                raise InputError(
                    f"{field.name} is {value!r}", remedy="see GeneticSettings for its meaning", place=field.name
                )
        if self.population % self.subpopulations or self.population < 4 * self.subpopulations:
            raise InputError(
                f"population {self.population} cannot be split into {self.subpopulations} equal parts of 4 or more",
                remedy="change population or subpopulations",
                place="subpopulations",
            )


@dataclass(frozen=True, eq=False)
class Evolution:
    """What the search found.

    Attributes
    ----------
    points : ndarray, shape (n, dimensions)
        The Pareto front, in coordinates scaled to [0, 1]; with one objective the best point.
    objectives : ndarray, shape (n, m)
        Their objectives.
    history : deap.tools.Logbook
        For each generation: `generation`, `evaluations` so far, `best` value of each objective, `best_sum`.
    """

    points: np.ndarray
    objectives: np.ndarray
    history: tools.Logbook


def operators(settings: GeneticSettings, rng: np.random.Generator) -> base.Toolbox:
    """Operators of the search; each works on a whole (sub)population at once."""
    part = settings.population // settings.subpopulations
    toolbox = base.Toolbox()
    toolbox.register("population", genetic_operators.uniform, rng)
    toolbox.register("select", genetic_operators.tournament, rng, entrants=settings.tournament)
    toolbox.register("mate", genetic_operators.intermediate, rng, ratio=settings.crossover_ratio)
    toolbox.register("mutate", genetic_operators.gaussian, rng)
    toolbox.register(
        "migrate",
        tools.migRing,
        k=round(settings.migration_fraction * part),
        selection=lambda rows, k: rows[:k],
        replacement=lambda rows, k: rows[len(rows) - k :],
    )
    return toolbox


def breed(toolbox: base.Toolbox, parents: np.ndarray, crossovers: int, deviation: float) -> np.ndarray:
    """As many children as there are parents (n, dimensions), which are sorted best first.

    Parameters
    ----------
    toolbox
        Operators, see `operators`.
    parents : ndarray, shape (n, dimensions)
        Sorted best first.
    crossovers
        Number of children by crossover; the others are mutants.
    deviation
        Standard deviation of the mutation, in units of the range.
    """
    n = len(parents)
    first, second = (parents[toolbox.select(n, crossovers)] for _ in range(2))
    mutants = parents[toolbox.select(n, n - crossovers)]
    return np.vstack([toolbox.mate(first, second), toolbox.mutate(mutants, deviation=deviation)])


def evolve(evaluate: Evaluate, dimensions: int, settings: GeneticSettings, rng: np.random.Generator) -> Evolution:
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
    toolbox = operators(settings, rng)
    parts, size = settings.subpopulations, settings.population // settings.subpopulations
    crossovers = round(settings.crossover_fraction * size)
    points = toolbox.population(settings.population, dimensions)
    objectives = evaluate(points)
    places = np.arange(settings.population).reshape(parts, size)
    members = np.array([rows[best_first(objectives[rows])] for rows in places])
    history = tools.Logbook()
    record(history, objectives)
    for generation in range(1, settings.generations + 1):
        if stalled(history, settings):
            break
        spread = genetic_operators.deviation(
            generation, settings.generations, settings.mutation_scale, settings.mutation_shrink
        )
        children = np.vstack([breed(toolbox, points[rows], crossovers, spread) for rows in members])
        all_points = np.vstack([points[members.ravel()], children])
        all_objectives = np.vstack([objectives[members.ravel()], evaluate(children)])
        pools = np.hstack([places, places + settings.population])
        survivors = np.vstack([rows[best_first(all_objectives[rows])[:size]] for rows in pools])
        points, objectives, members = all_points[survivors.ravel()], all_objectives[survivors.ravel()], places
        if parts > 1 and generation % settings.migration_interval == 0:
            rows = members.tolist()
            toolbox.migrate(rows)
            members = np.array([row[best_first(objectives[row])] for row in np.array(rows)])
        record(history, objectives)
    rank = ranks(objectives)
    _, unique = np.unique(points[rank == 0], axis=0, return_index=True)
    return Evolution(points[rank == 0][unique], objectives[rank == 0][unique], history)


def record(history: tools.Logbook, objectives: np.ndarray) -> None:
    """Add a generation to the history."""
    generation = len(history)
    history.record(
        generation=generation,
        evaluations=(generation + 1) * len(objectives),
        best=[float(value) for value in objectives.min(axis=0)],
        best_sum=float(objectives.sum(axis=1).min()),
    )


def stalled(history: tools.Logbook, settings: GeneticSettings) -> bool:
    """Whether the best values have not changed for `stall_generations`."""
    if settings.tolerance == 0 or len(history) <= settings.stall_generations:
        return False
    now, then = (np.append(history[i]["best"], history[i]["best_sum"]) for i in (-1, -1 - settings.stall_generations))
    return bool(np.all(np.abs(now - then) <= settings.tolerance * np.abs(then)))
