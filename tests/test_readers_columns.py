"""Tables by a map of their columns: separators, units, rows and signs, read as written or refused with one line."""

import re

import numpy as np
import pytest
from workbooks import write_workbook

from palpate.cli import main
from palpate.errors import InputError
from palpate.readers import ColumnMap, read_each, read_vendor_file
from palpate.readers.vendor import Unreadable
from palpate.recording import read_recording

TIME = np.linspace(0, 60, 61)
FORCE = 1e3 * np.interp(TIME, [0, 30, 60], [0, 2, 0])
PATH = 0.25 * np.sqrt(FORCE / 2e3) + 0.001 * TIME
NAMES = {"time": "t / s", "load": "Fn", "depth": "h"}
MAP = ColumnMap(NAMES, {"load": "uN", "depth": "um"})
NUMBERED = ColumnMap({"time": "1", "load": "2", "depth": "3"})


def rows_of(delimiter, comma):
    head = ["Sample: glass", "", delimiter.join(["No", "h", "t / s", "Fn"]), delimiter.join(["", "um", "s", "uN"])]
    body = [delimiter.join(f"{x:.7f}" for x in (k, *row)) for k, row in enumerate(zip(PATH, TIME, FORCE, strict=True))]
    return "\n".join([*head, *(line.replace(".", ",") if comma else line for line in body), "end of test", ""])


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", True), (";", False), ("\t", True), ("\t", False)])
def test_any_text_table_by_its_columns(tmp_path, delimiter, comma):
    file = tmp_path / "table.dat"
    file.write_text(rows_of(delimiter, comma))
    (test,) = read_vendor_file(file, columns=MAP)
    assert test.recording.time == pytest.approx(TIME, abs=1e-6)
    assert test.recording.load == pytest.approx(FORCE / 1e3, abs=1e-6)
    assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-3)


@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("names", [("Time (s)", "Load (µN)", "Depth (µm)"), ("3", "2", "1")])
def test_a_vendor_s_table_saved_anew_with_blanks(tmp_path, comma, names):
    """Units in brackets stay with their names; commas between blanks are decimal."""
    body = [f"{h:.7f} {p:.7f} {t:.7f} {t:.3f}" for h, p, t in zip(PATH, FORCE, TIME, strict=True)]
    lines = ["Mon Apr 29", "Number of Points = 61", "", "Depth (µm) Load (µN) Time (s) Depth (V)", *body]
    file = tmp_path / "x.txt"
    file.write_text("\n".join(lines).replace(".", "," if comma else "."), encoding="utf-8")
    columns = ColumnMap(dict(zip(("time", "load", "depth"), names, strict=True)))
    (test,) = read_vendor_file(file, columns=columns)
    assert test.recording.load == pytest.approx(FORCE / 1e3, abs=1e-6)
    assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-3)


@pytest.mark.parametrize("delimiter", [", ", " , ", " ; ", "\t "])
def test_blanks_beside_separators_are_none(tmp_path, delimiter):
    (tmp_path / "x.txt").write_text(rows_of(delimiter, False))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=MAP)
    assert test.recording.load == pytest.approx(FORCE / 1e3, abs=1e-6)


def test_columns_by_number(tmp_path):
    file = tmp_path / "bare.txt"
    np.savetxt(file, np.column_stack([TIME, FORCE, PATH]))
    (test,) = read_vendor_file(file, columns=ColumnMap({"time": "1", "load": "2", "depth": "3"}, dict(MAP.units)))
    assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-6)


