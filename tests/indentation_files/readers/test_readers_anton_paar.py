"""Anton Paar's two exports: encodings, and columns that are shared, missing, double, blank, late or in other units."""

import numpy as np
import pytest
from anton_paar_text import single
from public_files import ANON, needs_recordings
from workbooks import write_workbook

from indentation_files.readers import read_each, read_vendor_file, select
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.errors import InputError

TIME = np.arange(0, 60, 0.1)
LOAD = np.interp(TIME, [0, 30, 60], [0, 5, 0])
DEPTH = np.interp(TIME, [0, 30, 60], [0, 500, 300])
PAIRS = ("X_{}_Time_[s]", "Y_{}_Fn_[mN]", "X_{}_Time_[s]", "Y_{}_Pd_[nm]")
ONE = np.column_stack([TIME, LOAD, TIME, DEPTH])


def columns(values, *headings):
    """A column export; NaN makes a blank cell."""
    rows = ["\t".join("" if np.isnan(value) else f"{value:.9g}" for value in row) for row in values]
    return "\n".join(["\t".join(headings), *rows, ""])


def named(*names):
    return [heading.format(name) for name in names for heading in PAIRS]


def blank(first, last, *places):
    values = ONE.copy()
    values[first:last, places] = np.nan
    return values


def write(tmp_path, text, encoding="utf-8"):
    file = tmp_path / "x.TXT"
    file.write_bytes(text.encode(encoding))
    return file


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("text", [single(ONE), columns(ONE, *named("A")), "\n" + columns(ONE, *named("A"))])
def test_text_is_told_in_any_encoding_and_behind_blank_lines(tmp_path, text, encoding):
    (test,) = read_vendor_file(write(tmp_path, text, encoding))
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)
    assert test.recording.depth == pytest.approx(DEPTH, abs=1e-4)


@pytest.mark.parametrize(
    ("values", "headings"),
    [
        (ONE[:, [0, 1, 3]], ("X_A_Time_[s]", "Y_A_Fn_[mN]", "Y_A_Pd_[nm]")),
        (ONE[:, [2, 3, 0, 1]], ("X_A_Time_[s]", "Y_A_Pd_[nm]", "X_A_Time_[s]", "Y_A_Fn_[mN]")),
        (ONE / [60, 1e-3, 60, 1e3], ("X_A_Time_[min]", "Y_A_Fn_[µN]", "X_A_Time_[min]", "Y_A_Pd_[um]")),
        (np.insert(ONE, 2, np.nan, axis=1), ("X_A_Time_[s]", "Y_A_Fn_[mN]", "", "X_A_Time_[s]", "Y_A_Pd_[nm]")),
    ],
)
def test_each_channel_has_its_time_and_unit(tmp_path, values, headings):
    (test,) = read_vendor_file(write(tmp_path, columns(values, *headings)))
    assert test.recording.time == pytest.approx(TIME, abs=1e-6)
    assert test.recording.load == pytest.approx(LOAD, abs=1e-6)
    assert test.recording.depth == pytest.approx(DEPTH, abs=1e-4)


