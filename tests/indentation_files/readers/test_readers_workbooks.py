"""Workbooks: the order and the units of their sheets, spoilt sheets beside good ones, contact without a marker."""

import zipfile
from types import SimpleNamespace

import numpy as np
import pytest
from keysight_sheets import DEPTH, kla, run, xp
from public_files import KLA, XP, needs_recordings
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, read_each, read_source, read_vendor_file, select
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.data.study_recordings import convert_source
from palpate.errors import InputError

KLA_UNITS = {"Markers": "", "Time": "s", "Load": "mN", "Depth": "nm"}
XP_UNITS = {
    "Displacement Into Surface": "nm", "Load On Sample": "mN", "Time On Sample": "s", "Frame Stiffness": "N/m",
    "Harmonic Contact Stiffness": "N/m", "Harmonic Stiffness": "N/m", "Raw Displacement": "um", "Raw Load": "mN",
}  # fmt: skip


def counting(units):
    """A sheet whose channels all count 0, 1, ... in their units."""
    return [
        list(units),
        list(units.values()),
        *([k or "" if name == "Markers" else k for name in units] for k in range(40)),
    ]


def results(drifts):
    return [["Test", "Drift Correction"], ["", "nm/s"], *([str(k), drift] for k, drift in drifts.items())]


@pytest.mark.parametrize("sheet", [xp, kla])
@pytest.mark.parametrize(("wanted", "load"), [("10", 50), ("2", 10), ("Test 3", 15), ("1", 5)])
def test_sheets_are_known_by_their_numbers(tmp_path, sheet, wanted, load):
    file = write_workbook(tmp_path / "x.xlsx", {f"Test {k}": sheet(peak=k) for k in (1, 10, 2, 3)})
    tests = read_vendor_file(file)
    assert [test.name for test in tests] == ["Test 1", "Test 2", "Test 3", "Test 10"]
    assert select(tests, wanted, file).recording.load.max() == pytest.approx(load, rel=0.01)
    with pytest.raises(InputError, match="no test '4'"):
        select(tests, "4", file)


@pytest.mark.parametrize("sheet", [xp, kla])
@pytest.mark.parametrize(
    "spoil", [lambda rows: [], lambda rows: [["aborted"]], lambda rows: rows[:2], lambda rows: rows[:3]]
)
@pytest.mark.parametrize("name", ["Test 0", "Test 9"])
def test_a_spoilt_sheet_is_named_and_the_others_are_read(tmp_path, sheet, spoil, name, capsys):
    sheets = {name: spoil(sheet()), "Test 1": sheet(), "Test Summary": [["a", "b"], [1, 2]], "Test 2": sheet(peak=2)}
    assert run(tmp_path, sheets) == (0, {"Test_1": 5, "Test_2": 10})
    line = capsys.readouterr().err.strip()
    assert name in line
    assert line.endswith("the test is left out")
    assert "\n" not in line
    assert run(tmp_path, sheets, "--test", "2") == (0, {"Test_1": 5, "Test_2": 10})
    assert capsys.readouterr().err == ""
    assert run(tmp_path, sheets, "--test", name)[0] == 2
    with pytest.raises(InputError, match=name):
        read_vendor_file(tmp_path / "x.xlsx")
    assert len(read_each(tmp_path / "x.xlsx")) == 3


def test_a_test_that_never_touched_is_left_out_unless_all_are(tmp_path, capsys):
    assert run(tmp_path, {"Test 1": xp(touched=False), "Test 2": xp()}) == (0, {"Test_2": 5})
    assert "Test 1: the indenter never touched the sample" in capsys.readouterr().err
    assert run(tmp_path, {"Test 1": xp(touched=False)})[0] == 2


@pytest.mark.parametrize("spelt", [str, lambda value: str(value).replace(".", ",")])
def test_numbers_written_as_text_are_read(tmp_path, spelt):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": kla(spelt=spelt)})
    (test,) = read_vendor_file(file, contact="none")
    assert test.recording.depth == pytest.approx(DEPTH)


