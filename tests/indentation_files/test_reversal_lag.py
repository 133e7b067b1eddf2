"""The lag of the depth behind the load, on tests in closed form that creep, with and without a lag."""

import numpy as np
import pytest
from scipy.signal import lfilter
from wilson import wilson

from indentation_files.recording import Recording
from indentation_files.reversal_lag import reversal_lag

COMPLIANCES = {
    "elastic": lambda age: np.ones_like(age),
    "burgers": lambda age: 1.0 + 0.3 * (1.0 - np.exp(-age / 12.0)) + 0.004 * age,
}


def cone(rng, lag, law="burgers", largest=4.0, rise=30.0, hold=20.0, points=100, noise=1.0):
    """A recording of h^2 = J * dP, with noise that neighbours share, of the load `lag` seconds ago."""
    end = 2.0 * rise + hold
    time, fine = np.linspace(0.0, end, points + 1), np.linspace(0.0, end, 4001)
    corners = np.array([0.0, rise, rise + hold + 1e-9, end + 1e-9])

    def load(moment):
        return np.interp(moment, corners, [0.0, largest, largest, 0.0])

    steps, size = np.diff(load(np.maximum(fine - lag, 0.0))), len(fine) - 1
    age = fine[1:] - 0.5 * fine[1]
    square = np.fft.irfft(np.fft.rfft(steps, 2 * size) * np.fft.rfft(COMPLIANCES[law](age), 2 * size), 2 * size)[:size]
    depth = 400.0 * np.sqrt(np.maximum(np.append(0.0, square), 0.0)) * (1.0 + 0.01 * rng.standard_normal())
    errors = lfilter([1.0], [1.0, -0.7], rng.standard_normal(points + 1)) * noise * np.sqrt(1.0 - 0.7**2)
    errors[0] = 0.0
    return Recording(time, load(time), np.interp(time, fine, depth) + errors)


@pytest.mark.parametrize("hold", [0.0, 20.0])
@pytest.mark.parametrize("lag", [0.0, 0.5])
def test_a_planted_lag_is_found(lag, hold):
    rng = np.random.default_rng(5)
    found = reversal_lag([cone(rng, lag, hold=hold, rise=rise) for rise in (10.0, 30.0) for _ in range(3)])
    assert found.lag == pytest.approx(lag, abs=0.05)
    assert found.lower <= lag <= found.upper
    assert found.upper - found.lower < 0.2


def test_it_does_not_stick_where_the_load_begins_to_rise():
    """A lag shorter than the first interval of the samples, and one of several of them."""
    rng = np.random.default_rng(6)
    for lag in (0.2, 2.5):
        assert reversal_lag([cone(rng, lag) for _ in range(3)]).lag == pytest.approx(lag, abs=0.1)


def test_the_interval_holds_no_lag_where_there_is_none():
    rng, draws = np.random.default_rng(7), 60
    found = [reversal_lag([cone(rng, 0.0, law) for _ in range(2)]) for law in COMPLIANCES for _ in range(draws // 2)]
    held = sum(each.lower <= 0.0 <= each.upper for each in found)
    assert wilson(held, draws)[1] >= 0.95


def test_a_test_without_a_corner_shows_none():
    time = np.linspace(0.0, 30.0, 100)
    assert reversal_lag([Recording(time, time, np.sqrt(time))]) is None


@pytest.mark.parametrize("lag", [0.0, 0.06, 0.3])
@pytest.mark.parametrize("cycles", [1, 3])
def test_a_lag_of_a_body_that_yields_is_known_to_a_fifth_of_a_step(lag, cycles):
    step, found = 0.05, []
    for seed in range(4):
        rng = np.random.default_rng([seed, cycles])
        found.append(reversal_lag([yielding(rng, lag, cycles, step) for _ in range(3)]))
    assert all(one.lower <= lag <= one.upper for one in found)
    assert np.median([abs(one.lag - lag) for one in found]) < step / 5


def yielding(rng, lag, cycles, step):
    """A recording of a body that yields: depth as the square root of a load that acts `lag` seconds late."""
    knots = np.concatenate([[0.0], *([20 * k + np.array([8.0, 10.0, 18.0]) for k in range(cycles)])])
    loads = np.concatenate([[0.0], *([2.0, 2.0, 0.3] for _ in range(cycles))])
    time = np.arange(0.0, knots[-1], step)
    acting = np.interp(time - lag, knots, loads)
    largest = np.maximum.accumulate(acting)
    depth = 500 * np.sqrt(largest / 2) - 40 * (largest - acting)
    load = np.interp(time, knots, loads) + 5e-4 * rng.standard_normal(len(time))
    return Recording(time, load, depth + 0.1 * rng.standard_normal(len(time)))
