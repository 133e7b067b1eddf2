"""The genetic search: its operators' laws, its selection, its convergence to known fronts."""

import random

import numpy as np
import pytest
from deap import tools

from palpate.configuration.settings import CalibrationSettings
from palpate.surrogate.genetic import (
    deviation,
    evolve,
    gaussian,
    individuals,
    intermediate,
    survivors,
    toolbox_of,
)


def of(objectives):
    """Return individuals with these objectives (n, m), each at the point that is its number."""
    return individuals(np.arange(len(objectives))[:, None], lambda points: objectives)


def test_survivors_are_those_of_nsga2_the_best_front_first_and_its_ends_before_what_is_crowded():
    found = of(np.random.default_rng(1).random((60, 3)))
    kept = survivors(found, 30)
    assert {id(each) for each in kept} == {id(each) for each in tools.selNSGA2(found, 30)}
    fronts = tools.sortNondominated(found, 60)
    assert len(fronts) > 2
    front = kept[: len(fronts[0])]
    assert {id(each) for each in front} == {id(each) for each in fronts[0]}
    distances = [each.fitness.crowding_dist for each in front]
    assert distances[0] == np.inf and distances == sorted(distances, reverse=True)


def test_by_one_objective_survivors_are_sorted_by_value():
    kept = survivors(of(np.array([[3.0], [1.0], [2.0], [5.0]])), 3)
    assert [each.point[0] for each in kept] == [1, 2, 0]


def test_intermediate_children_lie_in_their_parents_box():
    rng = np.random.default_rng(0)
    first, second = rng.random((2, 5000, 3))
    share = (intermediate(rng, first, second, 1.0) - first) / (second - first)
    assert share.min() >= 0 and share.max() <= 1
    assert share.mean(axis=0) == pytest.approx(0.5, abs=0.02)
    assert np.corrcoef(share.T)[0, 1] == pytest.approx(0.0, abs=0.05)


def test_mutation_has_the_asked_deviation_and_respects_the_bounds():
    rng = np.random.default_rng(0)
    mutants = gaussian(rng, np.full((20000, 1), 0.5), 0.05)
    assert mutants.std() == pytest.approx(0.05, rel=0.03)
    wide = gaussian(rng, np.full((20000, 1), 0.5), 1.0)
    assert wide.min() >= 0 and wide.max() <= 1
    assert wide.mean() == pytest.approx(0.5, abs=0.01)


def test_mutation_shrinks_linearly_to_nothing():
    half = CalibrationSettings(mutation_scale=2.0, mutation_shrink=0.5)
    assert [deviation(generation, CalibrationSettings()) for generation in (0, 300, 600)] == [1.0, 0.5, 0.0]
    assert deviation(600, half) == 1.0


def test_tournament_of_two_prefers_the_better_half():
    part = survivors(of(np.arange(100.0)[:, None]), 100)
    chosen = toolbox_of(CalibrationSettings(), np.random.default_rng(0)).select(part, 20000)
    assert np.mean([each.point[0] < 50 for each in chosen]) == pytest.approx(0.75, abs=0.015)


def test_migration_copies_the_best_forward_over_the_worst():
    toolbox = toolbox_of(CalibrationSettings(population=20, subpopulations=2), np.random.default_rng(0))
    parts = [list(range(10)), list(range(10, 20))]
    toolbox.migrate(parts)
    assert parts[1] == [*range(10, 18), 0, 1]
    assert parts[0] == [*range(8), 10, 11]


SMALL = CalibrationSettings(population=60, generations=120, subpopulations=3)


def test_front_of_schaffers_problem_is_found_and_spread():
    """Minima of x^2 and (x - 1)^2 apart: every x between them is optimal, with y = 0.3."""

    def evaluate(u):
        x, y = 4.0 * u[:, 0] - 2.0, (u[:, 1] - 0.3) ** 2
        return np.column_stack([x**2 + y, (x - 1.0) ** 2 + y])

    found = evolve(evaluate, 2, SMALL, np.random.default_rng(0))
    x = 4.0 * found.points[:, 0] - 2.0
    assert x.min() == pytest.approx(0.0, abs=0.05) and x.max() == pytest.approx(1.0, abs=0.05)
    assert np.diff(np.sort(x)).max() < 0.15
    assert found.points[:, 1] == pytest.approx(0.3, abs=0.1)
    assert np.abs(found.points[:, 1] - 0.3).mean() < 0.02


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

    settings, state = CalibrationSettings(population=20, generations=25, subpopulations=1), random.getstate()
    runs = [evolve(evaluate, 2, settings, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    assert np.array_equal(runs[0].points, runs[1].points)
    assert not np.array_equal(runs[0].objectives, runs[2].objectives)
    assert set(calls) == {(20, 2)} and len(calls) == 3 * 26
    assert runs[0].history[-1]["evaluations"] == 26 * 20
    assert random.getstate() == state, "DEAP's source of randomness is left as it was"


def test_search_ends_when_it_stalls():
    settings = CalibrationSettings(population=20, generations=500, subpopulations=1, stall_generations=10)
    found = evolve(lambda u: np.ones((len(u), 1)), 2, settings, np.random.default_rng(0))
    assert len(found.history) == 11


@pytest.mark.parametrize(
    "bad",
    [{"population": 0}, {"crossover_fraction": 1.5}, {"tournament": 0}, {"tolerance": -1.0}, {"subpopulations": 7}],
)
def test_bad_settings_name_their_key(bad):
    with pytest.raises(ValueError, match="cannot be split" if "subpopulations" in bad else next(iter(bad))):
        CalibrationSettings(**bad)