@pytest.mark.parametrize("marker", ["Surface Index", " surface index", "SURFACE"])
def test_a_marker_of_the_surface_is_contact(tmp_path, marker):
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1": kla(marker)}))
    assert test.recording.depth[0] == pytest.approx(0)
    assert test.warnings == ()


@pytest.mark.parametrize("marker", [None, "Oberfläche"])
def test_without_a_marker_the_load_tells_the_contact(tmp_path, marker):
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"Test 1": kla(marker)}))
    assert test.recording.time[0] == 0
    assert test.recording.depth[0] == pytest.approx(0, abs=4)
    assert "no marker gives the surface" in test.warnings[0]


@pytest.mark.parametrize("drift", [0.5, "0,5"])
def test_corrections_take_what_the_workbook_states(tmp_path, drift):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": xp(), "Results": results({1: drift})})
    (both,) = read_vendor_file(file, corrections=frozenset({"drift", "frame"}))
    assert both.recording.depth == pytest.approx(DEPTH[200:], abs=1e-3)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("drift", "frame", "corrections", "words"),
    [
        ("n/a", 5e6, "drift", "Drift Correction [nm/s] is 'n/a', no number; leave drift off"),
        (1.7976931348623157e308, 5e6, "drift", "no number; leave drift off"),
        (None, 5e6, "drift", "the sheet Results gives no Drift Correction"),
        ("n/a", 0.0, "frame", "Frame Stiffness is 0 N/m, expected more than zero; leave frame off"),
        ("n/a", 0.0, "", None),
    ],
)
def test_a_correction_that_is_not_stated_is_missed_only_when_it_is_asked_for(
    tmp_path, drift, frame, corrections, words, capsys
):
    sheets = {"Test 1": xp(frame=frame), "Results": results({} if drift is None else {1: drift})}
    status, _ = run(tmp_path, sheets, *(["--correct", corrections] if corrections else ["--raw"]))
    line = capsys.readouterr().err.strip()
    assert status == (0 if words is None else 2)
    assert (words or "") in line
    assert "\n" not in line


@pytest.mark.parametrize(
    ("channels", "name", "unit", "known"),
    [
        *(
            (KLA_UNITS, "Load", unit, "mN, uN, nN, pN, cN, N, gf, mgf, kgf, dyne, lbf, kN, daN")
            for unit in ("ms", "s", "nm", "N/m")
        ),
        *((KLA_UNITS, "Depth", unit, "nm, um, mm, cm, m, A, pm, inch") for unit in ("mN", "N/m", "nm/s")),
        (KLA_UNITS, "Time", "nm", "s, ms, us, min, h, d"),
        (XP_UNITS, "Load On Sample", "nm", "mN, uN, nN, pN, cN, N, gf, mgf, kgf, dyne, lbf, kN, daN"),
        (XP_UNITS, "Harmonic Contact Stiffness", "nm", "N/m"),
        (XP_UNITS, "Frame Stiffness", "nm", "N/m"),
    ],
)
def test_a_unit_of_another_quantity_is_refused(tmp_path, channels, name, unit, known):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": counting(channels)})
    assert len(read_vendor_file(file)) == 1
    write_workbook(file, {"Test 1": counting(channels | {name: unit})})
    with pytest.raises(InputError, match=f"x.xlsx, sheet Test 1: {name} is in '{unit}'; export it in one of: {known}$"):
        read_vendor_file(file)


