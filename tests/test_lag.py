"""The lag of the depth behind the load at reversals, on bodies whose lag is known."""

import numpy as np
import pytest

from palpate.recordings.lag import lag_at_reversals

STEP = 0.05


def pressed(lag, seed, cycles=1, step=STEP):
    """Time, load and depth of a body that yields: depth as the square root of a load that acts `lag` seconds late."""
    rng = np.random.default_rng(seed)
    knots = np.concatenate([[0.0], *([20 * k + np.array([8.0, 10.0, 18.0]) for k in range(cycles)])])
    loads = np.concatenate([[0.0], *([2.0, 2.0, 0.3] for _ in range(cycles))])
    time = np.arange(0.0, knots[-1], step)
    acting = np.interp(time - lag, knots, loads)
    largest = np.maximum.accumulate(acting)
    depth = 500 * np.sqrt(largest / 2) - 40 * (largest - acting)
    load = np.interp(time, knots, loads) + 5e-4 * rng.standard_normal(len(time))
    return time, load, depth + 0.1 * rng.standard_normal(len(time))


@pytest.mark.parametrize("lag", [0.0, 0.06, 0.3])
def test_the_lag_lies_in_its_interval_and_is_known_to_a_fifth_of_a_step(lag):
    found = [lag_at_reversals([pressed(lag, seed) for seed in range(10 * k, 10 * k + 3)]) for k in range(8)]
    assert sum(one.lower <= lag <= one.upper for one in found) >= 6, "of 8, at 95 %"
    assert np.median([abs(one.lag - lag) for one in found]) < STEP / 5


def test_cycles_give_as_many_reversals():
    assert lag_at_reversals([pressed(0.06, 1, cycles=3)]).reversals == 5


def test_a_test_that_is_never_unloaded_shows_no_lag():
    time = np.linspace(0.0, 10.0, 200)
    assert lag_at_reversals([(time, time**2, 100 * time)]) is None
