"""Steps of least squares within limits, against SciPy's bounded linear least squares."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from palpate.inference.search_state import SearchState, Steps


def steps(rng, limits):
    """Return the steps of a random problem with correlated slopes, from the middle of the limits."""
    slopes = rng.standard_normal((8, 3)) @ np.array([[1.0, 0.9, 0.0], [0.0, 0.3, 0.2], [0.0, 0.0, 1.0]])
    least, largest = np.full(3, -limits), np.full(3, limits)
    misfit = SimpleNamespace(coordinates=SimpleNamespace(limits=(least, largest)))
    return Steps(misfit, np.zeros(3), np.eye(8), rng.standard_normal(8), slopes)


@pytest.mark.parametrize("limit", [0.05, 0.2, 5.0])
def test_coordinates_that_would_leave_the_limits_end_there_and_the_others_make_the_best_of_it(limit):
    """So no step predicts an increase, which would count as convergence."""
    rng, shares = np.random.default_rng(3), []
    for _ in range(100):
        problem = steps(rng, limit)
        best = lsq_linear(problem.slopes, -problem.residual, bounds=(-limit, limit))
        shares.append(problem.predicted_decrease(problem.end(100.0)) / problem.predicted_decrease(best.x))
    assert min(shares) > 0.5
    assert np.quantile(shares, 0.1) > 0.95


def test_a_step_too_short_to_tell_a_slope_from_the_error_of_a_curve_leaves_the_tangent():
    """Curves of bodies that almost yield jump by a thousandth; over a step of 1e-9 that is no slope."""
    for length, kept in ((1e-9, True), (1e-2, False)):
        search = SearchState(np.zeros(2), np.zeros(5), np.ones((5, 2)))
        search.move(np.array([length, 0.0]), np.full(5, 3.0))
        assert np.array_equal(search.tangent, np.ones((5, 2))) == kept
        assert np.array_equal(search.curve, np.full(5, 3.0)) and not search.exact