def test_columns_by_number_lose_no_row_that_holds_these_numbers(tmp_path):
    file = tmp_path / "bare.txt"
    file.write_text("0 0 0\n0.25 0.5 1\n1 3 2\n1.5 3 4\n2 4 5\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.time == pytest.approx([0, 0.25, 1, 1.5, 2])
    assert test.recording.load == pytest.approx([0, 0.5, 3, 3, 4])
    assert test.recording.depth == pytest.approx([0, 1, 2, 4, 5])


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("Time,Load,Depth\n", "line 3: has 6 cells, its header 3; export it with semicolons or tabs"),
        ("", "line 2: has 6 cells, and no number a decimal sign; .*, or write their names above"),
    ],
)
def test_decimal_commas_between_commas_are_refused_by_number_too(tmp_path, head, words):
    file = tmp_path / "x.csv"
    file.write_text(head + "0,0,0\n1,25,0,5,10,5\n2,5,1,0,20,5\n")
    with pytest.raises(InputError, match=words):
        read_vendor_file(file, columns=NUMBERED)
    file.write_text("a,b,c,d\n0,0,0,0\n1,1,5,1\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.depth.max() == 5


@pytest.mark.parametrize("names", [("t_s", "P_uN", "h_um"), ("1", "2", "3")])
def test_a_comment_sign_before_the_header_is_no_column(tmp_path, names):
    file = tmp_path / "x.txt"
    np.savetxt(file, np.column_stack([TIME, FORCE, PATH, 25 + TIME]), header="t_s P_uN h_um T")
    (test,) = read_vendor_file(file, columns=ColumnMap(dict(zip(("time", "load", "depth"), names, strict=True))))
    assert test.recording.load == pytest.approx(FORCE / 1e3)
    assert test.recording.depth == pytest.approx(1e3 * PATH)


SHORT = ColumnMap({"time": "t", "load": "P", "depth": "h"}, {"time": "s", "load": "mN", "depth": "nm"})


def english(value):
    return f'"{value:,.2f}"' if value >= 1000 else f"{value:g}"


def german(value):
    return english(value).strip('"').translate(str.maketrans(",.", ".,"))


@pytest.mark.parametrize(("written", "delimiter"), [(english, ","), (german, ";"), (german, "\t")])
def test_separators_of_thousands_are_read(tmp_path, written, delimiter):
    depth = np.array([0, 412.5, 900, 1143.74, 1200, 1000, 950.25])
    rows = [delimiter.join(written(x) for x in row) for row in zip(TIME[:7], FORCE[:7] / 1e4, depth, strict=True)]
    file = tmp_path / "x.csv"
    file.write_text("\n".join([delimiter.join("tPh"), *rows]))
    (test,) = read_vendor_file(file, columns=SHORT)
    assert test.recording.depth == pytest.approx(depth)
    assert test.warnings == ()


@pytest.mark.parametrize("row", ["2;2;1.143", "2;2;1,143"])
def test_a_decimal_sign_that_the_table_does_not_tell_is_refused(tmp_path, row):
    file = tmp_path / "x.csv"
    file.write_text(f"t;P;h\n0;0;0\n1;1;1\n{row}\n3;1;1\n")
    with pytest.raises(InputError, match=r"x.csv, line 4: '1.143' has a decimal sign or parts thousands"):
        read_vendor_file(file, columns=SHORT)


def hundred(changes):
    rows = {k: f"{k},{min(k, 100 - k)},{10 * min(k, 100 - k)}" for k in range(101)} | changes
    return "t,P,h\n" + "\n".join(rows.values()) + "\n"


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        ({}, None),
        ({40: "40,,400"}, "1 of 101 rows left out: no three numbers (line 42)"),
        ({40: "40,-,400", 60: "60,ERROR,400"}, "2 of 101 rows left out: no three numbers (line 42, 62)"),
        ({60: "59,41,410"}, "1 of 101 rows left out: time does not increase (line 62)"),
        ({100: "100,0"}, "1 of 101 rows left out: no three numbers (line 102)"),
        ({100: "mean,of,all"}, None),
        (
            dict.fromkeys(range(10, 14), "x,1,2"),
            "4 of 101 rows left out: no three numbers (line 12, 13, 14 and 1 more)",
        ),
    ],
)
def test_rows_are_left_out_with_a_word(tmp_path, changes, warning, capsys):
    file = tmp_path / "x.csv"
    file.write_text(hundred(changes))
    columns = ("--columns", "time=t,load=P,depth=h", "--units", "time=s,load=mN,depth=nm")
    assert main(["read", str(file), *columns, "-o", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().err
    assert said == (f"palpate: {file}, x: {warning}\n" if warning else "")
    assert warning is None or warning in read_recording(tmp_path / "out/x.csv").notes


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {k: f"{k},{100 - k},1'000" for k in range(90, 101)},
            r"line 92: .90, 10, 1.000. is not three numbers; 11 of 101",
        ),
        ({k: f"{k - 50},1,1" for k in range(60, 70)}, r"line 62: .10, 1, 1. does not come later .* 10 of 101 rows"),
        (dict.fromkeys(range(1, 101), "a,b,c"), "line 2: is the only row of numbers"),
    ],
)
def test_many_bad_rows_are_refused_with_the_first(tmp_path, changes, words):
    file = tmp_path / "x.csv"
    file.write_text(hundred(changes))
    with pytest.raises(InputError, match=words):
        read_vendor_file(file, columns=SHORT)


