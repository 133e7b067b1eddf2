"""Recordings in step with the load history that their condition follows."""

import numpy as np
import pytest

from indentation_files.readers.vendor import usable
from indentation_files.recording import Recording
from palpate.study.alignment import aligned, time_shift
from palpate.study.protocol import trapezoid
from palpate.study.recorded_history import recorded


def constant_strain_rate(late):
    """Load that grows exponentially to 100 mN, on a clock that starts `late`; depth goes with the load's root."""
    time = np.arange(0.0, 90.0, 0.2)
    rising = np.clip(time - late, 0.0, 50.0)
    load = 100 * (np.expm1(0.2 * rising) / np.expm1(10.0)) * np.interp(time - late, [60, 80], [1.0, 0.1])
    return Recording(time, load, 100 * np.sqrt(load))


@pytest.mark.parametrize("late", [-1.7, 0.0, 0.3, 2.5])
def test_a_late_clock_is_found(late):
    first = constant_strain_rate(0.0)
    protocol = recorded(first.time, first.load, 60)
    other = constant_strain_rate(late)
    assert time_shift(other, protocol) == pytest.approx(late, abs=0.03)
    inside = (first.time > 3) & (first.time < 85)
    depth = np.interp(first.time[inside], aligned(other, protocol).time, aligned(other, protocol).depth)
    assert depth == pytest.approx(first.depth[inside], abs=0.01 * first.depth.max())


def test_a_recording_in_step_stays_as_it_is():
    protocol = trapezoid(1.0, 30.0, 10.0, 30.0)
    time = np.linspace(0.0, 70.0, 500)
    recording = Recording(time, protocol.load_at(time), np.sqrt(protocol.load_at(time)))
    assert time_shift(recording, protocol) == pytest.approx(0.0, abs=1e-3)


def test_half_of_the_samples_follow_the_load():
    first = constant_strain_rate(0.0)
    protocol = recorded(first.time, first.load, 60)
    steep = (protocol.sample_time > 40) & (protocol.sample_time <= 50)
    even = 60 * 10 / first.time[-1]
    assert steep.sum() > 1.5 * even
    assert (np.diff(protocol.sample_time) <= 2.01 * first.time[-1] / 60).all()


def test_times_that_differ_by_rounding_alone_are_repeated():
    time = np.array([0.0, 0.2, 0.4, 0.4 + 1e-13, *np.arange(0.6, 10, 0.2)])
    kept, warnings = usable("", time, time)
    assert len(kept) == len(time) - 1
    assert warnings == ()
