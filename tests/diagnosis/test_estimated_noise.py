"""Intervals that allow for estimated noise: against closed forms of means, and how often they hold what is true."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, fitted, problem, recordings
from scipy.linalg import cholesky, solve_triangular
from scipy.special import expit, logit
from scipy.stats import t as student

from palpate.data.noise import NoiseModel
from palpate.diagnosis.estimated_noise import adjusted, freedom
from palpate.diagnosis.locate import Residuals
from palpate.diagnosis.undetected import undetected_effects
from palpate.inference.amplitude import Amplitude
from palpate.inference.covariance import Errors


def points(sigma, strength_freedom, counts, site=0.0, site_freedom=1):
    """Conditions of one point each, their strengths estimated independently."""
    size = len(sigma)
    spread = [*(0.5 / strength_freedom), *np.zeros(size), 2.0 * site**4 / site_freedom]
    noise = NoiseModel(sigma, np.full(size, 0.5), {"site": site**2}, 0.0, np.diag(spread), True)
    errors = Errors(
        noise, [{"site": np.ones((1, 1))}] * size, np.zeros((size, size)), [np.zeros(1)] * size, list(counts)
    )
    factor = cholesky(errors.covariance, lower=True)
    return SimpleNamespace(
        errors=errors, factor=factor, whiten=lambda values: solve_triangular(factor, values, lower=True)
    )


def mean_of(*noise, **site):
    """Variance and freedom of the mean of conditions of one point each."""
    fit = points(*noise, **site)
    design = np.ones((len(fit.factor), 1))
    white = fit.whiten(design)
    known = np.linalg.inv(white.T @ white)
    return float(known[0, 0]), *adjusted(fit, design, known, 0)


def test_a_mean_of_equal_sites_has_the_freedom_of_their_scatter():
    """Three recordings of eight tests: the weights do not depend on the scatter, and Student's law is exact."""
    sites = mean_of(np.full(8, 1e-6), np.full(8, 16.0), [3] * 8, site=0.01, site_freedom=16)
    assert sites == pytest.approx((0.01**2 / 24, 0.01**2 / 24, 16.0), rel=1e-6)


def test_a_mean_of_unequal_tests_is_as_uncertain_as_meier_found():
    """P. Meier, Biometrics 9 (1953) 59-73: V (1 + 4 sum p (1 - p) / f); freedom by B.L. Welch, 1 / sum p^2 / f."""
    sigma, freedom, counts = np.array([1.0, 1.5]), np.array([20.0, 12.0]), np.array([21, 13])
    share = counts / sigma**2 / np.sum(counts / sigma**2)
    known, variance, found = mean_of(sigma, freedom, counts)
    assert variance / known - 1.0 == pytest.approx(4.0 * np.sum(share * (1.0 - share) / freedom), rel=0.02)
    assert found == pytest.approx(1.0 / np.sum(share**2 / freedom), rel=0.02)


def test_a_difference_between_unequal_tests_has_the_freedom_of_welch():
    """B.L. Welch, Biometrika 34 (1947) 28-35: (a + b)^2 / (a^2 / f + b^2 / g), a and b the variances of the means."""
    sigma, strength_freedom, counts = np.array([1.0, 1.5]), np.array([20.0, 12.0]), np.array([21, 13])
    share = sigma**2 / counts
    found = freedom(points(sigma, strength_freedom, counts), np.array([1.0, -1.0]), share.sum())
    assert found == pytest.approx(share.sum() ** 2 / np.sum(share**2 / strength_freedom), rel=0.02)


def test_where_a_fit_differs_is_less_certain_when_the_noise_is_estimated():
    """With two recordings of each test; taken as known, the noise put a difference in 0.11 of 130 sets without any."""
    fit = fitted(problem(recordings(np.random.default_rng(3), lambda c, r: 10.0, replicates=2)))
    noise = fit.errors.noise
    known = replace(fit, errors=replace(fit.errors, noise=replace(noise, covariance=1e-6 * noise.covariance)))
    (certain, *_), (found, *_) = Residuals.of(known).located(), Residuals.of(fit).located()
    assert certain["q_value"] < 0.1 * found["q_value"]
    assert found["q_value"] < 0.05


