"""An instrument that records before it moves: the rest is left out in one line, and nothing else is."""

import numpy as np
import pytest
from keysight_sheets import kla
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, read_vendor_file
from indentation_files.readers.vendor import VendorTest
from indentation_files.readers.zero import zeroed
from indentation_files.recording import Recording

RESTS = "the instrument rests without load for the first "
UP, STEP = 30.0, 0.1


def begun(rest, noise=0.0, power=1.0, marked=False, after=0.3):
    """A test of 30 s of loading under P = t^power, hold, unloading and a hold `after` it, behind a `rest` [s]."""
    time = np.arange(0.0, 100.0, STEP)
    load = 5.0 * np.interp(time, [0, UP, 50, 80], [0, 1, 1, after])
    load[time < UP] = 5.0 * (time[time < UP] / UP) ** power
    depth = np.interp(time, [UP, 50, 80, 100], [500, 530, 300, 290])
    depth[time < UP] = 500 * np.sqrt(load[time < UP] / 5.0)
    still = np.zeros(round(rest / STEP))
    load, depth = np.concatenate([still, load]), np.concatenate([still, depth])
    rng = np.random.default_rng(3)
    load, depth = (channel + noise * np.ptp(channel) * rng.standard_normal(len(channel)) for channel in (load, depth))
    whole = Recording(STEP * np.arange(len(load)), load, depth, "glass")
    return whole, zeroed(VendorTest("glass", whole, marked=marked), "file")


@pytest.mark.parametrize("marked", [False, True])
@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01])
@pytest.mark.parametrize("power", [1.0, 2.0])
@pytest.mark.parametrize("rest", [20.0, 60.0, 600.0])
def test_a_rest_is_left_out_and_said_in_one_line(rest, noise, power, marked):
    """To a twentieth of the time of loading, and to what the noise hides of a quadratic start."""
    whole, test = begun(rest, noise, power, marked)
    (line,) = [warning for warning in test.warnings if warning.startswith(RESTS)]
    left_out = len(whole) - len(test.recording)
    assert left_out * STEP == pytest.approx(rest, abs=UP * (0.05 + np.sqrt(noise) / 2))
    assert f"these {left_out} points are left out" in line
    assert test.recording.time[0] == 0.0
    assert np.array_equal(test.recording.depth, whole.depth[left_out:])
    assert np.array_equal(test.recording.load, whole.load[left_out:])


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01, 0.03])
@pytest.mark.parametrize("power", [1.0, 2.0])
@pytest.mark.parametrize("rest", [0.0, STEP])
def test_a_test_whose_first_sample_alone_is_zero_stays_as_it_is(rest, noise, power):
    whole, test = begun(rest, noise, power)
    assert not [warning for warning in test.warnings if warning.startswith(RESTS)]
    assert np.array_equal(test.recording.time, whole.time)


def test_recovery_without_load_after_unloading_is_data():
    whole, test = begun(60.0, after=0.0)
    assert test.recording.time[-1] == pytest.approx(whole.time[-1] - 60.0)
    assert test.recording.depth[-1] == whole.depth[-1]


def test_a_hold_under_a_preload_is_no_rest():
    whole, _ = begun(60.0)
    pressed = Recording(whole.time, np.maximum(whole.load, 0.05), np.maximum(whole.depth, 50.0), "glass")
    test = zeroed(VendorTest("glass", pressed, marked=False), "file")
    assert not [warning for warning in test.warnings if warning.startswith(RESTS)]
    assert len(test.recording) == len(whole)


def test_who_wants_the_whole_file_gets_it():
    whole, _ = begun(60.0)
    assert len(zeroed(VendorTest("glass", whole, marked=False), "none").recording) == len(whole)


def test_each_of_several_tests_of_a_table_loses_its_own_rest(tmp_path):
    rows = [
        "\n".join(f"{t:.1f}\t{p:.6f}\t{h:.4f}" for t, p, h in zip(r.time, r.load, r.depth, strict=True))
        for r in (begun(20.0)[0], begun(40.0)[0])
    ]
    file = tmp_path / "two.txt"
    file.write_text("Time (s)\tLoad (mN)\tDepth (nm)\n" + "\n\n".join(rows) + "\n")
    tests = read_vendor_file(file, columns=ColumnMap({"time": "1", "load": "2", "depth": "3"}))
    for test, rest in zip(tests, ("20 s", "40 s"), strict=True):
        assert any(RESTS + rest in line for line in test.warnings)
        assert test.recording.time[np.argmax(test.recording.load)] == pytest.approx(UP)


def test_a_rest_behind_a_vendor_s_mark_is_left_out(tmp_path):
    """A KLA workbook whose surface is marked 20 s before anything moves."""
    rows = kla()
    names, units, body = rows[0], rows[1], rows[2:]
    body = [[mark, time, 0.0 if time < 20 else load, max(depth, 0.0)] for mark, time, load, depth in body]
    body[200][0], body[0][0] = None, "Surface Index"
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1": [names, units, *body]}))
    assert any(RESTS + "20 s" in line for line in test.warnings)
    assert test.recording.time[np.argmax(test.recording.load)] == pytest.approx(30, abs=0.3)


def test_what_follows_a_load_of_zero_is_left_out_and_said():
    """With noise the load falls below zero at once: nobody can tell recovery under the tip from a tip that has left."""
    whole, test = begun(0.0, noise=0.001, after=0.0)
    (line,) = test.warnings
    assert "where the load is zero" in line
    assert f": {len(whole) - len(test.recording)} points over " in line
