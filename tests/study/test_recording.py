"""Recordings begin at contact; recorded load histories are followed in few straight pieces."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from indentation_files.recording import Recording
from indentation_files.recording_file import read_history, read_recording, recording_files
from palpate.errors import InputError
from palpate.study.recorded_history import MOST_KNOTS, recorded


def ramp(start=0.0, clock=0.0, n=401, rate=0.5):
    """Load at `rate` from contact at time `clock`, held from 10 s to 14 s, recorded from `start` s after contact."""
    t = np.linspace(0, 20, n)
    t = t[t >= start]
    load = rate * np.interp(t, [0, 10, 14, 20], [0, 10, 10, 4])
    return Recording(t + clock, load, 100 * np.sqrt(np.minimum(t, 10)))


@settings(deadline=None)
@given(clock=st.floats(-50, 500), start=st.floats(0, 2))
def test_time_zero_is_where_loading_began(clock, start):
    begun = ramp(start, clock).from_contact()
    interval = 20 / 400
    assert begun.time[0] == pytest.approx(0.0, abs=interval)
    assert begun.load[0] == pytest.approx(0.0, abs=2e-3 * begun.load.max())
    assert np.all(np.diff(begun.time) > 0)
    peak = begun.time[np.argmax(begun.load >= begun.load.max() * (1 - 1e-9))]
    assert peak == pytest.approx(10.0, abs=1.01 * interval)


@pytest.mark.parametrize(
    ("times", "loads", "before"),
    [
        ([0, 60, 90, 100], [0.05, 0.05, 10, 0], 30 * 0.05 / 9.95),
        ([0, 4.5, 9, 21, 32], [0.2, 2.0, 0.2, 5.0, 0.6], 0.5),
    ],
)
def test_neither_a_preload_nor_later_cycles_tell_when_loading_began(times, loads, before):
    time = np.linspace(0, times[-1], 1001)
    load = np.interp(time, times, loads)
    begun = Recording(time, load, 100 * np.sqrt(load)).from_contact()
    assert begun.time[1] == pytest.approx(before, rel=0.02)


def test_a_clock_that_starts_at_contact_is_kept():
    first_cut = Recording(*(values[1:] for values in (ramp().time, ramp().load, ramp().depth)))
    begun = first_cut.from_contact()
    assert begun.time[1:] == pytest.approx(first_cut.time, abs=0)
    assert (begun.time[0], begun.load[0], begun.depth[0]) == (0, 0, 0)
    whole = ramp()
    assert np.array_equal(whole.from_contact().time, whole.time)


def test_a_clock_that_starts_at_a_first_point_under_load_is_set_back():
    """As exports are that leave out the point at contact: a study that follows such a load begins at zero load."""
    cut = ramp()
    begun = Recording(cut.time[1:] - cut.time[1], cut.load[1:], cut.depth[1:]).from_contact()
    assert (begun.time[0], begun.load[0], begun.depth[0]) == (0, 0, 0)
    assert begun.time == pytest.approx(cut.time)
    assert recorded(begun.time, begun.load).knot_load[0] == 0.0


@pytest.mark.parametrize("approach", [0.3, 1.0, 3.0])
def test_an_approach_before_the_clocks_zero_is_left_out(approach):
    touched = ramp()
    before = np.arange(-approach, -0.01, 0.05)
    time, load = np.append(before, touched.time), np.append(0.0 * before, touched.load)
    begun = Recording(time, load, np.append(20.0 * before, touched.depth)).from_contact()
    assert np.array_equal(begun.time, touched.time) and np.array_equal(begun.depth, touched.depth)


def test_times_of_a_clock_that_counts_from_1970_are_told_apart_when_written(tmp_path):
    recording = ramp(clock=1.6e9, n=41)
    recording.write(tmp_path / "A_1.csv")
    assert read_recording(tmp_path / "A_1.csv").time == pytest.approx(recording.time, abs=1e-5)


@pytest.mark.parametrize("mark", ["\x0b", "\x0c", "\x85", "\u2028"])
def test_a_comment_may_hold_any_character(tmp_path, mark):
    file = tmp_path / "A_1.csv"
    file.write_text(f"# page{mark}1\ntime_s,load_mN,depth_nm\n0,0,0\n1,1,100\n", encoding="utf-8")
    assert len(read_recording(file)) == 2


def test_what_is_no_file_is_not_written_over(tmp_path):
    with pytest.raises(InputError, match="no file"):
        ramp().write(tmp_path)


def test_a_load_that_never_rises_is_refused():
    t = np.linspace(0, 10, 50)
    with pytest.raises(InputError, match="does not rise"):
        Recording(t, 5 - 0.4 * t, t).from_contact()


@settings(deadline=None, max_examples=25)
@given(
    corners=st.lists(st.tuples(st.floats(1, 50), st.floats(0, 10)), min_size=2, max_size=8),
    n=st.integers(500, 4000),
)
def test_few_knots_follow_a_long_history_to_a_thousandth(corners, n):
    ends = np.cumsum([0.0, *(duration for duration, _ in corners)])
    loads = np.array([0.0, *(load for _, load in corners)])
    loads[1] += 1.0
    t = np.linspace(0, ends[-1], n)
    load = np.interp(t, ends, loads)
    protocol = recorded(t, load)
    assert np.abs(protocol.load_at(t) - load).max() <= 1e-3 * load.max() * (1 + 1e-9)
    assert len(protocol.knot_time) <= 3 * len(ends)
    assert (protocol.knot_time[0], protocol.knot_load[0]) == (0, 0)


def test_noise_in_the_load_is_not_followed():
    t = np.linspace(0, 60, 6000)
    true = np.interp(t, [0, 30, 60], [0, 5, 0])
    noisy = true + 0.01 * np.random.default_rng(1).standard_normal(len(t))
    noisy[0] = 0.0
    protocol = recorded(t, noisy)
    assert len(protocol.knot_time) < 20
    assert np.abs(protocol.load_at(t) - true).max() < 10 * 0.01


def test_a_load_that_wanders_wildly_is_refused():
    t = np.linspace(0, 100, 5 * MOST_KNOTS)
    with pytest.raises(InputError, match="corners"):
        recorded(t, 1 - np.cos(2 * np.pi * t * 4))


@pytest.mark.parametrize("amplitude", [0.45, 0.6])
def test_an_oscillation_too_strong_for_its_average_is_refused_with_its_size(amplitude):
    """A sine of amplitude a P has a standard deviation of a rms(P) / sqrt(2); a ramp has rms(P) = max(P) / sqrt(3)."""
    t = np.linspace(0, 60, 6000)
    mean = np.interp(t, [0, 30, 60], [0, 5, 0])
    with pytest.raises(InputError, match="followed up to 10%; export the mean load without its oscillation") as refused:
        recorded(t, mean * (1 + amplitude * np.sin(2 * np.pi * 45 * t)))
    share = float(re.search(r"swings by (\d+)% of its largest", str(refused.value))[1])
    assert share == pytest.approx(100 * amplitude / np.sqrt(6) / (1 + amplitude), rel=0.15)


def test_a_history_under_load_from_the_start_is_refused():
    with pytest.raises(InputError, match="begins at 2 mN"):
        recorded(np.array([0.0, 1.0, 2.0]), np.array([2.0, 4.0, 0.0]))


@pytest.mark.parametrize("before", [[], [-300.0, -20.0], [-9.0]])
def test_a_displacement_before_contact_touches_nothing(before):
    """A file that begins at the last point before contact begins a step of the piezo above the surface."""
    drive = np.array([*before, 100.0, 1000.0, 0.0])
    time = np.arange(len(drive), dtype=float)
    if not before:
        with pytest.raises(InputError, match="begins at 100 nm"):
            recorded(time, drive, control="displacement")
        return
    history = recorded(time, drive, control="displacement")
    assert history.drive_at(time) == pytest.approx(np.maximum(drive, 0.0))


def test_a_history_of_the_wrong_sign_is_refused():
    with pytest.raises(InputError, match="never above zero, as if its sign were wrong"):
        recorded(np.array([0.0, 1.0, 2.0]), np.array([0.0, -2.0, 0.0]))


def test_notes_stay_on_their_line(tmp_path):
    Recording([0.0, 1.0], [0.0, 1.0], [0.0, 5.0], notes=("two\nlines",)).write(tmp_path / "a.csv")
    assert read_recording(tmp_path / "a.csv").notes == ("two lines",)


def test_a_stiffness_written_apart_leaves_three_columns_and_is_read_again(tmp_path):
    time, file = np.linspace(0.0, 4.0, 9), tmp_path / "a_1.csv"
    stiffness = np.where(time > 2.0, 0.1 * np.sqrt(time), np.nan)
    recording = Recording(time, time, 80.0 * np.sqrt(time), notes=("steel",), stiffness=stiffness)
    recording.write_apart(file)
    assert file.read_text().splitlines()[:2] == ["# steel", "time_s,load_mN,depth_nm"]
    assert recording_files(tmp_path) == [file]
    assert read_recording(file).stiffness == pytest.approx(stiffness, rel=1e-6, nan_ok=True)
    recording.at(slice(1, None)).write(file.parent / "stiffness" / file.name)
    with pytest.raises(InputError, match=r"stiffness/a_1.csv: has other times than .*a_1.csv; remove it"):
        read_recording(file)
    Recording(time, time, time).write_apart(file)
    assert read_recording(file).stiffness is None


def test_a_measured_stiffness_travels_with_the_recording(tmp_path):
    time, load = np.linspace(1.0, 5.0, 9), np.linspace(0.5, 2.5, 9)
    stiffness = np.where(time > 2.0, 0.1 * np.sqrt(load), np.nan)
    recording = Recording(time, load, 80.0 * np.sqrt(load), stiffness=stiffness)
    recording.write(tmp_path / "a_1.csv")
    again = read_recording(tmp_path / "a_1.csv")
    assert again.stiffness == pytest.approx(stiffness, rel=1e-6, nan_ok=True)
    begun = again.from_contact()
    assert len(begun.stiffness) == len(begun.time)
    assert len(again.at(slice(3, None)).stiffness) == 6
    with pytest.raises(InputError, match="stiffness differ in length"):
        Recording(time, load, load, stiffness=stiffness[1:])


@pytest.mark.parametrize(
    ("control", "header"), [("load", "time_s,load_mN"), ("displacement", "time_s,displacement_nm")]
)
def test_a_history_that_holds_text_is_refused_with_its_own_columns(tmp_path, control, header):
    file = tmp_path / "history.csv"
    file.write_text(f"{header}\n0,0\n1,ten\n")
    with pytest.raises(InputError, match=f"line 3: '1,ten' is not two numbers; write {header.replace(',', ' and ')}"):
        read_history(file, control)
