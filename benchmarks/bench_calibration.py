"""Speed of the surrogate and of the calibration: `pytest benchmarks/bench_calibration.py`, on one core.

The surrogates have the size of the epoxy study: four conditions, 288 snapshots of five free parameters, 100 points.
"""

import itertools

import numpy as np
import pytest

from palpate.calibration import CalibrationSettings, GeneticSettings, Observation, calibrate
from palpate.surrogate import PODRBF

TIME = np.linspace(0.01, 1.0, 100)
LEVELS = {
    "youngs_modulus": np.linspace(3.0, 3.5, 3),
    "steady_coefficient": np.array([0.02, 0.045, 0.07, 0.1]),
    "steady_exponent": np.linspace(0.15, 0.35, 4),
    "transient_coefficient": np.linspace(0.15, 0.35, 3),
    "transient_exponent": np.array([0.2, 0.8]),
}
GRID = np.array(list(itertools.product(*LEVELS.values())))
RATES = {"P1.00_T030": 0.5, "P1.00_T045": 0.75, "P1.00_T060": 1.0, "P1.00_T240": 4.0}
TRUTH = np.array([[3.28, 0.09, 0.20, 0.24, 0.47]])


def curves(parameters, rate):
    """Curves (n, 100) [nm] that depend on the five parameters about as the epoxy's do."""
    e, c, m, ct, mt = parameters.T[:, :, None]
    creep = 1 + 20 * c * TIME ** (1 + m) * rate ** (1 - m) + ct * (1 - np.exp(-4 * TIME * rate))
    return 100 * np.sqrt(TIME * 3 / e) * (creep + 0.05 * mt * TIME**3 * ct)


@pytest.fixture(scope="module")
def surrogates():
    """One surrogate for each condition."""
    return {name: PODRBF().fit(GRID, curves(GRID, rate)) for name, rate in RATES.items()}


def test_fit_one_surrogate(benchmark):
    """Fit on 288 snapshots, shape given."""
    benchmark(PODRBF().fit, GRID, curves(GRID, 1.0))


def test_predict_a_population(benchmark, surrogates):
    """One condition of 200 individuals."""
    population = np.random.default_rng(0).uniform(GRID.min(axis=0), GRID.max(axis=0), (200, 5))
    benchmark(surrogates["P1.00_T030"].predict, population)


@pytest.mark.parametrize("aggregated", [False, True], ids=["nsga2", "aggregated"])
def test_calibrate_600_generations_of_200_on_four_conditions(benchmark, surrogates, aggregated):
    """Whole calibration without forward-model runs; the budget is 15 s."""
    observations = {
        name: Observation(TIME, curves(TRUTH, rate) * (1 + 0.01 * np.random.default_rng(0).normal(size=(3, 1))))
        for name, rate in RATES.items()
    }
    settings = CalibrationSettings(GeneticSettings(tolerance=0.0), aggregated=aggregated)
    bounds = {name: (levels[0], levels[-1]) for name, levels in LEVELS.items()}
    found = benchmark.pedantic(
        lambda: calibrate(surrogates, observations, bounds, rng=np.random.default_rng(0), settings=settings),
        rounds=3,
        iterations=1,
    )
    assert found.evaluations == 601 * 200
