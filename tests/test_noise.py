"""The noise model on recordings far from the usual: slow noise, large scatter, none at all."""

import numpy as np
import pytest
from test_diagnosis import problem, recordings

from palpate.diagnosis.covariance import noise_between_replicates

SETS = [(), ("zero_offset",), ("thermal_drift",), ("thermal_drift", "zero_offset")]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("replicates", [2, 3])
def test_more_components_never_fit_worse(seed, replicates):
    """Slow noise, a random walk and a drift pass for each other: the nearest maximum may be the wrong one.

    The prior that keeps scatter and wander from zero may cost the likelihood a few tenths.
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


@pytest.mark.parametrize("sigma", [1e-6, 50.0])
def test_recordings_may_be_free_of_noise_or_full_of_it(sigma):
    """The floor of the noise is 1e-5 of the depth."""
    noise = noise_between_replicates(problem(recordings(np.random.default_rng(1), sigma=sigma)), SETS[-1], 0.01)
    assert np.isfinite(noise.log_likelihood)
    assert np.median(noise.sigma) == pytest.approx(max(sigma, 0.005), rel=0.6)