def test_what_the_workbook_says_is_copied_as_it_was_meant(tmp_path):
    """A heading torn at its comma is one again, and units whose UTF-8 was read as Latin-1 are mended."""
    said = [
        ["Test", "Rate", "Drift? (1-Y", "0-N)", "X", "Area", "Prüfung (A) of", "B)"],
        ["", "Hz", " Integer", "Âµm", "nmÂ²", "Î¼m", "", ""],
        ["1", 10, 1, 0.5, 7, 8, 9, ""],
    ]
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": kla(), "Results": said})
    (test,) = read_vendor_file(file)
    assert test.metadata == {
        "Rate [Hz]": "10", "Drift? (1-Y, 0-N) [Integer]": "1", "X [µm]": "0.5", "Area [nm²]": "7",
        "Prüfung (A) of [μm]": "8", "B)": "9",
    }  # fmt: skip


@needs_recordings
def test_the_comments_of_a_kla_workbook_are_whole():
    facts = read_vendor_file(KLA)[0].metadata
    assert facts["Drift Correction? (1-Y, 0-N) [Integer]"] == "1"
    assert facts["Poisson's Ratio of Sample [None]"] == "0.188"
    assert facts["X_Position [µm]"] == "129010.98"


@pytest.mark.parametrize(
    ("sheets", "words"),
    [
        ({"Test 1": KLA_UNITS, "Test 2": KLA_UNITS}, "holds no stiffness by oscillation; no column is added"),
        ({"Test 1": XP_UNITS}, None),
    ],
)
def test_a_stiffness_that_is_asked_for_and_not_measured_is_told_once(tmp_path, sheets, words, capsys):
    tables = {name: counting(units) for name, units in sheets.items()}
    assert run(tmp_path, tables)[0] == 0
    assert "no stiffness" not in capsys.readouterr().err
    assert run(tmp_path, tables, "--stiffness")[0] == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if "no stiffness" in line]
    assert lines == ([f"palpate: {tmp_path / 'x.xlsx'}: {words}"] if words else [])


def test_the_tests_without_the_stiffness_that_others_have_are_named(tmp_path, capsys):
    without = {name: unit for name, unit in XP_UNITS.items() if not name.startswith("Harmonic")}
    assert run(tmp_path, {"Test 1": counting(XP_UNITS), "Test 2": counting(without)}, "--stiffness")[0] == 0
    assert "holds no stiffness by oscillation in Test 2; no column is added" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "units", "header"),
    [
        ([], XP_UNITS, "time_s,load_mN,depth_nm"),
        (["--stiffness"], XP_UNITS, "time_s,load_mN,depth_nm,stiffness_mN_per_nm"),
        (["--stiffness"], KLA_UNITS, "time_s,load_mN,depth_nm"),
    ],
)
def test_a_recording_has_three_columns_unless_stiffness_is_asked_for_and_measured(tmp_path, options, units, header):
    assert run(tmp_path, {"Test 1": counting(units)}, *options) == (0, {"Test_1": 39})
    lines = (tmp_path / "out/Test_1.csv").read_text().splitlines()
    assert next(line for line in lines if not line.startswith("#")) == header


def test_a_study_s_recordings_have_three_columns_and_keep_the_stiffness_apart(tmp_path):
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": counting(XP_UNITS)})
    source = {"file": str(file), "condition": "A"}
    study = SimpleNamespace(source=source, source_tests=lambda: {"A": read_vendor_file(file)})
    convert_source(study, tmp_path / "lab")
    lines = (tmp_path / "lab/A_1.csv").read_text().splitlines()
    assert {line.count(",") for line in lines if not line.startswith("#")} == {2}
    stiffness = read_recording(tmp_path / "lab/A_1.csv").stiffness
    assert stiffness == pytest.approx(read_vendor_file(file)[0].recording.stiffness)