@pytest.mark.parametrize(
    ("headings", "below"),
    [
        (("Time (s)", "Load (µN)", "Depth (µm)"), []),
        (("t / s", "P / uN", "h / um"), []),
        (("time_s", "load_uN", "depth_um"), []),
        (("t", "F_N", "h"), ["s\tµN\t[μm]"]),
        (("t", "F_N", "h"), ["raw\traw\traw", "s\tµN\t[μm]"]),
        (("elapsed_time_s", "sample_load_uN", "tip_depth_um_raw"), []),
        (("Time s", "Load in uN", "Depth, um"), []),
        (("s", "uN", "um"), []),
        (("Time (s)", "Load / uN", "Depth_um"), ["sec\tμN\tum"]),
        (("t<s>", "F.uN", "h{um}"), []),
        (("t:s", "load-uN", "Depth (raw) / um"), []),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_units_that_the_table_states_are_used(tmp_path, headings, below, encoding):
    file = tmp_path / "x.txt"
    rows = [f"{a:g}\t{b:.6f}\t{c:.6f}" for a, b, c in zip(TIME, FORCE, PATH, strict=True)]
    file.write_text("\n".join(["\t".join(headings), *below, *rows]), encoding=encoding)
    names = dict(zip(("time", "load", "depth"), headings, strict=True))
    for called, given, load_unit, turn in (
        (names, {}, "uN", 1e-3), (names, {"load": "-N"}, "-N", -1e3), (NUMBERED.names, {}, "uN", 1e-3)
    ):  # fmt: skip
        (test,) = read_vendor_file(file, columns=ColumnMap(called, given), contact="none")
        assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-2)
        assert test.recording.load == pytest.approx(turn * FORCE, abs=1e-2 * abs(turn))
        assert f"[{load_unit}]" in test.metadata["columns"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,P,h\n0,0,0\n1,1,900\n2,2,1,200\n", "line 4: has 4 cells, its header 3; export it with semicolons"),
        ("t;P;h;t;P;h\n0;0;0;0;0;0\n1;1;1;1;1;1\n", "several columns are called 't'"),
        ("t [s] P [mN] h [nm]\n0 0 0 0 0\n1 1 1 1 1\n", "line 2: has 5 cells, its header 6; give the columns by"),
    ],
)
def test_columns_that_cannot_be_told_apart_are_refused(tmp_path, text, words):
    file = tmp_path / "x.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        read_vendor_file(file, columns=SHORT)


UNKNOWN = [
    "P (kgf)",
    "P / kgf",
    "load_kgf",
    "Load kN",
    "Load / kN",
    "P_mgf",
    "P nm",
    "LOAD_UN",
    "Load grams",
    "P (1e-3 N)",
]


@pytest.mark.parametrize("heading", UNKNOWN)
@pytest.mark.parametrize("by_name", [True, False])
def test_a_stated_unit_that_is_not_known_is_refused(tmp_path, heading, by_name):
    file = tmp_path / "x.csv"
    file.write_text(f"t,{heading},h\n0,0,0\n1,1,1\n")
    names = {"time": "t", "load": heading, "depth": "h"} if by_name else NUMBERED.names
    column = re.escape(names["load"])
    with pytest.raises(InputError, match=f"x.csv, column {column}: the load's unit '.+' is not known.*mN, uN"):
        read_vendor_file(file, columns=ColumnMap(names))
    (test,) = read_vendor_file(file, columns=ColumnMap(names, {"load": "N"}))
    assert test.recording.load.max() == 1000


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["t,F_N,h"], "column F_N: 'N' may be the load's unit or part of the name"),
        (["t,F_N,h", "s,gf,nm"], "the load's unit 'gf' is not known"),
        (["s,gf,nm", "t,F_N,h"], "the load's unit 'gf' is not known"),
        (["t,F_N,h", "s,mN,nm", "s,uN,nm"], "the load's unit is stated as mN and uN"),
    ],
)
def test_a_unit_that_cannot_be_told_is_refused(tmp_path, rows, words):
    file = tmp_path / "x.csv"
    file.write_text("\n".join([*rows, "0,0,0", "1,1,1"]))
    for names in ({"time": "t", "load": "F_N", "depth": "h"}, NUMBERED.names):
        with pytest.raises(InputError, match=words.replace("F_N:", f"{names['load']}:")):
            read_vendor_file(file, columns=ColumnMap(names))


