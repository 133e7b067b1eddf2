"""The noise model on recordings far from the usual: slow noise, large scatter, none at all."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, problem, recordings, search_of

from palpate.data.noise import NoiseModel
from palpate.inference.amplitude import Amplitude
from palpate.inference.covariance import noise_between_replicates, noise_of

DRIFT, ZERO = Amplitude("thermal_drift", "rate"), Amplitude("zero_offset", "offset")
SETS = [(), (ZERO,), (DRIFT,), (DRIFT, ZERO)]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("replicates", [2, 3])
def test_more_components_never_fit_worse(seed, replicates):
    """Slow noise, a random walk and a drift pass for each other: the nearest maximum may be the wrong one.

    The prior that keeps scatter and random walk from zero may cost the likelihood a few tenths.
    """
    rng = np.random.default_rng(seed)
    task = problem(recordings(rng, replicates=replicates, sigma=4.0, memory=0.97))
    base, offset, drift, both = (noise_between_replicates(task, keys, 0.01).log_likelihood for keys in SETS)
    assert min(offset, drift) > base - 0.5
    assert both > max(offset, drift) - 0.5


@pytest.mark.parametrize("site", [0.001, 0.03, 0.1])
def test_scatter_between_sites_may_be_small_or_large(site):
    found = [
        noise_between_replicates(problem(recordings(np.random.default_rng(n), site=site)), (), 0.01).variances["site"]
        for n in range(6)
    ]
    assert np.sqrt(np.mean(found)) == pytest.approx(site, rel=0.5)


def test_two_recordings_alone_do_not_scatter_by_their_whole_depth():
    """One difference between two sites: with what is assumed, 0.01, it keeps the scatter near."""
    for seed in range(6):
        whole = problem(recordings(np.random.default_rng(seed), replicates=2))
        alone = replace(whole, conditions=CONDITIONS[:1])
        site = noise_between_replicates(alone, (), 0.01).variances["site"]
        assert 0.006 < np.sqrt(site) < 0.04


@pytest.mark.parametrize("sigma", [1e-6, 50.0])
def test_recordings_may_be_free_of_noise_or_full_of_it(sigma):
    """The floor of the noise is 1e-5 of the depth."""
    noise = noise_between_replicates(problem(recordings(np.random.default_rng(1), sigma=sigma)), SETS[-1], 0.01)
    assert np.isfinite(noise.log_likelihood)
    assert np.median(noise.sigma) == pytest.approx(max(sigma, 0.005), rel=0.6)


def test_a_condition_tested_once_takes_its_noise_from_the_others():
    whole = problem(recordings(np.random.default_rng(5)))
    item = whole.observed["b"]
    lonely = replace(whole, recorded=whole.recorded | {"b": replace(item, response=item.response[:1])})
    noise, others = noise_of(lonely, (), np.zeros(240), 0.01), noise_of(whole, (), np.zeros(240), 0.01)
    assert noise.replicated
    assert noise.sigma[[0, 2, 3]] == pytest.approx(others.sigma[[0, 2, 3]], rel=0.2)
    assert noise.sigma[1] == pytest.approx(np.median(noise.sigma[[0, 2, 3]]))
    assert np.linalg.eigvalsh(noise.covariance).min() > -1e-9
    assert search_of(lonely).base.p_value > 0.01
    compliant = {
        c.name: replace(
            lonely.observed[c.name], response=lonely.observed[c.name].response + 30.0 * c.protocol.sample_load
        )
        for c in CONDITIONS
    }
    assert search_of(replace(lonely, recorded=compliant)).base.p_value < 0.01


def test_two_conditions_of_four_tested_once_leave_the_noise_assumed():
    whole = problem(recordings(np.random.default_rng(5)))
    once = {name: replace(whole.observed[name], response=whole.observed[name].response[:1]) for name in ("a", "b")}
    assert not replace(whole, recorded=whole.recorded | once).replicated


@pytest.mark.parametrize("known", [2, 3, 6])
def test_the_noise_of_a_condition_tested_once_is_as_uncertain_as_one_more_beside_those_that_are_known(known):
    """Conditions whose log sigma scatters by 0.4: the mean square error of the middle one is what is stated."""
    rng, errors, stated = np.random.default_rng(known), [], []
    for _ in range(3000):
        logs = 0.4 * rng.standard_normal(known + 1)
        model = NoiseModel(
            np.exp(logs[1:]), np.full(known, 0.5), {"site": 1.0}, 0.0, 1e-9 * np.eye(2 * known + 1), True
        ).spread(range(1, known + 1), known + 1)
        errors.append((np.log(model.sigma[0]) - logs[0]) ** 2)
        stated.append(model.covariance[0, 0])
    assert np.mean(stated) == pytest.approx(np.mean(errors), rel=0.12)
