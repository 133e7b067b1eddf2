"""What must never pass for adequate: a fit short of its optimum, a parameter held by its bound, slow misfit."""

from dataclasses import replace

import numpy as np
import pytest
from closed_forms import ClosedForms
from diagnosis_problem import CONDITIONS, RECORD_ONLY, fitted, problem, recordings

from palpate.data.noise import LARGEST_UNREPLICATED_AUTOCORRELATION
from palpate.diagnosis.detect import examine, filters, log_p, monte_carlo_p, simulated_noise
from palpate.diagnosis.screen import Screen
from palpate.inference.covariance import components, noise_of
from palpate.models.coordinates import Coordinate, Coordinates


def p_of(fit):
    return examine(fit, Screen.of(fit, RECORD_ONLY), np.random.default_rng(1), 400, 0.01)


def loudest_of_noise(fit, rng, draws):
    """Return the logarithm of the p-value of the filter that sticks out most, of noise alone (draws,)."""
    noise = simulated_noise(fit, draws, rng)
    return np.min([log_p(basis, noise) for basis in filters(fit, Screen.of(fit, RECORD_ONLY))], axis=0)


def moved(fit, z):
    """Return a fit as it would be, had its search stopped elsewhere."""
    ((curves, slopes),) = fit.model.tangents([z])
    return replace(fit, z=z, curve=fit.problem.stacked(curves), tangent=fit.problem.stacked(slopes))


@pytest.fixture(scope="module")
def null():
    return problem(recordings(np.random.default_rng(11)))


def test_a_fit_short_of_its_optimum(null):
    best = fitted(null)
    assert p_of(best) > 0.01
    assert p_of(moved(best, np.clip(best.z + 0.3, 0, 1))) < 0.01


@pytest.mark.parametrize("bounds", [(1.15, 1.4), (0.6, 0.87)])
def test_a_parameter_held_by_its_bound(null, bounds):
    """The modulus is 1: bounds that leave it out keep the model from the recordings, and that must show."""
    ends = {"modulus": bounds, "fluidity": (0.0099, 0.0101)}
    limits = Coordinates([Coordinate(name, *pair, *pair) for name, pair in ends.items()], {})
    assert p_of(fitted(replace(null, forward=ClosedForms(CONDITIONS, limits)))) < 0.01


def test_what_a_named_drift_leaves():
    """Drifts scatter as the background does: with both fitted, neither would be known, and misfit pass for noise."""
    rng = np.random.default_rng(6)
    rates = iter(0.3 + 0.03 * rng.standard_normal(12))

    def both(condition, replicate):
        protocol = condition.protocol
        return next(rates) * protocol.sample_time + 8.0 * protocol.sample_load

    fit = fitted(problem(recordings(rng, both)), ("thermal_drift",))
    assert p_of(fit) < 0.01
    assert np.quantile(loudest_of_noise(fit, rng, 400), 0.01) > -20.0


def test_noise_of_single_recordings_never_grows_slow():
    """A wave that no cubic in a segment removes at once would be noise of long memory; what is simulated forgets."""
    rng = np.random.default_rng(4)
    task = problem(recordings(rng, replicates=1))
    slow = np.concatenate([8.0 * np.sin(np.linspace(0, 9, 60)) for _ in CONDITIONS])
    noise = noise_of(task, (), slow, 0.01)
    assert noise.autocorrelation.max() <= LARGEST_UNREPLICATED_AUTOCORRELATION
    still = [{"site": np.zeros((60, 60))} for _ in CONDITIONS]
    quiet = replace(
        noise, variances={"site": 0.0}, covariance=noise.covariance[: 2 * len(still) + 1, : 2 * len(still) + 1]
    )
    drawn = np.array(quiet.simulated(still, 400, rng))
    assert np.percentile(np.abs(drawn), 99.9) < 6.0 * noise.sigma.max()


def test_noise_of_single_recordings_never_drowns_everything():
    """A short curve tells strength and memory badly, their product well: drawn apart, noise would be tens of sigma."""
    rng, loud = np.random.default_rng(300), []
    for _ in range(12):
        fit = fitted(problem(recordings(rng, replicates=1)))
        loud.append(float(np.quantile(loudest_of_noise(fit, rng, 300), 0.01)))
    assert min(loud) > -40.0


def test_simulated_noise_has_the_covariance_of_its_model(null):
    rng = np.random.default_rng(5)
    noise = noise_of(null, (), np.zeros(len(null.mean)), 0.01)
    parts = components(null, (), null.mean)
    known = replace(noise, covariance=1e-12 * np.eye(len(noise.covariance)))
    for k, drawn in enumerate(known.simulated(parts, 20000, rng)):
        expected = noise.matrix(k, parts[k])
        assert np.cov(drawn) == pytest.approx(expected, abs=0.05 * np.diag(expected).max())


def test_noise_is_simulated_however_deep_the_tests_are(null):
    """An error common to all curves makes a covariance of a single factor, whose size must not matter."""
    fit = fitted(null)
    deep = replace(fit, errors=replace(fit.errors, model=np.outer(fit.curve, fit.curve) * 1e4))
    assert np.isfinite(simulated_noise(deep, 10, np.random.default_rng(1))).all()


@pytest.mark.parametrize("true", [0.3, 0.02, 0.006])
def test_a_p_value_near_the_limit_is_known_to_a_fifth(true):
    """By sequential draws; its mean is the true one, and one that is far below costs no more than the first draws."""
    rng, calls = np.random.default_rng(4), []

    def as_extreme():
        calls.append(1)
        return rng.binomial(500, true)

    found = np.array([monte_carlo_p(as_extreme, 500) for _ in range(400)])
    assert found.mean() == pytest.approx(true, rel=0.08)
    assert found.std() < 0.3 * true
    calls.clear()
    assert monte_carlo_p(lambda: calls.append(1) or 0, 500) == pytest.approx(1 / 501)
    assert len(calls) == 1
