"""Vendors' files against facts that their makers printed in them; foreign and broken files against one clear line."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from public_files import ANON, BRUKER, HLD, KLA, LONG, RECORDINGS, STEEL, XP, needs_recordings

from indentation_files.readers import READERS, ColumnMap, read_vendor_file, select
from indentation_files.readers.source import Source
from indentation_files.readers.vendor import usable
from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.errors import InputError

RAW, DRIFT, BOTH = frozenset(), frozenset({"drift"}), frozenset({"drift", "frame"})


@needs_recordings
def test_anton_paar_agrees_with_its_own_header():
    (test,) = read_vendor_file(ANON)
    assert test.recording.load.max() == pytest.approx(11.13, abs=0.005)
    hold_end = test.recording.depth[np.flatnonzero(test.recording.load > 11.1)[-1]]
    assert hold_end == pytest.approx(2110.86, abs=3.0)
    assert test.metadata["EIT"].startswith("2,5187")
    duration = test.recording.time[-1]
    assert 90 < duration < 110


@needs_recordings
def test_several_tests_side_by_side():
    tests = read_vendor_file(LONG)
    assert [test.name for test in tests] == [f"HT_V_300mN_{k}" for k in (1, 2, 3, 4)]
    for test in tests:
        assert test.recording.load.max() == pytest.approx(300, rel=0.01)
        hold = test.recording.load > 0.99 * 300
        assert np.ptp(test.recording.time[hold]) == pytest.approx(500, abs=10)
    assert select(tests, "2", LONG).name == "HT_V_300mN_2"
    with pytest.raises(InputError, match="no test"):
        select(tests, "9", LONG)


@needs_recordings
def test_xp_raw_channels_hold_the_frame_and_the_drift():
    pairs = list(zip(read_vendor_file(XP), read_vendor_file(XP, corrections=RAW), strict=True))
    assert len(pairs) == 9
    for vendor, raw in pairs:
        done, bare = vendor.recording, raw.recording
        assert (done.time[0], done.load[0], done.depth[0]) == (0, 0, 0)
        assert 111 < done.load.max() < 114
        terms = np.column_stack([bare.load, bare.time])
        compliance, drift = np.linalg.lstsq(terms, bare.depth - done.depth, rcond=None)[0]
        assert 1e6 / compliance == pytest.approx(5.2e6, rel=0.003)
        assert drift == pytest.approx(float(vendor.metadata["Drift Correction [nm/s]"]), abs=0.001)


@needs_recordings
def test_xp_formula_gives_the_vendor_s_depth():
    for vendor, own in zip(read_vendor_file(XP), read_vendor_file(XP, corrections=BOTH), strict=True):
        assert np.abs(own.recording.depth - vendor.recording.depth).max() < 0.09, "drift is printed to 0.001 nm/s"


@needs_recordings
def test_kla_zero_points_are_as_off_as_known():
    zeros = []
    for test in read_vendor_file(KLA):
        r = test.recording
        first_time = np.append(False, r.load[1:] > np.maximum.accumulate(r.load)[:-1] + 0.002 * r.load.max())
        loading = first_time & (r.load > 0.1 * r.load.max())
        slope, zero = np.polyfit(np.sqrt(r.load[loading]), r.depth[loading], 1)
        assert 1 / slope**2 == pytest.approx(88.15e-6, abs=0.8e-6)
        zeros.append(zero)
    assert len(zeros) == 16
    assert zeros[2] == pytest.approx(855, abs=1)
    assert zeros[10] == pytest.approx(161, abs=1)
    assert np.delete(zeros, [2, 10]) == pytest.approx(51, abs=7)


@needs_recordings
def test_hysitron_volts_give_the_corrections_that_were_applied():
    (vendor,), (raw,), (own,) = (read_vendor_file(STEEL, corrections=chosen) for chosen in (None, RAW, BOTH))
    assert float(raw.metadata["frame compliance [nm/mN]"]) == pytest.approx(3.4206, abs=5e-4)
    assert float(raw.metadata["drift [nm/s]"]) == pytest.approx(0.5676, abs=2e-4)
    assert own.recording.depth == pytest.approx(vendor.recording.depth, abs=1e-9)
    r = raw.recording
    expected = 3.4206 * r.load + 0.5676 * r.time
    assert r.depth - vendor.recording.depth == pytest.approx(expected, abs=0.01)


@needs_recordings
def test_hld_raw_depth_is_what_the_sensor_s_polynomial_gives():
    (raw,) = read_vendor_file(HLD, corrections=RAW)
    lines = HLD.read_text(encoding="latin-1").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("Test Data Points"))
    volts = np.array([float(line.split("\t")[5]) for line in lines[start + 2 :]])[-len(raw.recording) :]
    depth = sum(float(raw.metadata[f"Disp C{k}L"].split()[0]) * volts**k for k in range(7))
    difference = raw.recording.depth - depth
    assert np.ptp(difference) < 0.1
    assert raw.recording.load.max() == pytest.approx(50.27, abs=0.05)


@needs_recordings
def test_hld_depth_less_what_yields_behind_the_specimen():
    """Regression in the file: 27.848 nm/mN of load, machine compliance and load cell together."""
    (vendor,), (raw,) = (read_vendor_file(HLD, corrections=chosen, contact="none") for chosen in (None, RAW))
    r, deep = raw.recording, raw.recording.load > 5
    terms = np.column_stack([r.load, r.time, np.ones(len(r))])[deep]
    compliance = np.linalg.lstsq(terms, (r.depth - vendor.recording.depth)[deep], rcond=None)[0][0]
    assert compliance == pytest.approx(27.848, rel=0.002)


@needs_recordings
def test_lines_that_end_with_carriage_returns():
    (test,) = read_vendor_file(BRUKER)
    assert test.recording.load.max() == pytest.approx(200, rel=0.01)
    with pytest.raises(InputError, match="volts"):
        read_vendor_file(BRUKER, corrections=DRIFT)


@needs_recordings
def test_a_tip_lifted_after_its_preload_touches_anew():
    """Lifted by 1000 nm, the load reads about 0.3 mN without contact and leaves that at -30 nm, on the way back."""
    (test,) = read_vendor_file(BRUKER)
    assert test.recording.depth[0] == 0.0
    said = next(text for text in test.warnings if "counted from where the test begins" in text)
    assert float(said.split("begins, ")[1].split()[0]) == pytest.approx(-30, abs=4)
    assert test.recording.load[0] == pytest.approx(0.3, abs=0.05)
    assert "reads 0.298 mN before contact" in " ".join(test.warnings)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_planted_corrections_come_off_a_hysitron_text(tmp_path, end):
    time = np.linspace(0, 20, 401)
    load = 1e3 * np.interp(time, [0, 8, 12, 20], [0, 5, 5, 0])
    raw = 100 * np.sqrt(load / 5e3) + 3 * np.sin(time)
    depth = raw - 2.5 * load / 1e3 - 0.3 * time
    rows = zip(depth, load, time, 0.001 - raw / 6000, strict=True)
    head = ["Mon Apr 29 10:41:06 2019", "", "Number of Points = 401", "Depth (nm)\tLoad (µN)\tTime (s)\tDepth (V)"]
    text = end.join([*head, *("\t".join(f"{value:.9f}" for value in row) for row in rows), ""])
    file = tmp_path / "planted.dat"
    file.write_bytes(text.encode("latin-1"))
    for chosen, expected in (
        (None, depth),
        (RAW, raw),
        (DRIFT, raw - 0.3 * time),
        (frozenset({"frame"}), raw - 2.5 * load / 1e3),
    ):
        (test,) = read_vendor_file(file, corrections=chosen)
        assert test.recording.depth == pytest.approx(expected, abs=1e-4)
        assert test.recording.load == pytest.approx(load / 1e3, abs=1e-9)


def test_a_zip_file_is_no_workbook(tmp_path):
    file = tmp_path / "x.xlsx"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("hello.txt", "hello")
    with pytest.raises(InputError, match="of no format that palpate knows: a zip archive"):
        read_vendor_file(file)


@needs_recordings
def test_the_command_line_takes_corrections_off(tmp_path):
    for chosen, folder in ((["--raw"], "raw"), (["--correct", "frame,drift"], "both"), ([], "vendor")):
        assert main(["read", str(XP), "--test", "3", *chosen, "-o", str(tmp_path / folder)]) == 0
    raw, both, vendor = (read_recording(tmp_path / name / "Test_003.csv") for name in ("raw", "both", "vendor"))
    assert raw.depth.max() - vendor.depth.max() > 20
    assert both.depth == pytest.approx(vendor.depth, abs=0.09)
    assert "corrections in depth: none" in raw.notes


def test_tests_whose_names_differ_by_odd_letters_alone_are_all_written(tmp_path):
    file = tmp_path / "x.TXT"
    names = [f"{axis}_{test}_{channel}" for test in ("tip α", "tip β") for axis, channel in (
        ("X", "Time_[s]"), ("Y", "Fn_[mN]"), ("X", "Time_[s]"), ("Y", "Pd_[nm]"))]  # fmt: skip
    rows = ["\t".join([f"{k}", f"{k}", f"{k}", f"{k}", f"{k}", f"{2 * k}", f"{k}", f"{k}"]) for k in range(9)]
    file.write_text("\n".join(["\t".join(names), *rows]))
    assert main(["read", str(file), "-o", str(tmp_path / "out")]) == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["tip_.csv", "tip__2.csv"]
    assert read_recording(tmp_path / "out/tip__2.csv").load.max() == 16


@needs_recordings
def test_read_writes_recordings(tmp_path):
    assert main(["read", str(ANON), "-o", str(tmp_path)]) == 0
    recording = read_recording(tmp_path / "anonNI.csv")
    assert recording.load.max() == pytest.approx(11.13, abs=0.005)
    assert any("EIT" in note for note in recording.notes)


@needs_recordings
@pytest.mark.parametrize(
    ("source", "spoil", "words"),
    [
        (ANON, lambda text: text[:800], "column line"),
        (ANON, lambda text: text[:2400].rsplit("\t", 2)[0], "cut off"),
        (ANON, lambda text: text.replace("0,1948", "abc"), "not a row of numbers"),
        (LONG, lambda text: text.split("\n")[0] + "\n", "no measured values"),
        (XP, lambda text: text[:100000], "no whole Excel workbook"),
        (KLA, lambda text: text[:100000], "no whole Excel workbook"),
        (KLA, lambda text: text[:900000] + "x" * 500 + text[900500:], "is damaged"),
        (STEEL, lambda text: text[:100001].rsplit("\n", 1)[0], "5304 were announced"),
        (STEEL, lambda text: text.replace("Load (", "Force ("), "lacks one of the columns"),
        (BRUKER, lambda text: text[:100000].rsplit("\r", 1)[0], "16390 were announced"),
        (HLD, lambda text: text[:110000].rsplit("\n", 1)[0], "1068 were announced"),
        (HLD, lambda text: text[:1000], "lacks Test Data Points"),
    ],
)
def test_broken_files_get_one_line(tmp_path, source, spoil, words, capsys):
    file = tmp_path / "x.TXT"
    file.write_bytes(spoil(source.read_bytes().decode("latin-1")).encode("latin-1"))
    assert main(["read", str(file), "-o", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err.strip()
    assert words in line
    assert str(file) in line
    assert "\n" not in line


AP = "Indentation\n\nTime (s)\tPd (nm)\tFn (mN)\n0\t0\t0\n1\t1\t1\n"
APC = "X_a_Time_[s]\tY_a_Fn_[mN]\tX_a_Time_[s]\tY_a_Pd_[nm]\n0\t0\t0\t0\n1\t1\t1\t1\n"
TXT = "Mon\n\nNumber of Points = 2\nDepth (nm)\tLoad (uN)\tTime (s)\n0\t0\t0\n1\t1\t1\n"
HEAD = "File Version: Hysitron\nMachine Comp: 0.004 nm/uN\nDrift Rate: 0 nm/s\nDisp Shift: 0 nm\nForce Shift: 0 uN\n"
HLD_TEXT = HEAD + "Test Data Points: 2\nTime_s\tDisp_nm\tForce_uN\tLoadCell_nm\n0\t0\t0\t0\n1\t1\t1\t1\n"


@pytest.mark.parametrize("text", [AP, APC, TXT, HLD_TEXT])
@pytest.mark.parametrize("separator", [";", " ", ","])
def test_a_vendor_s_file_saved_anew_without_tabs_is_told_as_that(tmp_path, text, separator):
    file = tmp_path / "x.txt"
    file.write_text(text)
    assert len(read_vendor_file(file)[0].recording) == 2
    file.write_text(text.replace("\t", separator))
    with pytest.raises(InputError, match=r"no tabs between its columns .* saved anew; .*--columns time="):
        read_vendor_file(file)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\n \r\n", "is empty"),
        (b"\x89PNG\r\n", "no format that palpate knows; name the columns"),
        (b"hello world\n1,2,3\n", "no format that palpate knows; its first line is 'hello world'"),
    ],
)
@pytest.mark.parametrize("columns", [[], ["--columns", "time=t,load=P,depth=h"]])
def test_foreign_files_get_one_line(tmp_path, content, words, columns, capsys):
    file = tmp_path / "x.TXT"
    file.write_bytes(content)
    assert main(["read", str(file), *columns, "-o", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err.strip()
    assert ("no table with numbers" if columns and content.strip() else words) in line
    assert "\n" not in line


def test_formats_and_units_are_listed(capsys):
    with pytest.raises(SystemExit) as leaving:
        main(["read", "--formats"])
    assert leaving.value.code == 0
    said = capsys.readouterr().out
    assert all(reader.title in said for reader in READERS.values())
    assert "load: mN, uN, nN, pN, cN, N, gf, mgf, kgf" in said


@needs_recordings
def test_a_row_of_a_sheet_is_told_by_its_number(tmp_path):
    names = {"time": "Time On Sample", "load": "Load On Sample", "depth": "Displacement Into Surface"}
    tests = read_vendor_file(XP, contact="none", columns=ColumnMap(names))
    first = next(test for test in tests if test.name == "Test 001")
    assert first.warnings == ("1 of 1521 rows left out: time does not increase (sheet Test 001, row 1495)",)
    rows = Source(XP, io.BytesIO(XP.read_bytes())).sheet("Test 001")
    time = rows[0].index("Time On Sample")
    assert rows[1495 - 1][time] - rows[1494 - 1][time] < 1e-9


@needs_recordings
def test_a_workbook_by_its_columns_is_what_its_reader_reads():
    """The same file by the KLA reader and by a map of columns; 1.8e308 for "invalid" goes either way."""
    known = read_vendor_file(KLA, contact="none")
    mapped = read_vendor_file(
        KLA, columns=ColumnMap({"time": "Time", "load": "Load", "depth": "Depth"}), contact="none"
    )
    assert [test.name for test in mapped] == [test.name for test in known]
    for one, other in zip(known, mapped, strict=True):
        assert other.recording.depth == pytest.approx(one.recording.depth)
        assert other.recording.load == pytest.approx(one.recording.load)


def test_points_without_values_at_the_ends_are_no_damage():
    time, blank = np.arange(100.0), np.full(100, np.nan)
    time[:40], blank[:90] = np.nan, 1.0
    kept, warnings = usable("a", time, blank)
    assert list(kept) == list(range(40, 90))
    assert warnings == ()
    for few in (np.full(100, np.nan), np.zeros(1)):
        with pytest.raises(InputError, match="a: holds fewer than two points with a number in every channel; export"):
            usable("a", few, few)


@needs_recordings
@pytest.mark.parametrize(
    "study", sorted((Path(__file__).parents[3] / "config/real").glob("*.yaml")), ids=lambda p: p.stem
)
def test_studies_of_real_recordings_are_sound(study, capsys):
    assert main(["check", str(study), "--data", str(RECORDINGS)]) == 0
    assert main(["check", str(study), "--data", str(study.parent)]) == 2
    assert "is missing" in capsys.readouterr().err


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("stiffness", [None, np.append(np.nan, np.arange(1.0, 41))])
def test_palpate_reads_what_it_writes(tmp_path, stiffness, encoding):
    time = np.arange(41.0)
    notes = tuple(f"{key}: {'what the vendor says of it, ' * 10}at length" for key in range(50))
    Recording(time, np.minimum(time, 40 - time), 10 * time, "a", notes, stiffness).write(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_bytes((tmp_path / "a.csv").read_text("utf-8").encode(encoding))
    assert main(["read", str(tmp_path / "a.csv"), "--stiffness", "-o", str(tmp_path / "again")]) == 0
    again = read_recording(tmp_path / "again/a.csv")
    assert np.array_equal(again.depth, 10 * time)
    assert set(notes) <= set(again.notes)
    assert (again.stiffness is None) == (stiffness is None)
    assert stiffness is None or np.array_equal(again.stiffness, stiffness, equal_nan=True)


def test_checksum_guards_a_study(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time_s,load_mN,depth_nm\n0,0,0\n1,1,1\n")
    assert len(read_vendor_file(file)) == 1
    with pytest.raises(InputError, match="sha256"):
        read_vendor_file(file, "0" * 64)


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_readers_match_nothing_empty(reader):
    assert not reader.matches(Source(Path("x"), io.BytesIO()))
    assert reader.title