@pytest.mark.parametrize("above", [["Time\tLoad\tDepth", "s\tN\tum"], ["s\tN\tum", "Time\tLoad\tDepth"], ["s\tN\tum"]])
def test_a_row_of_units_is_found_wherever_it_stands(tmp_path, above):
    file = tmp_path / "x.txt"
    file.write_text("\n".join(["Sample (glass)\tA/B", *above, "0\t0\t0", "1\t2\t3"]))
    for names in ({"time": "Time", "load": "Load", "depth": "Depth"}, NUMBERED.names):
        if names is NUMBERED.names or len(above) > 1:
            (test,) = read_vendor_file(file, columns=ColumnMap(names))
            assert (test.recording.load.max(), test.recording.depth.max()) == (2000, 3000)


@pytest.mark.parametrize(
    ("time", "load", "depth"),
    [
        ("Time", "Load", "Depth"),
        ("t", "P", "h"),
        ("Time on sample", "Load On Sample", "Displacement Into Surface"),
        ("Zeit", "Normal force Fn", "Penetration depth Pd"),
        ("time_raw", "Raw Load", "Depth corrected"),
        ("Elapsed Time", "Force 1", "hc (nm)"),
        ("TIME", "P_max_300mN", "h_s"),
        ("A", "B", "C"),
    ],
)
def test_headings_without_a_unit_leave_the_usual_ones(tmp_path, time, load, depth):
    file = tmp_path / "x.csv"
    file.write_text(f"{time},{load},{depth}\nnan,nan,nan\n0,0,0\n1,2,3\n")
    for names in ({"time": time, "load": load, "depth": depth}, NUMBERED.names):
        (test,) = read_vendor_file(file, columns=ColumnMap(names))
        assert (test.recording.time[-1], test.recording.load.max(), test.recording.depth.max()) == (1, 2, 3)


