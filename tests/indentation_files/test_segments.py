"""Segments against the histories that were written; drift against what was planted, and against the vendor's own."""

from itertools import pairwise

import numpy as np
import pytest
from contact_curves import autoregressive
from public_files import HLD, KLA, LONG, XP, needs_recordings

from indentation_files.drift_rate import drift_rate, measured_in
from indentation_files.readers import read_vendor_file
from indentation_files.recording import Recording
from indentation_files.segments import Segment, segments
from indentation_files.survey import survey, table
from palpate.errors import InputError
from palpate.output.figures import recorded_test as figure_of_a_recording


def found_in(knots, loads, *, points=2000, noise=0.0, seed=0, contact=0):
    time = np.linspace(knots[0], knots[-1], points)
    load = np.interp(time, knots, loads) + noise * np.random.default_rng(seed).standard_normal(points)
    return segments(time, load, contact)


def kinds(parts):
    return [part.kind for part in parts]


@pytest.mark.parametrize("noise", [0.0, 1e-4, 2e-3])
@pytest.mark.parametrize("points", [100, 2000])
def test_trapezoid_with_drift_hold(noise, points):
    knots, loads = [0, 30, 50, 74, 110, 113], [0, 1, 1, 0.2, 0.2, 0]
    parts = found_in(knots, loads, points=points, noise=noise)
    assert kinds(parts) == ["loading", "hold", "unloading", "drift_hold", "unloading"]
    allowed = 3 * 113 / points + 30 * (0.02 + 4 * noise)
    assert [part.end for part in parts] == pytest.approx(knots[1:], abs=allowed)


@pytest.mark.parametrize(("load", "kind"), [(0.3, "hold"), (0.02, "drift_hold")])
def test_a_hold_on_the_way_up_creeps_unless_it_is_a_preload(load, kind):
    assert kinds(found_in([0, 5, 125, 130, 160, 170], [0, load, load, 1, 1, 0]))[1] == kind


def test_triangle_has_no_hold():
    assert kinds(found_in([0, 30, 60], [0, 1, 0], noise=1e-3)) == ["loading", "unloading"]


def test_exponential_loading_is_one_segment():
    time = np.linspace(0, 60, 1200)
    load = np.where(time < 50, 1e-3 * np.exp(0.2 * time), 1e-3 * np.exp(10) * (60 - time) / 10)
    assert kinds(segments(time, load)) == ["loading", "unloading"]


def test_cycles_are_told_from_first_loading():
    knots = [0, 5, 10, 15, 20, 25, 30, 40]
    parts = found_in(knots, [0, 0.1, 0.1, 0.05, 1.0, 1.0, 0.1, 0.0], noise=1e-4)
    assert kinds(parts) == ["loading", "hold", "unloading", "reloading", "loading", "hold", "unloading"]
    assert parts[4].start == pytest.approx(15 + 5 * 0.05 / 0.95, abs=0.2)


def test_segments_leave_no_gap_and_begin_with_the_approach():
    time = np.linspace(-10, 60, 700)
    load = np.interp(time, [-10, 0, 30, 60], [0, 0, 1, 0])
    parts = segments(time, load, contact=100)
    assert kinds(parts) == ["approach", "loading", "unloading"]
    assert (parts[0].first, parts[-1].last) == (0, 699)
    assert all(left.last == right.first for left, right in pairwise(parts))


def test_load_s_unit_does_not_matter():
    time, rng = np.linspace(0, 113, 1500), np.random.default_rng(4)
    load = np.interp(time, [0, 30, 50, 74, 110, 113], [0, 1, 1, 0.2, 0.2, 0]) + 1e-3 * rng.standard_normal(1500)
    assert segments(time, load) == segments(time, 1000 * load)


def test_too_short_a_test_is_refused():
    with pytest.raises(InputError, match="points follow contact"):
        segments(np.arange(8.0), np.arange(8.0))
    with pytest.raises(InputError, match="no segment"):
        Segment("landing", 0, 5, 0.0, 1.0)


@pytest.mark.parametrize(("rho", "recovery"), [(0.0, 0.0), (0.8, 0.0), (0.0, -5.0)])
def test_planted_drift_lies_in_the_interval(rho, recovery):
    time, held = np.linspace(100, 160, 300), 0
    for seed in range(12):
        noise = 0.5 * autoregressive(np.random.default_rng(seed), 300, rho)
        found = drift_rate(time, 500 + 0.02 * time + recovery * np.exp(-(time - 100) / 6) + noise)
        held += found.lower <= 0.02 <= found.upper
        assert found.rate == pytest.approx(0.02, abs=0.02)
    assert held >= 9, "of 12, at 95 %"


