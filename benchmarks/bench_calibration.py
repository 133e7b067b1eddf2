"""Cost of the genetic search: 600 generations x 200 individuals on four conditions, on one core."""

import itertools

import numpy as np
import pytest

from palpate.surrogate import PODRBF
from palpate.surrogate.genetic import GeneticSettings, evolve

TIME = np.linspace(0.01, 1.0, 100)


def curves(x, stretch):
    return 500 * np.sqrt(TIME * stretch * (1 / x[:, :1] + 3 * x[:, 1:2] * TIME * (1 - x[:, 2:3]) + 0.1 * x[:, 3:4]))


@pytest.mark.parametrize("aggregated", [False, True])
def test_six_hundred_generations(benchmark, aggregated):
    levels = ([3.0, 3.25, 3.5], [0.02, 0.045, 0.07, 0.1], [0.15, 0.217, 0.283, 0.35], [0.15, 0.25, 0.35], [0.2, 0.8])
    grid = np.array(list(itertools.product(*levels)))
    lower, upper = grid.min(axis=0), grid.max(axis=0)
    models = [PODRBF().fit(grid, curves(grid, k)) for k in (1.0, 1.1, 1.2, 1.5)]
    recorded = [curves(grid[100:101] * 1.02, k) for k in (1.0, 1.1, 1.2, 1.5)]

    def evaluate(unit):
        x = lower + unit * (upper - lower)
        scores = np.stack([np.mean((m.predict(x) - r) ** 2, axis=1) for m, r in zip(models, recorded, strict=True)], 1)
        return scores.sum(axis=1, keepdims=True) if aggregated else scores

    settings = GeneticSettings(tolerance=0.0)
    run = benchmark.pedantic(evolve, args=(evaluate, 5, settings, np.random.default_rng(0)), rounds=1)
    benchmark.extra_info["evaluations"] = int(run.history[-1]["evaluations"])