@pytest.mark.parametrize("contact", ["file", "auto"])
@pytest.mark.parametrize(("channel", "signs"), [("load", (-1, 1)), ("depth", (1, -1)), ("load", (-1, -1))])
def test_a_wrong_sign_is_told(tmp_path, channel, signs, contact):
    file = tmp_path / "x.csv"
    depth = 500 * np.sqrt(FORCE / 2e3)
    rows = zip(TIME, signs[0] * FORCE / 1e3, signs[1] * depth, strict=True)
    file.write_text("time_s,load_mN,depth_nm\n" + "\n".join(f"{a},{b},{c}" for a, b, c in rows))
    with pytest.raises(InputError, match=f"x.csv, x: the {channel} falls from .*--units {channel}=-"):
        read_vendor_file(file, contact=contact)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--columns", "time=t / s,load=Fn,depth=hh"], "columns of its header (No, h, t / s, Fn)"),
        (["--columns", "time=t / s,load=Fn,depth=Fn"], "load and depth are both 'Fn'"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--contact", "5e9"], "outside the way in"),
        (["--units", "load=uN"], "add --columns"),
        (["--columns", "time=t / s,load=Fn"], "no column is named for depth"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--units", "load=kg"], "load in 'kg' is not known"),
        (["--columns", "time=t / s,load=Fn,depth=h,force=Fn"], "'force' is no channel"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--raw"], "final channels only"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--test", "²"], "has no test '²'"),
        (["--columns", "time=²,load=³,depth=¹"], "no table with numbers in the columns ², ³, ¹"),
        ([], "no format that palpate knows"),
    ],
)
def test_a_wrong_map_gets_one_line(tmp_path, arguments, words, capsys):
    file = tmp_path / "table.dat"
    file.write_text(rows_of(",", False))
    assert main(["read", str(file), *arguments, "-o", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err.strip()
    assert words in line
    assert str(file) in line
    assert "\n" not in line


def test_the_command_line_reads_a_table_and_surveys_it(tmp_path, capsys):
    file = tmp_path / "table.dat"
    file.write_text(rows_of(";", True))
    chosen = ["--columns", "time=t / s,load=Fn,depth=h", "--units", "load=uN,depth=um"]
    assert main(["read", str(file), *chosen, "--survey", "-o", str(tmp_path / "out")]) == 0
    assert read_recording(tmp_path / "out/table.csv").depth.max() == pytest.approx(1e3 * PATH.max(), rel=1e-4)
    assert (tmp_path / "out/table.png").stat().st_size > 10000
    assert capsys.readouterr().out.split() == [
        f"{tmp_path}/out/{name}" for name in ("table.csv", "table.png", "table_survey.txt")
    ]
    assert "unloading" in (tmp_path / "out/table_survey.txt").read_text()


def test_invalid_values_are_dropped_and_many_are_refused(tmp_path):
    file = tmp_path / "x.csv"
    load = FORCE.copy()
    load[20] = 1.7976931348623157e308
    file.write_text("t,P,h\n" + "\n".join(f"{a},{b},{c}" for a, b, c in zip(TIME, load, PATH, strict=True)))
    columns = ColumnMap({"time": "t", "load": "P", "depth": "h"})
    (test,) = read_vendor_file(file, columns=columns)
    assert len(test.recording) == len(TIME) - 1
    file.write_text(
        "t,P,h\n" + "\n".join(f"{a},{1.8e308 if a % 3 else b},{c}" for a, b, c in zip(TIME, load, PATH, strict=True))
    )
    with pytest.raises(InputError, match="is not three numbers; 40 of 61 rows"):
        read_vendor_file(file, columns=columns)


def test_units_that_nobody_states_are_told(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("Time (s),Load,Depth\n0,0,0\n1,1,1\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.warnings == ("no unit is stated: load taken as mN, depth taken as nm (--units)",)
    (test,) = read_vendor_file(file, columns=ColumnMap(NUMBERED.names, {"load": "uN", "depth": "um"}))
    assert test.warnings == ()
    assert test.recording.load[-1] == pytest.approx(1e-3)


@pytest.mark.parametrize("name", ["Displacement [um]", "Displacement [µm]", "Displacement [μm]"])
def test_columns_are_found_by_whatever_micro_sign(tmp_path, name):
    file = tmp_path / "x.csv"
    file.write_text("Time [s],Load [mN],Displacement [µm]\n0,0,0\n1,1,2\n", encoding="utf-8")
    (test,) = read_vendor_file(file, columns=ColumnMap({"time": "Time [s]", "load": "Load [mN]", "depth": name}))
    assert test.recording.depth == pytest.approx([0, 2000])


@pytest.mark.parametrize("heading", ["Time", "Time (hh:mm:ss)", "Time/h:m:s"])
def test_clocks_are_read(tmp_path, heading):
    file = tmp_path / "x.csv"
    file.write_text(f"{heading};Load (mN);Depth (nm)\n0:59:58,5;0;0\n1:00:00;1;1\n1:01:00,25;2;2\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.time == pytest.approx([0, 1.5, 61.75])
    assert test.warnings == ()


@pytest.mark.parametrize("time", ["00:01", "2024-03-01 00:00:01"])
def test_times_that_are_no_numbers_are_shown(tmp_path, time):
    file = tmp_path / "x.csv"
    file.write_text(f"Time,Load (mN),Depth (nm)\n{time},0,0\n{time},1,1\n")
    with pytest.raises(InputError, match=rf"no table with numbers in the columns 1, 2, 3 \(line 2: '{time}, 0, 0'\)"):
        read_vendor_file(file, columns=NUMBERED)


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "utf-8"])
@pytest.mark.parametrize("end", ["", "\0\0\0\0", "\x1a"])
def test_unmarked_utf16_and_what_pads_the_end_are_read(tmp_path, encoding, end):
    file = tmp_path / "x.csv"
    file.write_bytes(f"Time (s);Load (µN);Depth (nm)\n0;0;0\n1;1;1\n2;4;2\n{end}".encode(encoding))
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.load == pytest.approx([0, 1e-3, 4e-3])
    assert test.warnings == ()


@pytest.mark.parametrize(
    ("depth", "load", "told"),
    [
        (-100 + 7 * TIME, np.clip(TIME - 15, 0, None), "begins at a depth of -100 nm, not at contact"),
        (500 + 7 * TIME, TIME, "begins at a depth of 500 nm, not at contact"),
        (30 + 7 * TIME, 0.2 + TIME, None),  # sampled from a small load on
        (7 * TIME, TIME, None),
    ],
)
def test_a_test_that_does_not_begin_at_zero_depth_is_told(tmp_path, depth, load, told):
    file = tmp_path / "x.csv"
    np.savetxt(file, np.column_stack([TIME, load, depth]), header="time_s;load_mN;depth_nm", comments="", delimiter=";")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert [warning.split(" (")[0] for warning in test.warnings] == ([told] if told else [])
    (whole,) = read_vendor_file(file, contact="none", columns=NUMBERED)
    assert whole.warnings == ()


def below_one_another(*tests, heading="t,P,h"):
    """A text of several tests, each under the same row of names and a title."""
    blocks = [
        [f"Test {k}", heading, *(f"{a:g},{b:g},{c:g}" for a, b, c in zip(*test, strict=True))]
        for k, test in enumerate(tests)
    ]
    return "\n".join(line for block in blocks for line in ["", *block]) + "\n"


ONE = (TIME, FORCE / 1e3, 1e3 * PATH)
OTHER = (TIME[:40], FORCE[:40] / 2e3, 900 * PATH[:40])


@pytest.mark.parametrize("workbook", [False, True])
def test_tests_below_one_another_under_the_same_header_are_read_each(tmp_path, workbook):
    file = tmp_path / "x.csv"
    lines = below_one_another(ONE, OTHER, ONE).splitlines()
    if workbook:
        cells = [[cell if not cell[:1].isdigit() else float(cell) for cell in line.split(",")] for line in lines]
        write_workbook(file, {"x": cells})
    else:
        file.write_text("\n".join(lines))
    tests = read_vendor_file(file, columns=SHORT)
    assert [test.name for test in tests] == ["x_1", "x_2", "x_3"]
    for test, (time, load, depth) in zip(tests, (ONE, OTHER, ONE), strict=True):
        assert test.warnings == ()
        assert test.recording.name == test.name
        assert test.recording.time == pytest.approx(time)
        assert test.recording.load == pytest.approx(load, abs=1e-5)
        assert test.recording.depth == pytest.approx(depth, abs=1e-2)


def test_one_spoilt_test_of_those_below_one_another_costs_only_itself(tmp_path):
    file = tmp_path / "x.csv"
    lines = below_one_another(OTHER, ONE).splitlines()
    lines[30:33] = ["x,1,2"] * 3
    file.write_text("\n".join(lines))
    first, second = read_each(file, columns=SHORT)
    assert isinstance(first, Unreadable)
    assert "x.csv, line 31: 'x, 1, 2' is not three numbers; 3 of 40 rows" in str(first.error)
    assert second.recording.time == pytest.approx(TIME)


def test_a_header_repeated_within_a_test_parts_nothing(tmp_path):
    file = tmp_path / "x.csv"
    first, second = (tuple(channel[half] for channel in ONE) for half in (slice(30), slice(30, None)))
    file.write_text(below_one_another(first, second))
    (test,) = read_vendor_file(file, columns=SHORT)
    assert test.recording.time == pytest.approx(TIME)


def test_tests_below_one_another_under_other_headers_are_refused(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text(below_one_another(ONE) + below_one_another(OTHER, heading="t,P,H"))
    with pytest.raises(InputError, match="write each of several tests to a file of its own"):
        read_vendor_file(file, columns=SHORT)


@pytest.mark.parametrize(
    ("heading", "missing", "others"),
    [
        ("Displacement Into Surface,Load On Sample,Displacement Into Surface,Load On Sample", "time", "load and depth"),
        ("h (nm),P (mN)", "time", "load and depth"),
        ("Time (s),Depth (nm)", "load", "time and depth"),
        ("Time [s],Segment,Load [mN]", "depth", "time and load"),
    ],
)
@pytest.mark.parametrize("separator", [None, ",", ";", "\t", " "])
def test_a_channel_that_the_table_lacks_is_told(tmp_path, heading, missing, others, separator):
    names = [re.sub(" (Into|On) .*", "", name) if separator == " " else name for name in heading.split(",")]
    rows = [[k + 0.5] * len(names) for k in range(20)]
    file = tmp_path / "x.csv"
    if separator is None:
        write_workbook(file, {"Test 001": [names, *rows]})
    else:
        file.write_text("\n".join(separator.join(map(str, row)) for row in [names, *rows]))
    with pytest.raises(InputError, match=f"its table names {others}, but no {missing}, which cannot be guessed"):
        read_vendor_file(file)
    with pytest.raises(
        InputError, match=f"no column is named for {missing}; .* export it with {missing}, which cannot"
    ):
        ColumnMap({key: key for key in ("time", "load", "depth") if key != missing})


def test_a_text_that_only_speaks_of_load_and_depth_is_of_no_format(tmp_path):
    (tmp_path / "x.txt").write_text("The load at this depth\nwas 5\nnot 7\n")
    with pytest.raises(InputError, match="no format that palpate knows"):
        read_vendor_file(tmp_path / "x.txt")
