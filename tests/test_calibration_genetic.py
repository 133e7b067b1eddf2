"""The genetic search: its operators' laws, its selection against DEAP's, its convergence to known fronts."""

import numpy as np
import pytest
from deap import base, tools

from palpate.errors import InputError
from palpate.inference import genetic_operators
from palpate.inference.genetic import GeneticSettings, evolve, operators
from palpate.inference.nsga2 import best_first, crowding, ranks


class Fitness(base.Fitness):
    weights = (-1.0, -1.0, -1.0)


class Individual:
    def __init__(self, values, row):
        self.fitness, self.row = Fitness(values), row


def test_ranks_and_distances_are_those_of_deap():
    objectives = np.random.default_rng(0).integers(0, 12, size=(80, 3)).astype(float)
    objectives = np.unique(objectives, axis=0)
    individuals = [Individual(tuple(values), row) for row, values in enumerate(objectives)]
    rank = ranks(objectives)
    fronts = tools.sortNondominated(individuals, len(individuals))
    assert rank.max() + 1 == len(fronts) > 2
    for level, front in enumerate(fronts):
        assert sorted(ind.row for ind in front) == np.flatnonzero(rank == level).tolist()


def test_crowding_distance_is_that_of_deap():
    objectives = np.random.default_rng(1).random((60, 3))
    individuals = [Individual(tuple(values), row) for row, values in enumerate(objectives)]
    rank = ranks(objectives)
    distance = crowding(objectives, rank)
    for front in tools.sortNondominated(individuals, len(individuals)):
        tools.emo.assignCrowdingDist(front)
    assert distance == pytest.approx([ind.fitness.crowding_dist for ind in individuals])
    order = best_first(objectives)
    assert np.all(np.diff(rank[order]) >= 0)


def test_one_objective_is_ranked_by_value():
    values = np.array([[3.0], [1.0], [2.0], [1.0]])
    assert ranks(values).tolist() == [2, 0, 1, 0]


def test_intermediate_children_lie_in_their_parents_box():
    rng = np.random.default_rng(0)
    first, second = rng.random((2, 5000, 3))
    share = (genetic_operators.intermediate(rng, first, second, 1.0) - first) / (second - first)
    assert share.min() >= 0 and share.max() <= 1
    assert share.mean(axis=0) == pytest.approx(0.5, abs=0.02)
    assert np.corrcoef(share.T)[0, 1] == pytest.approx(0.0, abs=0.05)


def test_mutation_has_the_asked_deviation_and_respects_the_bounds():
    rng = np.random.default_rng(0)
    mutants = genetic_operators.gaussian(rng, np.full((20000, 1), 0.5), 0.05)
    assert mutants.std() == pytest.approx(0.05, rel=0.03)
    wide = genetic_operators.gaussian(rng, np.full((20000, 1), 0.5), 1.0)
    assert wide.min() >= 0 and wide.max() <= 1
    assert wide.mean() == pytest.approx(0.5, abs=0.01)


def test_mutation_shrinks_linearly_to_nothing():
    assert genetic_operators.deviation(0, 600, 1.0, 1.0) == 1.0
    assert genetic_operators.deviation(300, 600, 1.0, 1.0) == 0.5
    assert genetic_operators.deviation(600, 600, 1.0, 1.0) == 0.0
    assert genetic_operators.deviation(600, 600, 2.0, 0.5) == 1.0


def test_tournament_of_two_prefers_the_better_half():
    rows = genetic_operators.tournament(np.random.default_rng(0), 100, 40000, 2)
    assert np.mean(rows < 50) == pytest.approx(0.75, abs=0.01)


def test_migration_copies_the_best_forward_over_the_worst():
    toolbox = operators(GeneticSettings(population=20, subpopulations=2), np.random.default_rng(0))
    rows = [list(range(10)), list(range(10, 20))]
    toolbox.migrate(rows)
    assert rows[1] == [*range(10, 18), 0, 1]
    assert rows[0] == [*range(8), 10, 11]


SMALL = GeneticSettings(population=60, generations=120, subpopulations=3)


def test_front_of_schaffers_problem_is_found_and_spread():
    """Minima of x^2 and (x - 1)^2 apart: every x between them is optimal, with y = 0.3."""

    def evaluate(u):
        x, y = 4.0 * u[:, 0] - 2.0, (u[:, 1] - 0.3) ** 2
        return np.column_stack([x**2 + y, (x - 1.0) ** 2 + y])

    found = evolve(evaluate, 2, SMALL, np.random.default_rng(0))
    x = 4.0 * found.points[:, 0] - 2.0
    assert x.min() == pytest.approx(0.0, abs=0.05) and x.max() == pytest.approx(1.0, abs=0.05)
    assert np.diff(np.sort(x)).max() < 0.15
    assert found.points[:, 1] == pytest.approx(0.3, abs=0.05)


def test_single_objective_is_found_and_never_gets_worse():
    found = evolve(lambda u: np.sum((u - 0.3) ** 2, axis=1, keepdims=True), 4, SMALL, np.random.default_rng(0))
    best = [entry["best_sum"] for entry in found.history]
    assert np.all(np.diff(best) <= 0)
    assert found.points[0] == pytest.approx(0.3, abs=0.01)


def test_same_seed_same_search_and_a_generation_at_a_time():
    calls = []

    def evaluate(u):
        calls.append(u.shape)
        return np.column_stack([u[:, 0], 1.0 - u[:, 0] + u[:, 1]])

    settings = GeneticSettings(population=20, generations=25, subpopulations=1)
    runs = [evolve(evaluate, 2, settings, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    assert np.array_equal(runs[0].points, runs[1].points)
    assert not np.array_equal(runs[0].objectives, runs[2].objectives)
    assert set(calls) == {(20, 2)} and len(calls) == 3 * 26
    assert runs[0].history[-1]["evaluations"] == 26 * 20


def test_search_ends_when_it_stalls():
    settings = GeneticSettings(population=20, generations=500, subpopulations=1, stall_generations=10)
    found = evolve(lambda u: np.ones((len(u), 1)), 2, settings, np.random.default_rng(0))
    assert len(found.history) == 11


@pytest.mark.parametrize(
    "bad",
    [{"population": 0}, {"crossover_fraction": 1.5}, {"tournament": 0}, {"tolerance": -1.0}, {"subpopulations": 7}],
)
def test_bad_settings_name_their_key(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        GeneticSettings(**bad)