def test_a_mean_of_unequal_tests_with_few_recordings_lies_within_its_interval():
    """Five recordings each; with the noise taken as known 0.84 of the intervals hold the mean."""
    rng, held, held_if_known = np.random.default_rng(20), 0, 0
    for _ in range(1500):
        rows = np.array([[1.0], [1.5]]) * rng.standard_normal((2, 5))
        sigma = rows.std(axis=1, ddof=1)
        mean = np.average(rows.mean(axis=1), weights=sigma**-2)
        known, variance, freedom = mean_of(sigma, np.full(2, 4.0), [5, 5])
        held += abs(mean) < student.isf(0.025, freedom) * np.sqrt(variance)
        held_if_known += abs(mean) < 1.96 * np.sqrt(known)
    assert held_if_known / 1500 < 0.87
    assert held / 1500 > 0.92


def test_slopes_by_the_estimates_are_differences_of_covariances():
    """Of log sigma and logit rho of each condition, then of the variances."""
    fit = fitted(problem(recordings(np.random.default_rng(3))))
    noise, weights = fit.errors.noise, np.random.default_rng(4).standard_normal(len(fit.residual))
    points, values = (
        np.stack([np.log(noise.sigma), logit(noise.autocorrelation)]).ravel(),
        list(noise.variances.values()),
    )

    def pulled(estimates):
        sigma, autocorrelation, variances = np.split(estimates, [4, 8])
        named = dict(zip(noise.variances, variances, strict=True))
        moved = replace(noise, sigma=np.exp(sigma), autocorrelation=expit(autocorrelation), variances=named)
        return replace(fit.errors, noise=moved).covariance @ weights

    estimates = np.append(points, values)
    for place, slope in enumerate(fit.errors.slopes(weights).T):
        step = np.where(np.arange(len(estimates)) == place, 1e-5, 0.0)
        difference = (pulled(estimates + step) - pulled(estimates - step)) / 2e-5
        assert slope == pytest.approx(difference, rel=1e-3, abs=1e-5 * np.abs(difference).max())


@pytest.mark.xfail(reason="without the share of ripple in the covariance intervals are 4.6 % wider, 1 % was expected")
def test_many_replicates_tell_the_noise():
    """The interval is then what the noise, once known, leaves; with two recordings of each test it is wider."""
    widths = []
    for count in (2, 20):
        fit = fitted(problem(recordings(np.random.default_rng(3), replicates=count)))
        column = fit.problem.unit_effects(Amplitude("thermal_drift", "rate"))
        white = fit.whiten(np.column_stack([fit.tangent, column]))
        deviation = np.sqrt(np.linalg.inv(white.T @ white + np.diag([12.0, 12.0, 0.0]))[-1, -1])
        drift = undetected_effects(fit, ["thermal_drift"])["thermal_drift.rate"]
        widths.append((drift["upper"] - drift["lower"]) / (2 * 1.96 * deviation))
    assert widths[0] > 1.2
    assert widths[1] == pytest.approx(1.01, abs=0.01)


@pytest.mark.xfail(reason="111 of 120 intervals hold zero, 114 are asked for")
def test_single_recordings_without_an_effect_hold_zero():
    """40 sets; with the noise taken as known 95 of the 120 intervals do."""
    rng, held = np.random.default_rng(21), 0
    for _ in range(40):
        fit = fitted(problem(recordings(rng, replicates=1)))
        held += sum(entry["lower"] < 0.0 < entry["upper"] for entry in undetected_effects(fit, RECORD_ONLY).values())
    assert held >= 0.95 * 120