@pytest.mark.parametrize(
    ("line", "row"),
    [
        ("Time (s)\tPd (µm)\tFn (µN)\tFnRef (µN)\tSegmentID", "{0:.1f}\t{2:.6f}\t{1:.3f}\t5.3546\t1"),
        ("Time [s]\tFn [µN]\tPd [µm]\t", "{0:.1f}\t{1:.3f}\t{2:.6f}\t"),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_a_single_test_is_read_in_the_units_and_the_order_of_its_headings(tmp_path, line, row, encoding):
    rows = [row.format(time, 1e3 * load, 1e-3 * depth) for time, load, _, depth in ONE]
    text = "\r\n".join(["Indentation", "", "Measured values", line, "", *rows, ""])
    (test,) = read_vendor_file(write(tmp_path, text, encoding))
    assert test.recording.time == pytest.approx(TIME, abs=1e-6)
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)
    assert test.recording.depth == pytest.approx(DEPTH, abs=1e-2)


SPELLED = [
    ("Zeit (s)", "Kraft (mN)", "Eindringtiefe (nm)"),
    ("Zeit [s]", "Normalkraft [mN]", "Eindringtiefe [nm]"),
    ("Temps (s)", "Force normale (mN)", "Profondeur de pénétration (nm)"),
    ("Temps [s]", "Force [mN]", "Profondeur [nm]"),
    ("TIME (s)", "Normal force (mN)", "Penetration depth (nm)"),
]


@pytest.mark.parametrize("spelled", SPELLED)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
@pytest.mark.parametrize("above", ["", "Indentation\r\n\r\n", "Eindruckversuch\tA:\r\nKraft (max) :\t5,0 mN\r\n"])
def test_headings_in_german_and_french_are_known(tmp_path, spelled, encoding, above):
    rows = [f"{time:.1f}\t{depth:.4f}\t{load:.6f}".replace(".", ",") for time, load, _, depth in ONE]
    text = above + "\r\n".join(["\t".join(spelled[k] for k in (0, 2, 1)), *rows, ""])
    (test,) = read_vendor_file(write(tmp_path, text, encoding))
    assert test.recording.time == pytest.approx(TIME, abs=1e-6)
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)
    assert test.recording.depth == pytest.approx(DEPTH, abs=1e-3)


def test_tests_side_by_side_are_known_in_german(tmp_path):
    named = ("X_P 1_Zeit_[s]", "Y_P 1_Kraft_[mN]", "X_P 1_Zeit_[s]", "Y_P 1_Eindringtiefe_[nm]")
    (test,) = read_vendor_file(write(tmp_path, columns(ONE, *named).replace(".", ",")))
    assert test.name == "P 1"
    assert test.recording.depth == pytest.approx(DEPTH, abs=1e-3)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Zeit (s)\tEindringtiefe (nm)\tKraft (V)", "load in 'V' is not known"),
        ("Zeit (s)\tEindringtiefe\tKraft (mN)", "lacks its column line"),
        ("Zeit (s)\tEindringtiefe (nm)\tSollkraft (mN)", "lacks its column line"),
        ("Time (s)\tPd (nm)\tFn (mN)\tForce (mN)", "several columns are called 'Fn .mN. or Force .mN.'"),
    ],
)
def test_units_and_channels_are_not_guessed(tmp_path, line, words):
    with pytest.raises(InputError, match=words):
        read_vendor_file(write(tmp_path, f"Indentation\n{line}\n0\t0\t0\t0\n1\t1\t1\t2\n"))


def test_a_single_test_in_unknown_units_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"x\.TXT.*load in 'V' is not known"):
        read_vendor_file(write(tmp_path, "Indentation\nTime (s)\tPd (nm)\tFn (V)\n0\t0\t0\n"))


@pytest.mark.parametrize(
    ("second", "names", "words"),
    [
        (ONE, ("A", "A"), None),
        (blank(0, 600, 0, 1, 2, 3), ("A", "B"), "x.TXT, B, load: holds fewer than two points"),
        (blank(1, 600, 0, 1, 2, 3), ("A", "B"), "x.TXT, B, load: holds fewer than two points"),
    ],
)
def test_a_test_that_cannot_be_read_is_named_and_the_others_are_read(tmp_path, second, names, words, capsys):
    file = write(tmp_path, columns(np.hstack([ONE, second]), *named(*names)))
    status = main(["read", str(file), "-o", str(tmp_path)])
    line = capsys.readouterr().err.strip()
    assert "\n" not in line
    if words is None:
        assert status == 2
        assert "x.TXT, A: has 2 columns of load" in line
    else:
        assert status == 0
        assert words in line
        assert line.endswith("the test is left out")
        assert len(read_recording(tmp_path / "A.csv")) == 600
        with pytest.raises(InputError, match="B, load"):
            select(read_each(file), "B", file)