@pytest.mark.parametrize("head", [["t,P,h"], ["t,P,h", "s,uN,nm"]])
def test_a_sheet_without_rows_does_no_harm_to_the_others(tmp_path, head, capsys):
    named = [row.split(",") for row in head]
    good = [*named, *([k, k, k] for k in range(40))]
    columns = ["--columns", "time=t,load=P,depth=h", "-o", str(tmp_path / "out")]
    file = write_workbook(tmp_path / "x.xlsx", {"A": named, "B": good, "C": []})
    assert main(["read", str(file), *columns]) == 0
    assert main(["read", str(file), "--test", "B", *columns]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["B.csv"]
    said = f"palpate: {file}, sheet A: holds no row of numbers in the columns t, P, h; export it again, or name other"
    lines = [line for line in capsys.readouterr().err.splitlines() if "no unit" not in line]
    assert lines == [f"{said} columns for it; the sheet is left out"]
    for rows, words in ((named, "has the columns t, P, h, but no row"), ([], "holds no table with numbers in the")):
        write_workbook(file, {"A": rows})
        assert main(["read", str(file), *columns]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (
            [["t", "P", "h"], [0, 0, 0], [1, "lost", 1], [2, 2, 2]],
            "sheet A, row 3: '1.0, lost, 1.0' is not three numbers",
        ),
        ([["t", "P", "h", "h"], [0, 0, 0, 0], [1, 1, 1, 1]], "A: several columns are called 'h'"),
        ([["t", "P", "h"], ["s", "V", "nm"], [0, 0, 0], [1, 1, 1]], "the load's unit 'V' is not known"),
    ],
)
def test_a_table_that_cannot_be_read_is_named_and_the_others_are_read(tmp_path, spoilt, words, capsys):
    sheets = {"A": spoilt, "B": [["t", "P", "h"], ["s", "mN", "nm"], [0, 0, 0], [1, 7, 1]]}
    by_name = ("--columns", "time=t,load=P,depth=h")
    assert run(tmp_path, sheets, *by_name) == (0, {"B": 7})
    line = capsys.readouterr().err.strip()
    assert words in line
    assert line.endswith("the test is left out")
    assert run(tmp_path, sheets, *by_name, "--test", "B") == (0, {"B": 7})
    assert capsys.readouterr().err == ""
    assert run(tmp_path, {"A": spoilt}, *by_name)[0] == 2
    assert words in capsys.readouterr().err


GOOD = [["Time (s)", "Load (mN)", "Depth (nm)"], *([k, k, k] for k in range(40))]
NAMED = {"time": "Time (s)", "load": "Load (mN)", "depth": "Depth (nm)"}
NUMBERED = {"time": "1", "load": "2", "depth": "3"}


@pytest.mark.parametrize(
    ("rows", "columns", "words"),
    [
        (
            [*GOOD[:1], *[["x", "y", "z"]] * 20],
            NAMED,
            "holds no row of numbers in the columns Time (s), Load (mN), Dep",
        ),
        ([*GOOD[:1], *[["1 s", "y", "z"]] * 20], NAMED, "(sheet B, row 2: '1 s, y, z')"),
        ([*GOOD[:1], *[["x", "y", "z"]] * 20], NUMBERED, "holds no row of numbers in the columns 1, 2, 3"),
        (
            [["Time (s)", "Force (N)", "Depth (nm)"], *GOOD[1:]],
            NAMED,
            "has no column Load (mN); if it is a test, read it in a call of its",
        ),
        (
            [["Time (s)", "Force (N)", "Depth (um)"], *GOOD[1:]],
            NAMED,
            "by its own names (Time (s), Force (N), Depth (um",
        ),
        ([["Time (s)", "Force (N)", "Path (um)"], *GOOD[1:]], NAMED, "has no columns Load (mN), Depth (nm); i"),
        ([], NAMED, None),
        ([["This workbook holds"], ["two tests", "of glass"]], NAMED, None),
        ([["operator", "A. Smith"], ["a", "b", "c"]], NUMBERED, None),
    ],
)
def test_a_sheet_that_gives_no_test_is_named_unless_it_holds_no_table(tmp_path, rows, columns, words, capsys):
    chosen = ["--columns", ",".join(f"{key}={name}" for key, name in columns.items())]
    sheets = {"A": GOOD, "B": rows, "C": GOOD}
    assert run(tmp_path, sheets, *chosen) == (0, {"A": 39, "C": 39})
    said = [line for line in capsys.readouterr().err.splitlines() if "no unit" not in line]
    assert len(said) == (words is not None)
    for line in said:
        assert line.startswith(f"palpate: {tmp_path / 'x.xlsx'}, sheet B: ")
        assert words in line
        assert line.endswith("; the sheet is left out")
    assert run(tmp_path, sheets, *chosen, "--test", "2") == (0, {"A": 39, "C": 39})
    assert "sheet B" not in capsys.readouterr().err
    assert len(read_vendor_file(tmp_path / "x.xlsx", columns=ColumnMap(columns))) == 2
    source = {"file": str(tmp_path / "x.xlsx"), "condition": "all", "columns": columns}
    assert [test.name for test in read_source(source)["all"]] == ["A", "C"]


