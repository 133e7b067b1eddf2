"""The frame's compliance from the tops of unloadings, against Sneddon's cone and arbitrary tips of one hardness."""

import numpy as np
import pytest
from contact_curves import autoregressive
from load_cycles import cycles

from indentation_files.segments import segments
from palpate.classical.frame import frame_by_oscillation, frame_compliance, frame_of, hodges_lehmann


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


def rough(rng, compliance=0.8, sites=1, points=40, noise=0.2):
    """Tests at sites of different hardness, with a noise of the depth that hides the smallest tops."""
    time, load = cycles(points=points)
    depths = (rng.normal(80.0, 2.0) * np.sqrt(load) + compliance * load for _ in range(sites))
    return [(load, depth + noise * rng.standard_normal(len(load)), segments(time, load)) for depth in depths]


def test_sites_may_differ_and_one_may_be_bad():
    tests = rough(np.random.default_rng(3), sites=8)
    good = frame_of(tests)
    load, depth, parts = tests[0]
    bad = frame_of([(load, depth + 3.0 * load, parts), *tests[1:]])
    assert good.lower <= 0.8 <= good.upper
    assert bad.lower <= 0.8 <= bad.upper
    assert abs(bad.compliance - good.compliance) < 0.05


def test_more_tests_make_the_interval_narrower():
    one, eight = (frame_of(rough(np.random.default_rng(4), sites=count)) for count in (1, 8))
    assert eight.upper - eight.lower < 0.7 * (one.upper - one.lower)


def test_hodges_and_lehmanns_interval_holds_the_centre():
    rng, held = np.random.default_rng(6), 0
    for _ in range(400):
        centre, lower, upper = hodges_lehmann(rng.standard_cauchy(9) + 2.0)
        assert lower <= centre <= upper
        held += lower <= 2.0 <= upper
    assert 0.93 <= held / 400 <= 0.985


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8])
@pytest.mark.parametrize(("sites", "count"), [(1, 4), (1, 10), (2, 10), (5, 10)])
def test_few_tests_hold_the_truth_however_correlated_their_errors_are(sites, count, rho):
    rng, held = np.random.default_rng(17), 0
    load = np.geomspace(1.0, 16.0, count)
    for _ in range(100):
        tests = [(load, 0.5 + 8.0 / np.sqrt(load) + 0.1 * autoregressive(rng, count, rho) / load) for _ in range(sites)]
        found = frame_compliance(tests)
        held += found.lower <= 0.5 <= found.upper
    assert held >= 89, "of 100, at 95 %"


def oscillated(rng, compliance, memory, sites):
    """Stiffness by an oscillation under a load that grows exponentially, its error correlated along the test."""
    load = 100.0 * np.exp(0.1 * np.linspace(-60.0, 0.0, 400))
    error = autoregressive(rng, len(load), memory)
    return [(load, 1.0 / (compliance + rng.normal(38.0, 0.5) * (1 + 0.01 * error) / np.sqrt(load)))] * sites


@pytest.mark.parametrize(("sites", "memory"), [(1, 0.0), (1, 0.9), (7, 0.9)])
def test_stiffness_by_oscillation_shows_the_frame(sites, memory):
    rng, held = np.random.default_rng(11), 0
    for _ in range(20):
        tests = [oscillated(rng, 0.2, memory, 1)[0] for _ in range(sites)]
        found = frame_by_oscillation(tests)
        held += found.lower <= 0.2 <= found.upper
    assert held >= 17


def test_an_oscillation_over_a_narrow_range_says_nothing():
    load = np.linspace(40.0, 100.0, 300)
    assert frame_by_oscillation([(load, np.sqrt(load) / 38.0)]) is None
