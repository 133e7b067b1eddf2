"""A column that the user names may not be what its name says: the piezo's way, or a channel with a clock of its own."""

import numpy as np
import pytest

from indentation_files.readers import ColumnMap, read_vendor_file

TIME = np.linspace(0.0, 20.0, 101)
LOAD = np.interp(TIME, [0.0, 10.0, 20.0], [0.0, 5.0, 0.0])
DEPTH = 300.0 * np.sqrt(LOAD)


def read(tmp_path, headings, values, **columns):
    rows = ["\t".join(f"{value:.9g}" for value in row) for row in zip(*values, strict=True)]
    (tmp_path / "test.txt").write_text("\n".join(["\t".join(headings), *rows]))
    (test,) = read_vendor_file(tmp_path / "test.txt", columns=ColumnMap(columns))
    assert (test.recording.load.max(), test.recording.depth.max()) == pytest.approx((5.0, 300.0 * np.sqrt(5.0)))
    return test.warnings


@pytest.mark.parametrize(
    "heading", ["Piezo (nm)", "Calc_Ramp_Ex_nm", "Height_Sensor_nm_Ex", "height (piezo) [nm]", "Z-stage (nm)"]
)
@pytest.mark.parametrize("by_number", [True, False])
def test_the_way_of_the_piezo_is_no_depth(tmp_path, heading, by_number):
    depth = "3" if by_number else heading
    (told,) = read(
        tmp_path,
        ["Time (s)", "Load (mN)", heading],
        [TIME, LOAD, DEPTH],
        **({"time": "1", "load": "2"} if by_number else {"time": "Time (s)", "load": "Load (mN)"}),
        depth=depth,
    )
    assert told.startswith(f"{heading!r} is the way of the drive, by its name")


@pytest.mark.parametrize("heading", ["Depth (nm)", "Indentation (nm)", "Piezoindentation (nm)", "h (nm)"])
def test_a_depth_gets_no_such_word(tmp_path, heading):
    values = [TIME, LOAD, DEPTH]
    assert read(tmp_path, ["Time (s)", "Load (mN)", heading], values, time="1", load="2", depth="3") == ()


def test_a_clock_before_each_channel_is_told_where_they_differ(tmp_path):
    headings = ["Time displacement (s)", "Displacement (nm)", "Time load (s)", "Load (mN)"]
    (told,) = read(tmp_path, headings, [TIME, DEPTH, TIME + 0.5, LOAD], time="1", depth="2", load="4")
    assert told.startswith("load behind 'Time load (s)' and depth behind 'Time displacement (s)' may have times")
    assert "differ by up to 0.5;" in told
    assert read(tmp_path, headings, [TIME, DEPTH, TIME, LOAD], time="1", depth="2", load="4") == ()


def test_tests_beside_one_another_have_one_clock_each(tmp_path):
    headings = ["Time (s)", "Load (mN)", "Depth (nm)", "Time (s)", "Load (mN)", "Depth (nm)"]
    values = [TIME, LOAD, DEPTH, TIME + 9.0, LOAD, DEPTH]
    assert read(tmp_path, headings, values, time="1", load="2", depth="3") == ()
    assert read(tmp_path, headings, values, time="4", load="5", depth="6") == ()
    (told,) = read(tmp_path, headings, values, time="1", load="2", depth="6")
    assert "differ by up to 9;" in told
