"""The frame's compliance from the tops of unloadings, against Sneddon's cone and arbitrary tips of one hardness."""

import numpy as np
import pytest

from palpate.classical.frame import frame_of
from palpate.segments import segments

PEAKS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def cycles(peaks=PEAKS, points=60):
    """Load and unload to a tenth, higher each time; returns time and load."""
    corners = np.concatenate([[0.0], np.ravel([[peak, 0.1 * peak] for peak in peaks])])
    time = np.linspace(0.0, len(corners) - 1.0, points * (len(corners) - 1) + 1)
    return time, np.interp(time, np.arange(len(corners)), corners)


@pytest.mark.parametrize("compliance", [0.0, 0.9, -0.5])
def test_sneddons_cone_on_a_yielding_frame(compliance):
    time, load = cycles()
    depth = 80.0 * np.sqrt(load) + compliance * load + 37.0
    found = frame_of([(load, depth, segments(time, load))])
    assert found.compliance == pytest.approx(compliance, abs=0.005)
    assert found.lower <= found.compliance <= found.upper
    assert found.unloadings == 5, "those above a twentieth of the largest load"


@pytest.mark.parametrize("seed", range(4))
def test_the_shape_of_the_tip_does_not_matter(seed):
    rng = np.random.default_rng(seed)
    time, load = cycles()
    highest = np.maximum.accumulate(np.maximum(load, 1e-6))
    rounding = rng.uniform(5, 60) * np.log1p(highest / rng.uniform(0.2, 5))
    stiff = 30.0 / np.sqrt(highest)
    recovered = stiff * highest * 1.5 * (1.0 - np.cbrt((load / highest) ** 2))
    depth = 200.0 * np.sqrt(highest) + rounding - recovered + 0.8 * load + rng.uniform(-100, 100)
    found = frame_of([(load, depth, segments(time, load))])
    assert found.compliance == pytest.approx(0.8, abs=0.05)


def test_the_interval_holds_the_truth_under_noise():
    rng = np.random.default_rng(8)
    time, load = cycles()
    held = 0
    for _ in range(20):
        depth = 80.0 * np.sqrt(load) + 0.9 * load + 0.3 * rng.standard_normal(len(load))
        found = frame_of([(load, depth, segments(time, load))])
        held += found.lower <= 0.9 <= found.upper
    assert held >= 17


@pytest.mark.parametrize("peaks", [(4.0,), (2.0, 3.0, 4.0, 5.0), (1.0, 16.0)])
def test_nothing_is_said_without_different_loads(peaks):
    time, load = cycles(peaks)
    assert frame_of([(load, 80.0 * np.sqrt(load), segments(time, load))]) is None
