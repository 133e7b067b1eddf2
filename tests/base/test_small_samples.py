"""Intervals from few values: how often they hold what is true."""

import numpy as np
import pytest
from wilson import wilson

from palpate.base import small_samples

DRAWS = 400


def holds(intervals, truth):
    """Check that 95 % of the intervals may hold what is true."""
    held = sum(lower <= truth <= upper for _, lower, upper in intervals)
    lower, upper = wilson(held, len(intervals))
    assert upper >= 0.95, f"{held} of {len(intervals)}: {lower:.3f} to {upper:.3f}"


def test_the_difference_of_unequal_groups():
    rng = np.random.default_rng(1)
    groups = [(rng.normal(0.0, 1.0, 3), rng.normal(0.5, 3.0, 4)) for _ in range(DRAWS)]
    holds([small_samples.difference(*pair, 1.0) for pair in groups], 0.5)


def test_single_values_scatter_as_assumed():
    rng = np.random.default_rng(2)
    pairs = [(rng.normal(0.0, 2.0, 1), rng.normal(1.0, 2.0, 1)) for _ in range(DRAWS)]
    holds([small_samples.difference(*pair, 2.0) for pair in pairs], 1.0)


def test_a_slope_with_errors_of_unlike_size():
    rng, places = np.random.default_rng(3), np.repeat([1.0, 2.0, 4.0], 3)
    own = np.ones((9, 1))
    drawn = [0.3 * places + rng.standard_normal(9) / places for _ in range(DRAWS)]
    holds([small_samples.slope(places, values, own) for values in drawn], 0.3)


@pytest.mark.parametrize("deviation", [0.0, 0.5, 3.0])
def test_scatter_beyond_the_errors_of_the_values(deviation):
    rng, variances = np.random.default_rng(4), [0.5, 1.0, 2.0, 1.0]
    drawn = [[rng.normal(0.0, np.sqrt(deviation**2 + variance), 3) for variance in variances] for _ in range(DRAWS)]
    holds([small_samples.scatter(groups, variances) for groups in drawn], deviation)


def test_a_slope_without_enough_values_is_open():
    assert small_samples.slope(np.array([1.0, 2.0]), np.array([1.0, 2.0]), np.ones((2, 1))) is None
