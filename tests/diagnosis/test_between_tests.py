"""A value that belongs to single recordings scatters as much between replicates as between tests."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, RECORD_ONLY, fitted, problem, recordings
from scipy.stats import f_oneway

from palpate.diagnosis.between_tests import p_between_tests, p_of_means
from palpate.diagnosis.detect import examine
from palpate.diagnosis.screen import Screen
from palpate.inference.covariance import REFINED

DRIFT = ("thermal_drift",)


def drifting(rate, replicates=3, seed=3):
    """Write recordings with a drift of ``rate(condition number, replicate)`` nm/s."""
    numbers = {condition.name: k for k, condition in enumerate(CONDITIONS)}

    def effect(condition, r):
        return rate(numbers[condition.name], r) * condition.protocol.sample_time

    return problem(recordings(np.random.default_rng(seed), effect, replicates))


def p_of_drift(task):
    return p_between_tests(fitted(task, DRIFT), np.random.default_rng(1)).get("thermal_drift.rate")


@pytest.mark.parametrize("seed", range(5))
def test_it_is_fishers_test_where_precision_is_equal_and_the_simulation_exact(seed):
    rng = np.random.default_rng(seed)
    rows = [rng.normal(0.4 * seed * (k == 1), 1.0, size) for k, size in enumerate((3, 3, 5, 2))]
    found = p_of_means(rows, np.zeros(4), np.zeros((4, 4)), rng)
    assert found == pytest.approx(f_oneway(*rows).pvalue, abs=0.015)


def test_an_error_of_the_simulation_excuses_what_all_replicates_have_in_common():
    rng = np.random.default_rng(2)
    rows = [rng.normal(mean, 1.0, 4) for mean in (-8.0, 0.0, 8.0)]
    assert p_of_means(rows, np.zeros(3), np.zeros((3, 3)), rng) < 0.001
    assert p_of_means(rows, np.zeros(3), 64.0 * np.eye(3), rng) > 0.1


def test_drifts_of_single_recordings_pass():
    """A twentieth of true drifts may fall below 0.05: of 40, a Poisson of mean 2 rarely exceeds 6."""
    rng = np.random.default_rng(8)
    own = rng.normal(1.0, 0.3, (40, len(CONDITIONS), 3))
    p = np.array([p_of_drift(drifting(lambda k, r, o=o: o[k, r], seed=n)) for n, o in enumerate(own)])
    assert np.sum(p < 0.05) <= 6
    assert np.median(p) > 0.2


def test_a_drift_that_follows_the_test_is_no_drift():
    follows = drifting(lambda k, r: (1.0, -0.4, 0.2, 1.5)[k] + 0.01 * r)
    assert p_of_drift(follows) < 0.001
    fit = fitted(follows, DRIFT)
    assert examine(fit, Screen.of(fit, RECORD_ONLY), np.random.default_rng(1), 400, 0.01) < 0.01


def test_what_the_next_refinement_of_the_mesh_may_change_excuses_drifts_that_follow_the_test():
    """Drifts that differ little, and late in each test an error as large as `REFINED` allows for."""
    rng, rejected = np.random.default_rng(8), {"known": 0, "unknown": 0}
    for seed in range(12):
        own = rng.normal(1.0, 0.02, (len(CONDITIONS), 3))
        fit = fitted(drifting(lambda k, r, own=own: own[k, r], seed=seed), DRIFT)
        times = [c.protocol.sample_time for c in fit.problem.conditions]
        depths = fit.problem.split(fit.curve).values()
        changes = [0.02 * depth.max() * (time > 0.7 * time[-1]) for time, depth in zip(times, depths, strict=True)]
        moved = replace(fit, curve=fit.curve + np.concatenate([REFINED * rng.normal() * each for each in changes]))
        for name, share in (("known", 1.0), ("unknown", 0.0)):
            errors = replace(moved.errors, refinements=[share * change for change in changes])
            p = p_between_tests(replace(moved, errors=errors), np.random.default_rng(1))["thermal_drift.rate"]
            rejected[name] += p < 0.01
    assert rejected["known"] <= 1
    assert rejected["unknown"] >= 8


def test_without_replicates_there_is_nothing_to_compare():
    assert p_of_drift(drifting(lambda k, r: (1.0, -0.4, 0.2, 1.5)[k], replicates=1)) is None


def test_a_test_that_was_not_repeated_does_not_count():
    task = drifting(lambda k, r: 1.0 + 0.1 * r)
    far = task.observed["a"].response[:1] + 40.0 * CONDITIONS[0].protocol.sample_time
    task.observed["a"] = type(task.observed["a"])(task.observed["a"].time, far, "calibrate")
    assert p_of_drift(task) > 0.01