@pytest.mark.parametrize("cell", ["<f>A1</f><v/>", "<f>A1</f><v></v>", "<f>A1</f>", '<f t="shared" si="0"/><v />'])
def test_formulas_without_stored_values_are_told(tmp_path, cell, capsys):
    columns = ["--columns", "time=1,load=2,depth=3", "-o", str(tmp_path / "out")]
    file = write_workbook(tmp_path / "x.xlsx", {"A": [[*row[:2], "@"] for row in GOOD[1:]]})
    text = '<is><t xml:space="preserve">@</t></is>'
    with zipfile.ZipFile(file) as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    for told, value in ((True, cell), (False, "<f>A1</f><v>7</v>")):
        with zipfile.ZipFile(file, "w") as archive:
            for name, part in parts.items():
                archive.writestr(name, part.replace(text, value).replace(' t="inlineStr"', ""))
        status = main(["read", str(file), *columns, "--contact", "none"])
        line = capsys.readouterr().err
        assert status == (2 if told else 0)
        problem = f"palpate: {file}, sheet A: the columns 1, 2, 3 hold formulas without stored values; "
        assert line.startswith(problem) is told
        assert ("open the workbook in a spreadsheet program and save it there first" in line) is told


def test_sheets_whose_names_look_alike_are_all_written(tmp_path):
    names = ["Prüfung 1", "Pr_fung_1", "Pr_fung_1_2", "Pr_fung_1_3"]
    tables = {name: [["t", "P", "h"], [0, 0, 0], [1, k, 1]] for k, name in enumerate(names, 1)}
    file = write_workbook(tmp_path / "x.xlsx", tables)
    assert main(["read", str(file), "--columns", "time=t,load=P,depth=h", "-o", str(tmp_path / "out")]) == 0
    loads = sorted(read_recording(path).load.max() for path in (tmp_path / "out").iterdir())
    assert loads == [1, 2, 3, 4]


@needs_recordings
@pytest.mark.parametrize("lost", [1000, 97, 512, 3000])
def test_an_old_workbook_that_is_cut_gets_one_line(tmp_path, lost, capfd):
    file = tmp_path / "cut.xls"
    file.write_bytes(XP.read_bytes()[:-lost])
    assert main(["read", str(file), "-o", str(tmp_path)]) == 2
    said = capfd.readouterr().err.strip()
    assert "is no whole Excel workbook" in said or "is damaged" in said
    assert "\n" not in said


def test_an_xp_s_channels_have_other_names_in_some_methods(tmp_path):
    sheet = xp()
    renamed = {"Time On Sample": "Time in Contact", "Load On Sample": "Force On Surface"}
    other = [[renamed.get(name, name) for name in sheet[0]], *sheet[1:]]
    usual, unusual = (
        read_vendor_file(write_workbook(tmp_path / f"{k}.xlsx", {"Test 001": rows}))[0].recording
        for k, rows in enumerate((sheet, other))
    )
    assert np.array_equal(usual.depth, unusual.depth)
    assert np.array_equal(usual.time, unusual.time)