@pytest.mark.parametrize(
    ("spoilt", "warning", "count"),
    [
        (blank(500, 600, 2, 3), "100 of 600 points of the load left out: the depth has none there", 500),
        (blank(100, 101, 3), "depth: 1 of 600 points left out: no number (point 101)", 600),
        (blank(0, 0) + 0.1 * (np.arange(600) == 100)[:, None] * [-50, 0, 0, 0], "load: 1 of 600 points left out: "
         "time goes back (point 101)", 599),
    ],
)  # fmt: skip
def test_points_that_are_left_out_are_named(tmp_path, spoilt, warning, count):
    (test,) = read_vendor_file(write(tmp_path, columns(spoilt, *named("A"))))
    assert test.warnings == (warning,)
    assert len(test.recording) == count
    assert test.recording.depth == pytest.approx(np.interp(test.recording.time, TIME, DEPTH), abs=1e-6)


@pytest.mark.parametrize("place", [0, 1, 3])
def test_a_blank_cell_of_a_single_test_costs_its_row_and_is_named(tmp_path, place):
    text = single(blank(300, 301, place)).replace("nan", "")
    (test,) = read_vendor_file(write(tmp_path, text))
    assert test.warnings == ("1 of 600 points left out: no number (point 301)",)
    assert test.recording.depth == pytest.approx(np.delete(DEPTH, 300), abs=1e-4)


def test_a_gap_in_the_depth_is_not_bridged(tmp_path):
    gap = np.full_like(ONE[:, 2:], np.nan)
    gap[:300] = ONE[np.r_[:100, 400:600], 2:]
    with pytest.raises(InputError, match=r"A: the depth has no point from 9.9 to 40 s, the load has 301"):
        read_vendor_file(write(tmp_path, columns(np.hstack([ONE[:, :2], gap]), *named("A"))))


@pytest.mark.parametrize(
    ("points", "stated", "told"),
    [
        (600, ("5,00 \tmN", "500,00 nm"), []),
        (600, ("5,05 mN", "509 nm"), []),
        (600, ("?", "510,3 furlong"), []),
        (600, ("5,2 mN", "0,5 \tµm"), ["the largest load is 5 mN, the file states Fmax = 5,2 mN"]),
        (600, ("5000 µN", "600 nm"), ["the largest depth is 500 nm, the file states hmax = 600 nm"]),
        (320, ("5,00 mN", "500,00 nm"), ["ends under 4.683 of 5 mN, not unloaded"]),
        (500, ("5,00 mN", "500,00 nm"), []),
        (
            201,
            ("5,00 mN", "500,00 nm"),
            [
                "the largest load is 3.333 mN, the file states Fmax = 5,00 mN",
                "the largest depth is 333.3 nm, the file states hmax = 500,00 nm",
                "ends under 3.333 of 3.333 mN, not unloaded",
            ],
        ),
    ],
)
def test_a_file_that_ends_before_its_own_largest_load_or_the_unloading_is_told(tmp_path, points, stated, told):
    results = "Fmax=\t{}\n   hmax=\t{}\nTime (s)".format(*stated)
    (test,) = read_vendor_file(write(tmp_path, single(ONE[:points]).replace("Time (s)", results)))
    assert test.warnings == tuple(f"{words}; the file may be cut off" for words in told)


def test_each_of_the_tests_side_by_side_that_is_not_unloaded_is_told(tmp_path, capsys):
    whole = np.column_stack([TIME, np.interp(TIME, [0, 15, 30], [0, 5, 0]), TIME, DEPTH])
    file = write(tmp_path, columns(np.hstack([ONE, whole])[:350], *named("A", "B")))
    assert main(["read", str(file), "-o", str(tmp_path)]) == 0
    words = "ends under 4.183 of 5 mN, not unloaded; the file may be cut off"
    assert capsys.readouterr().err == f"palpate: {file}, A: {words}\n"
    assert words in read_recording(tmp_path / "A.csv").notes


