"""A coefficient that series share under correlated errors, against Gauss and Markov's formulas with whole matrices."""

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import block_diag, toeplitz

from indentation_files.correlated_errors import CORRELATIONS, Series, shared_coefficient


def series(rng, lengths, rho, coefficient=0.5):
    """Series with a level of their own and one slope, whose errors are autoregressive."""
    found = []
    for length in lengths:
        common = np.sort(rng.uniform(0.0, 10.0, length))
        error = np.linalg.cholesky(toeplitz(rho ** np.arange(length))) @ rng.standard_normal(length)
        found.append(Series(coefficient * common + rng.normal(0.0, 5.0) + error, common, np.ones((length, 1))))
    return found


@pytest.mark.parametrize("lengths", [(12,), (5, 9, 7)])
def test_it_is_the_restricted_likelihood_s_mean(lengths):
    given = series(np.random.default_rng(2), lengths, 0.6)
    values = np.concatenate([one.values for one in given])
    terms = np.column_stack([np.concatenate([one.common for one in given]), block_diag(*(one.own for one in given))])
    freedom = len(values) - terms.shape[1]
    estimates, variances, restricted, likelihood = [], [], [], []
    for rho in CORRELATIONS:
        covariance = block_diag(*(toeplitz(rho ** np.arange(n)) / (1 - rho**2) for n in lengths))
        information = terms.T @ np.linalg.solve(covariance, terms)
        solution = np.linalg.solve(information, terms.T @ np.linalg.solve(covariance, values))
        left = values - terms @ solution
        power = left @ np.linalg.solve(covariance, left)
        determinant = np.linalg.slogdet(covariance)[1]
        estimates.append(solution[0])
        variances.append(np.linalg.inv(information)[0, 0] * power / freedom)
        restricted.append(-0.5 * (determinant + np.linalg.slogdet(information)[1] + freedom * np.log(power)))
        likelihood.append(-0.5 * (determinant + len(values) * np.log(power / len(values))))
    weight = np.exp(restricted - np.max(restricted))
    weight /= weight.sum()
    value = weight @ estimates
    half = stats.t.ppf(0.975, freedom) * np.sqrt(weight @ (variances + (estimates - value) ** 2))
    found = shared_coefficient(given)
    assert (found.value, found.half) == pytest.approx((value, half), rel=1e-6)
    assert found.likelihood == pytest.approx(np.max(likelihood), abs=1e-6)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("lengths", [(10,), (10, 10)])
def test_the_interval_holds_the_truth(lengths, rho):
    rng, held = np.random.default_rng(5), 0
    for _ in range(200):
        found = shared_coefficient(series(rng, lengths, rho))
        held += abs(found.value - 0.5) <= found.half
    assert held >= 180, "of 200, at 95 %"


def test_values_without_errors_leave_no_more_than_rounding():
    common = np.linspace(1.0, 16.0, 12)
    found = shared_coefficient([Series(0.8 * common + 3.0, common, np.ones((12, 1)))])
    assert found.value == pytest.approx(0.8, abs=1e-12)
    assert 0.0 < found.half < 1e-12
