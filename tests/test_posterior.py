"""Intervals of a diagnosis: draws that follow the likelihood, fits that noise does not draw down, slopes by secants."""

import numpy as np
import pytest
from test_diagnosis import fitted, problem, recordings, weighed

from palpate.diagnosis.correction import Correction
from palpate.diagnosis.fit import solve
from palpate.diagnosis.posterior import posterior_draws, sampled

TRUTH = np.array([(1.0 - 0.7) / 0.7, 0.01 / 0.03])


def refitted(task):
    """Fit twice, so that the errors are in proportion to a simulated curve."""
    rough = fitted(task)
    return solve(task, (), weighed(task, (), rough.residual), [rough.z])


def test_draws_agree_with_the_first_order_covariance_where_the_likelihood_is_even():
    fit = fitted(problem(recordings(np.random.default_rng(5))))
    draws = posterior_draws(fit, np.random.default_rng(6))
    assert draws.mean(axis=0) == pytest.approx(fit.z, abs=0.4 * np.sqrt(np.diag(fit.posterior)).max())
    assert draws.std(axis=0) == pytest.approx(np.sqrt(np.diag(fit.posterior)), rel=0.3)


def test_draws_are_as_wide_as_a_normal_distribution():
    """Snooker moves, whose acceptance must weigh distances by the power k - 1, drew 4 % too narrow in emcee 3.1.6."""
    rng, widths = np.random.default_rng(3), []
    for _ in range(12):
        drawn = sampled(lambda z: -0.5 * np.sum(z**2, axis=1), rng.standard_normal((36, 6)), rng)
        widths.append(np.diff(np.percentile(drawn, [2.5, 97.5], axis=0), axis=0) / (2 * 1.96))
    assert np.mean(widths) == pytest.approx(1.0, abs=0.015)


def test_the_noise_of_the_recordings_does_not_draw_the_fit_to_smaller_depths():
    """The bias of errors in proportion to recorded depths: D'Agostini, Nucl. Instrum. Methods A 346 (1994) 306."""
    rng, bias = np.random.default_rng(8), []
    for _ in range(16):
        fit = refitted(problem(recordings(rng, sigma=3.0, memory=0.2, site=0.03)))
        bias.append((fit.z - TRUTH) / np.sqrt(np.diag(fit.posterior)))
    assert np.all(np.abs(np.mean(bias, axis=0)) < 2.6 / np.sqrt(16))


def test_a_secant_correction_keeps_what_both_points_say():
    rng = np.random.default_rng(2)
    first = Correction(rng.random(3), rng.random(20), rng.random((20, 3)))
    at, shift = rng.random(3), rng.random(20)
    second = first.moved(at, shift)
    assert second(at[None])[0] == pytest.approx(shift)
    assert second(first.at[None])[0] == pytest.approx(first.value)
