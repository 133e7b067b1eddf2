"""The soak of `benchmarks/soak.py` on two studies that are simulated only."""

import pytest

from benchmarks.soak import soak

pytestmark = pytest.mark.slow


@pytest.mark.faults(before="curves differed by up to 5e-8")
def test_what_is_killed_at_random_moments_ends_as_if_nothing_had_been(tmp_path):
    kills, compared, differing = soak(tmp_path, studies=2, seed=1, latest=15.0, recorded=False, kills=3)
    assert kills >= 4
    assert compared > 20
    assert differing == []
