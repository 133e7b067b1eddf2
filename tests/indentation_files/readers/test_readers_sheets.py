"""Workbooks with a sheet for each test: names in any letters, units in brackets, other words; tagged tests."""

import zipfile

import numpy as np
import pytest
from keysight_sheets import DEPTH, LOAD, TIME, kla, run, xp
from workbooks import write_workbook

from indentation_files.readers import Unreadable, read_each, read_source, read_vendor_file, select
from palpate.cli.main import main
from palpate.errors import InputError

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


TAGS = ["Test 2 Tagged", "TEST 2 TAGGED", "Test 2 (excluded)", "Test 2_rejected", "Test 2 - Bad", "T002 Tagged"]


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


def test_a_remark_in_the_name_of_a_sheet_is_told_where_most_have_none(tmp_path):
    sheets = {name: kla() for name in ("Test 1", "Test 2 outlier", "Test 3", "Test 4")}
    tests = read_vendor_file(write_workbook(tmp_path / "x.xlsx", sheets))
    said = ["the sheet's name says 'outlier': look whether the test counts" in test.warnings for test in tests]
    assert said == [False, True, False, False]
    every = {f"Test {number} (glass)": kla() for number in (1, 2, 3)}
    assert [test.warnings for test in read_vendor_file(write_workbook(tmp_path / "x.xlsx", every))] == [()] * 3


def test_where_all_tests_are_tagged_the_line_says_how_to_take_one(tmp_path):
    with pytest.raises(InputError, match="the vendor's file calls it tagged; `--test 'Test 1 Tagged'`"):
        read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1 Tagged": kla()}))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("Indent two", "the sheet holds the columns of a test, and is not called 'Test' with a number"),
        ("Indent two Tagged", "the vendor's file calls it tagged"),
    ],
)
@pytest.mark.parametrize("of", [kla, xp])
def test_a_sheet_with_the_columns_of_a_test_and_another_name_is_told(tmp_path, name, reason, of, capsys):
    sheets = {"Test 1": of(), name: of(peak=2), "Summary": SUMMARY}
    assert run(tmp_path, sheets) == (0, {"Test_1": 5})
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{name}: {reason}; `--test {name!r}`" in line
    assert line.endswith("the test is left out")
    file = tmp_path / "x.xlsx"
    assert main(["draft", str(file), "-o", str(tmp_path / "study")]) == 0
    assert line in capsys.readouterr().err.splitlines()
    assert main(["read", str(file), "--test", name, "--survey", "-o", str(tmp_path / "one")]) == 0
    assert reason in capsys.readouterr().err
    (chosen,) = read_source({"file": str(file), "conditions": {"P": [name]}})["P"]
    assert (chosen.recording.time[0], chosen.recording.load.max()) == (0, pytest.approx(10, rel=0.01))


def test_a_damaged_sheet_beside_the_tests_is_told_and_costs_nothing_else(tmp_path, capsys):
    sheets = {"Test 1": xp(), "Notes": SUMMARY}
    whole, spoilt = write_workbook(tmp_path / "whole.xlsx", sheets), tmp_path / "spoilt.xlsx"
    with zipfile.ZipFile(whole) as old, zipfile.ZipFile(spoilt, "w") as new:
        for part in old.namelist():
            content = old.read(part)
            new.writestr(part, content[: len(content) // 2] if part.endswith("sheet2.xml") else content)
    assert main(["read", str(spoilt), "-o", str(tmp_path / "out")]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert "sheet Notes: is damaged" in line


def test_sheets_called_t_with_a_number_are_tests(tmp_path):
    assert run(tmp_path, {"T010": kla(peak=2), "T002": kla()}) == (0, {"T002": 5, "T010": 10})


def test_numbers_that_several_names_share_are_those_of_their_order():
    """As where a file called Test 3 holds two tests below one another."""
    tests = [Unreadable(name, InputError(name, remedy="")) for name in ("Test 3_1", "Test 3_2", "Test 7")]
    for wanted, name in (("1", "Test 3_1"), ("2", "Test 3_2"), ("7", "Test 7")):
        with pytest.raises(InputError, match=name):
            select(tests, wanted, "x.txt")


@pytest.mark.parametrize(("bracket", "below"), [("mN", "uN"), ("µN", "N")])
def test_two_units_of_one_column_are_refused(tmp_path, bracket, below):
    names, units = ("Time (sec)", f"Load ({bracket})", "Depth (NM)"), ("s", below, "nm")
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": sheet(names, units)})
    with pytest.raises(InputError, match=r"sheet Test 1: Load is in '[mu]N and u?N'"):
        read_vendor_file(file)