@pytest.mark.parametrize(
    ("points", "rho", "recovery"),
    [pytest.param(400, 0.0, 20.0, id="recovery between times on trial"), pytest.param(20, 0.7, 5.0, id="few points")],
)
def test_the_interval_is_wide_enough(points, rho, recovery):
    time, rng, held = np.linspace(0.0, 60.0, points), np.random.default_rng(7), 0
    for _ in range(40):
        depth = 100.0 + 0.05 * time + recovery * np.exp(-time / 4.0) + 0.3 * autoregressive(rng, points, rho)
        found = drift_rate(time, depth)
        held += found.lower <= 0.05 <= found.upper
    assert held >= 36, "of 40, at 95 %"


def test_correlated_noise_widens_the_interval():
    time, rng = np.linspace(0, 60, 300), np.random.default_rng(1)
    white, red = (drift_rate(time, 0.02 * time + 0.5 * autoregressive(rng, 300, rho)) for rho in (0.0, 0.9))
    assert red.upper - red.lower > 2 * (white.upper - white.lower)


@needs_recordings
def test_vendor_s_drift_is_measured_again():
    """Raw displacement in the XP's own drift hold: nine rates that its makers reported, to 0.001 nm/s."""
    held, errors = 0, []
    for test in read_vendor_file(XP, corrections=frozenset(), contact="none"):
        found = survey(test.recording)
        assert kinds(found.parts) == ["approach", "loading", "hold", "unloading", "drift_hold"]
        reported = float(test.metadata["Drift Correction [nm/s]"])
        held += found.drift.lower <= reported <= found.drift.upper
        errors.append(abs(found.drift.rate - reported))
    assert held >= 7
    assert np.median(errors) < 0.003
    assert sum(error > 0.01 for error in errors) <= 1, "one hold still recovers: the reported line goes through that"


@needs_recordings
def test_cycles_of_a_real_test():
    tests = read_vendor_file(KLA, contact="none")
    parts = survey(tests[0].recording).parts
    assert kinds(parts).count("hold") == 10
    assert kinds(parts).count("reloading") == 9
    holds = [part.duration for part in parts if part.kind == "hold"]
    assert holds == pytest.approx([float(tests[0].metadata["Hold Maximum Load Time [s]"])] * 10, abs=0.3)
    assert kinds(parts)[-2:] == ["drift_hold", "unloading"]


@needs_recordings
def test_plain_tests_have_plain_segments():
    for test in read_vendor_file(LONG, contact="none"):
        found = survey(test.recording)
        assert kinds(found.parts)[-3:] == ["loading", "hold", "unloading"]
        assert found.parts[-2].duration == pytest.approx(500, abs=2)
        assert found.drift is None
    (test,) = read_vendor_file(HLD, contact="none")
    found = survey(test.recording)
    assert kinds(found.parts) == ["approach", "loading", "unloading"]
    assert found.parts[-1].duration == pytest.approx(1.0, abs=0.02), "segment 3 of the file's header"
    assert measured_in(test.recording.time, test.recording.depth, found.parts) is None
    rows = table([found], [("the file's own", 0.0)])
    assert rows["contact_nm"][0] == pytest.approx(found.contact.depth)
    assert np.isnan(rows["drift_nm_per_s"][0])


def test_the_figure_of_a_recording_keeps_its_title_clear_of_its_legend(monkeypatch):
    time = np.linspace(0.0, 50.0, 500)
    load = np.interp(time, [0, 20, 30, 50], [0, 2, 2, 0])
    depth = 500.0 * np.sqrt(load) + 2.0 * time
    drawn = []
    monkeypatch.setattr(figure_of_a_recording, "save", lambda figure, path: drawn.append(figure))
    figure_of_a_recording.draw(
        survey(Recording(time, load, depth, "PMMA white, 2 mN in 20 s, site 1")), "", ("the file's own", 0.0)
    )
    (figure,) = drawn
    figure.canvas.draw()
    (legend,) = figure.legends
    assert not legend.get_window_extent().overlaps(figure._suptitle.get_window_extent())
