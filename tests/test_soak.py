"""The soak of `benchmarks/soak.py` on three studies that are simulated only."""

import pytest

from benchmarks.soak import soak


@pytest.mark.faults(before="curves differed by up to 5e-8")
def test_what_is_killed_at_random_moments_ends_as_if_nothing_had_been(tmp_path):
    kills, compared, differing = soak(tmp_path, studies=3, seed=1, latest=15.0, recorded=False)
    assert kills >= 3
    assert compared > 30
    assert differing == []
