"""Workbooks with a sheet for each test: names in any letters, units in brackets, other words; tagged tests."""

import numpy as np
import pytest
from test_readers_workbooks import DEPTH, LOAD, TIME, kla, run, xp
from workbooks import write_workbook

from palpate.cli.main import main
from palpate.errors import InputError
from palpate.recordings.readers import read_each, read_source, read_vendor_file

SUMMARY = [["Time Mean", "Load Mean", "x"], ["s", "mN", ""], [1.0, 1.0, ""], [2.0, 2.0, ""]]


def sheet(names, units=("s", "mN", "nm"), markers="Markers", turn=1.0):
    """A sheet of a test whose surface is marked where depth is zero, 20 s after the first point."""
    marked = ["Surface Index" if k == 200 else "" for k in range(len(TIME))]
    values = np.column_stack([TIME + 20, LOAD, DEPTH / turn]).tolist()
    below = [["", *units]] if units else []
    body = [[mark, *row] if markers else row for mark, row in zip(marked, values, strict=True)]
    if not markers:
        below = [row[1:] for row in below]
    return [[markers, *names] if markers else [*names], *below, *body]


@pytest.mark.parametrize(
    ("names", "units"),
    [
        (("TIME", "LOAD", "DEPTH"), ("s", "mN", "nm")),
        (("TIME", "LOAD", "DEPTH"), ("S", "mN", "NM")),
        (("time", "load", "depth"), ("Sec.", "mN", "nanometers")),
        (("TIME_ON_SAMPLE", "LOAD_ON_SAMPLE", "DISPLACEMENT_INTO_SURFACE"), ("s", "mN", "nm")),
        (("Time On Sample", "Load On Sample", "Displacement Into Surface"), ("s", "mN", "nm")),
        (("Time (s)", "Load [mN]", "Depth {nm}"), None),
        (("TIME [sec]", "LOAD <mN>", "DEPTH (NM)"), None),
        (("Test Time", "Corrected Load", "Penetration Depth"), ("s", "mN", "nm")),
    ],
)
@pytest.mark.parametrize("test", ["Test 1", "TEST 001", "Test_1", "Test #1"])
def test_kla_headings_in_any_letters(tmp_path, names, units, test):
    file = write_workbook(tmp_path / "x.xlsx", {"Sample Summary": SUMMARY, test: sheet(names, units)})
    (whole,) = read_vendor_file(file, contact="none")
    assert whole.recording.time == pytest.approx(TIME)
    assert whole.recording.load == pytest.approx(LOAD)
    assert whole.recording.depth == pytest.approx(DEPTH)
    assert whole.warnings == ()


def test_other_units_in_brackets_are_used(tmp_path):
    file = write_workbook(
        tmp_path / "x.xlsx", {"Test 1": sheet(("TIME (s)", "LOAD (mN)", "DEPTH (µm)"), None, turn=1e3)}
    )
    (test,) = read_vendor_file(file, contact="none")
    assert test.recording.depth == pytest.approx(DEPTH)


def test_without_markers_and_units_a_sheet_is_of_no_format(tmp_path):
    sheets = {"Test 1": sheet(("Time", "Load", "Depth"), None, markers="")}
    with pytest.raises(InputError, match=r"no format that palpate knows.*--columns"):
        read_vendor_file(write_workbook(tmp_path / "x.xlsx", sheets))
    sheets = {"Test 1": sheet(("Time", "Load", "Depth"), markers="")}
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", sheets))
    assert "no marker gives the surface" in test.warnings[0]


def test_depth_is_zero_where_the_surface_is_marked(tmp_path):
    sheets = {"Test 1": [[*row[:3], row[3] + 700 if k > 1 else row[3]] for k, row in enumerate(kla())]}
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", sheets))
    assert test.warnings == ()
    assert test.recording.depth == pytest.approx(DEPTH[200:], abs=1e-6)


def test_a_marker_among_an_xp_s_segments_is_contact(tmp_path):
    """Where the clock does not count from there."""
    rows = [["Segment", *xp()[0]], ["", *xp()[1]], *(["", row[0] + 20, *row[1:]] for row in xp()[2:])]
    rows[2 + 200][0] = "Surface Marker"
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1": rows}))
    assert test.recording.time == pytest.approx(TIME[200:])
    assert test.recording.depth == pytest.approx(DEPTH[200:])


def test_an_xp_sheet_that_marks_no_surface_begins_at_the_contact_found(tmp_path):
    rows = [*xp()[:2], *([row[0] + 20, row[1], row[2] + 400, *row[3:]] for row in xp()[2:])]
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1": rows}))
    assert test.warnings[0].startswith("the file marks no contact, the load does not rise over the first 4")
    assert test.recording.depth.max() == pytest.approx(500, abs=20)


def test_a_sheet_without_units_beside_its_markers_is_told(tmp_path):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": sheet(("Time", "Load", "Depth"), None)})
    with pytest.raises(InputError, match="states no unit of Time, in brackets or in its second row"):
        read_vendor_file(file)


def test_megas_in_capitals_are_no_millis(tmp_path):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": sheet(("TIME", "LOAD", "DEPTH"), ("S", "MN", "NM"))})
    with pytest.raises(InputError, match="LOAD is in 'MN'; export it in one of: mN"):
        read_vendor_file(file)


TAGS = ["Test 2 Tagged", "TEST 2 TAGGED", "Test 2 (excluded)", "Test 2_rejected", "Test 2 - Bad"]


@pytest.mark.parametrize("name", TAGS)
@pytest.mark.parametrize("of", [kla, xp])
def test_a_tagged_test_is_told_and_left_out_unless_it_is_named(tmp_path, name, of, capsys):
    sheets = {"Test 1": of(), name: of(peak=2), "Test 3": of(peak=3)}
    assert run(tmp_path, sheets) == (0, {"Test_1": 5, "Test_3": 15})
    line = capsys.readouterr().err.strip()
    assert "\n" not in line
    assert f"{name}: the vendor's file calls it " in line
    assert line.endswith("the test is left out")
    file = tmp_path / "x.xlsx"
    assert main(["read", str(file), "--test", "2", "-o", str(tmp_path / "one")]) == 0
    assert "the vendor's file calls it" in capsys.readouterr().err
    assert [test.name for test in read_vendor_file(file)] == ["Test 1", "Test 3"]
    assert len(read_each(file)) == 3
    (chosen,) = read_source({"file": str(file), "conditions": {"P": [name]}})["P"]
    assert chosen.recording.load.max() == pytest.approx(10, rel=0.01)
    assert chosen.recording.time[0] == 0


def test_where_all_tests_are_tagged_the_line_says_how_to_take_one(tmp_path):
    with pytest.raises(InputError, match="the vendor's file calls it tagged; `--test 'Test 1 Tagged'`"):
        read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1 Tagged": kla()}))
