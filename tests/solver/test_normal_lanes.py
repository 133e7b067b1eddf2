"""The normal distribution in lanes against scipy's."""

import numpy as np
import pytest
from kernels import normal_distribution
from scipy.stats import norm


def test_normal_distribution_is_that_of_scipy():
    for x in np.linspace(-10.9, 10.9, 401):
        share, density = normal_distribution(x)
        assert share == pytest.approx(norm.cdf(x), rel=2e-14)
        assert density == pytest.approx(norm.pdf(x), rel=2e-14)


def test_far_out_it_stays_what_it_is_at_eleven_standard_deviations():
    assert normal_distribution(-1e6)[0] == normal_distribution(-11.0)[0] > 0.0
    assert tuple(normal_distribution(1e6)) == (1.0, normal_distribution(11.0)[1])