@pytest.mark.parametrize("heading", ["{}_{}_{}_[{}]", "{}_{}_{} ({})"])
@pytest.mark.parametrize("title", [[], [["Exported"], [""]]])
def test_columns_are_read_from_a_workbook_and_sums_beside_them_are_told(tmp_path, capsys, heading, title):
    """Tests of unequal length side by side; a sheet that holds other sums is named and passed over."""
    names = [heading.format(*cell) for test in ("P_1", "P_2") for cell in (
        ("X", test, "Time", "s"), ("Y", test, "Fn", "mN"), ("Y", test, "Pd", "nm")
    )]  # fmt: skip
    both = np.column_stack([TIME, ONE[:, 1], DEPTH, TIME, ONE[:, 1] / 2, DEPTH]).tolist()
    cells = [[*row[:3], *([""] * 3 if k >= 400 else row[3:])] for k, row in enumerate(both)]
    sums = [
        ["", "", "", "Re_time", "Re_disp"],
        *([t, p, h, t, h] for t, p, h in TIME[:, None].repeat(3, axis=1).tolist()),
    ]
    file = write_workbook(tmp_path / "x.xlsx", {"raw": [*title, names, *cells], "load-disp": sums, "empty": []})
    assert main(["read", str(file), "-o", str(tmp_path / "out")]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if "not unloaded" not in line]
    assert len(lines) == 1
    assert "load-disp: has no columns X_..._Time_[s]" in lines[0]
    assert lines[0].endswith("the sheet is left out")
    first, second = (read_recording(tmp_path / f"out/P_{k}.csv") for k in (1, 2))
    assert (len(first), len(second)) == (600, 400)
    assert second.load == pytest.approx(first.load[:400] / 2)
    assert first.depth == pytest.approx(DEPTH, abs=1e-6)


@pytest.mark.parametrize(
    "names",
    [("Time [s]", "Pd [nm]", "Fn [mN]"), ("Time (s)", "Pd (nm)", "Fn (mN)"), ("Pd (nm)", "Fn (mN)", "Time (s)")],
)
@pytest.mark.parametrize("workbook", [True, False])
def test_columns_without_a_test_s_name_are_one_test(tmp_path, names, workbook):
    channels = {"T": TIME, "P": DEPTH, "F": ONE[:, 1]}
    rows = [list(names), *np.column_stack([channels[name[0]] for name in names]).tolist()]
    if workbook:
        file = write_workbook(tmp_path / "x.xlsx", {"first": rows, "second": rows})
    else:
        file = tmp_path / "x.txt"
        file.write_text("\n".join("\t".join(map(str, row)) for row in rows))
    tests = read_vendor_file(file)
    assert [test.name for test in tests] == (["first", "second"] if workbook else ["x"])
    assert tests[0].recording.load == pytest.approx(LOAD)
    assert tests[0].recording.depth == pytest.approx(DEPTH)


def test_copies_of_columns_on_another_sheet_get_its_name(tmp_path):
    names = [f"{cell}" for cell in ("X_P_Time_[s]", "Y_P_Fn_[mN]", "Y_P_Pd_[nm]")]
    sheet = [names, *np.column_stack([TIME, ONE[:, 1], DEPTH]).tolist()]
    file = write_workbook(tmp_path / "x.xlsx", {"raw": sheet, "smoothed": sheet})
    assert [test.name for test in read_vendor_file(file)] == ["P", "smoothed P"]


@needs_recordings
@pytest.mark.parametrize("file", [ANON, *sorted(ANON.parents[1].glob("gukin94/*.TXT"))])
def test_whole_files_are_not_told_to_be_cut_off(file):
    assert [test.warnings for test in read_each(file) if test.warnings] == []
