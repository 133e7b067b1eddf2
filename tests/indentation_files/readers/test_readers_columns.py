"""Tables by a map of their columns: separators, numbers, rows and signs, read as written or refused with one line."""

import re

import numpy as np
import pytest
from tables import FORCE, NUMBERED, PATH, SHORT, TIME
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, read_vendor_file
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.errors import InputError

NAMES = {"time": "t / s", "load": "Fn", "depth": "h"}
MAP = ColumnMap(NAMES, {"load": "uN", "depth": "um"})


def rows_of(delimiter, comma):
    head = ["Sample: glass", "", delimiter.join(["No", "h", "t / s", "Fn"]), delimiter.join(["", "um", "s", "uN"])]
    body = [delimiter.join(f"{x:.7f}" for x in (k, *row)) for k, row in enumerate(zip(PATH, TIME, FORCE, strict=True))]
    return "\n".join([*head, *(line.replace(".", ",") if comma else line for line in body), "end of test", ""])


@pytest.mark.parametrize(("delimiter", "comma"), [(d, d != "," and comma) for d in ",;|\t" for comma in (True, False)])
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


@pytest.mark.parametrize("end", ["31.000\t19", "nan\tnan\tnan", "End of data", ""])
def test_a_table_that_breaks_off_under_load_is_told(tmp_path, end):
    """In the middle of a row, or where its channels hold no more numbers; a loading that ends in a whole row is not."""
    rows = [f"{a:.3f}\t{b:.5f}\t{c:.6f}" for a, b, c in zip(TIME[:31], FORCE[:31], PATH[:31], strict=True)]
    (tmp_path / "x.txt").write_text("\n".join(["t (s)\tP (uN)\th (um)", *rows, end]))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=NUMBERED)
    told = any("not unloaded; the file may be cut off" in warning for warning in test.warnings)
    assert told == (end in ("31.000\t19", "nan\tnan\tnan"))


@pytest.mark.parametrize("names", [("Elapsed Time (s)", "Load On Sample (mN)", "Depth (nm)"), ("Zeit / s", "F", "h")])
def test_names_of_words_one_blank_apart_stand_above_their_columns(tmp_path, names):
    rows = [f"{a:16.3f}   {b:19.5f}   {c:10.3f}" for a, b, c in zip(TIME, FORCE, PATH, strict=True)]
    (tmp_path / "x.txt").write_text("\n".join([f"{names[0]:>16}   {names[1]:>19}   {names[2]:>10}", *rows]))
    for columns in (NUMBERED, ColumnMap(dict(zip(("time", "load", "depth"), names, strict=True)))):
        (test,) = read_vendor_file(tmp_path / "x.txt", columns=columns, contact="none")
        assert test.recording.load == pytest.approx(FORCE, abs=1e-4)


@pytest.mark.parametrize("blank", ["\xa0", "\u202f"])
def test_blanks_that_break_no_line_part_columns_where_no_others_do(tmp_path, blank):
    lines = ["t P h", *(f"{k} {k / 2} {100 + k}" for k in range(5))]
    (tmp_path / "x.txt").write_text("\n".join(lines).replace(" ", blank), encoding="utf-8")
    (test,) = read_vendor_file(tmp_path / "x.txt", contact="none", columns=SHORT)
    assert test.recording.depth == pytest.approx(100 + np.arange(5))


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
        ({0: "0,0,-9999", 60: "60,40,-9999"}, "2 of 101 rows left out: no three numbers (line 2, 62)"),
        ({60: "59,40,400"}, "1 of 101 rows left out: time does not increase (line 62)"),
        ({60: "59,41,410"}, "1 row written twice, counted once (line 62)"),
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
            {k: f"{k},{100 - k},1'00" for k in range(90, 101)},
            r"line 92: .90, 10, 1.00. is not three numbers; 11 of 101",
        ),
        ({k: f"{k - 50},1,1" for k in range(60, 70)}, r"line 62: .10, 1, 1. is out of order in time; 10 of 101 rows"),
        (dict.fromkeys(range(1, 101), "a,b,c"), "line 2: is the only row of numbers"),
    ],
)
def test_many_bad_rows_are_refused_with_the_first(tmp_path, changes, words):
    file = tmp_path / "x.csv"
    file.write_text(hundred(changes))
    with pytest.raises(InputError, match=words):
        read_vendor_file(file, columns=SHORT)


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


@pytest.mark.parametrize("contact", ["file", "auto"])
@pytest.mark.parametrize(("channel", "signs"), [("load", (-1, 1)), ("depth", (1, -1)), ("load", (-1, -1))])
def test_a_wrong_sign_is_told(tmp_path, channel, signs, contact):
    file = tmp_path / "x.csv"
    depth = 500 * np.sqrt(FORCE / 2e3)
    rows = zip(TIME, signs[0] * FORCE / 1e3, signs[1] * depth, strict=True)
    file.write_text("time_s,load_mN,depth_nm\n" + "\n".join(f"{a},{b},{c}" for a, b, c in rows))
    with pytest.raises(InputError, match=f"x.csv, x: the {channel} falls from .*--units {channel}=-"):
        read_vendor_file(file, contact=contact)


@pytest.mark.parametrize("contact", ["file", "auto"])
@pytest.mark.parametrize("channel", ["load", "depth"])
def test_a_channel_that_never_changes_is_told(tmp_path, channel, contact):
    file = tmp_path / "x.csv"
    channels = {"load": FORCE / 1e3, "depth": 500 * np.sqrt(FORCE / 2e3)} | {channel: np.full_like(FORCE, 0.5)}
    rows = zip(TIME, channels["load"], channels["depth"], strict=True)
    file.write_text("time_s,load_mN,depth_nm\n" + "\n".join(f"{a},{b},{c}" for a, b, c in rows))
    with pytest.raises(InputError, match=f"x.csv, x: the {channel} is 0.5 .* at all {len(FORCE)} points"):
        read_vendor_file(file, contact=contact)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--columns", "time=t / s,load=Fn,depth=hh"], "columns of its header (No, h, t / s, Fn)"),
        (["--columns", "time=t / s,load=Fn,depth=Fn"], "load and depth are both 'Fn'"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--contact", "5e9"], "outside the way in"),
        (["--units", "load=uN"], "add columns"),
        (["--columns", "time=t / s,load=Fn"], "no column is named for depth"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--units", "load=kg"], "load in 'kg' is not known"),
        (["--columns", "time=t / s,load=Fn,depth=h,force=Fn"], "'force' is no channel"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--raw"], "final channels only"),
        (["--columns", "time=t / s,load=Fn,depth=h", "--test", "²"], "has no test '²'"),
        (["--columns", "time=²,load=³,depth=¹"], "no table with numbers in the columns ², ³, ¹"),
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


@pytest.mark.parametrize("heading", ["Time", "Time (hh:mm:ss)", "Time/h:m:s"])
def test_clocks_are_read(tmp_path, heading):
    file = tmp_path / "x.csv"
    file.write_text(f"{heading};Load (mN);Depth (nm)\n0:59:58,5;0;0\n1:00:00;1;1\n1:01:00,25;2;2\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.time == pytest.approx([0, 1.5, 61.75])
    assert test.warnings == ()


@pytest.mark.parametrize("time", ["1h 02", "2024-03-01", "Mon 00:99", "0:00:61"])
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
        (500 + 7 * TIME, TIME, "the depth is counted from where the test begins, 500 nm of the file"),
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


def test_air_before_contact_is_left_out_where_no_contact_is_marked(tmp_path):
    file = tmp_path / "x.csv"
    table = np.column_stack([TIME, np.clip(TIME - 15, 0, None), 7 * TIME - 100])
    np.savetxt(file, table, header="time_s;load_mN;depth_nm", comments="", delimiter=";")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.warnings[0].startswith("the file marks no contact, the load does not rise over the first 25 %")
    assert test.recording.depth.max() == pytest.approx(7 * (TIME[-1] - 15), abs=1.0)


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
    with pytest.raises(InputError, match=f"its table names {others}, but no column that palpate knows as {missing}"):
        read_vendor_file(file)
    with pytest.raises(
        InputError, match=f"no column is named for {missing}; .* export it with {missing}, which cannot"
    ):
        ColumnMap({key: key for key in ("time", "load", "depth") if key != missing})


def test_a_text_that_only_speaks_of_load_and_depth_is_of_no_format(tmp_path):
    (tmp_path / "x.txt").write_text("The load at this depth\nwas 5\nnot 7\n")
    with pytest.raises(InputError, match="no format that palpate knows"):
        read_vendor_file(tmp_path / "x.txt")


@pytest.mark.parametrize(
    ("head", "scales"),
    [
        ("Time (s),Load (mN),Depth (nm)", (1.0, 1.0, 1.0)),
        ("t [ms],P [uN],h [um]", (1e-3, 1e-3, 1e3)),
        ("Test Time / s,Load On Sample / mN,Displacement Into Surface / nm", (1.0, 1.0, 1.0)),
        ("Time,Force,Indentation\ns,N,mm", (1.0, 1e3, 1e6)),
        ("Time (s),Load (mN),Depth (nm),Stiffness (N/m)", (1.0, 1.0, 1.0)),
    ],
)
def test_headings_with_units_that_leave_no_doubt_are_enough(tmp_path, head, scales):
    more = ",7" if head.count(",") == 3 else ""
    body = [f"{t:.7f},{p:.7f},{h:.7f}{more}" for t, p, h in zip(TIME, FORCE, PATH, strict=True)]
    (tmp_path / "x.csv").write_text("\n".join([head, *body]))
    (test,) = read_vendor_file(tmp_path / "x.csv")
    assert "read by its headings: time from " in test.warnings[0]
    found = (test.recording.time, test.recording.load, test.recording.depth)
    for channel, written, scale in zip(found, (TIME, FORCE, PATH), scales, strict=True):
        assert channel == pytest.approx(scale * written, rel=1e-5, abs=1e-5 * scale)


@pytest.mark.parametrize(
    "head",
    [
        "Time,Load,Depth",
        "Time (s),Load (mN),Depth",
        "Time (s),Force (nN),Piezo displacement (nm)",
        "Time (s),Load (mN),Depth (nm),Depth corrected (nm)",
        "Time (s),Load (mN),Load (V),Depth (nm)",
        "Time (s),Load,Depth (nm),uN",
    ],
)
def test_headings_that_leave_a_doubt_are_not(tmp_path, head):
    more = ",7" * (head.count(",") - 2)
    body = [f"{t:.7f},{p:.7f},{h:.7f}{more}" for t, p, h in zip(TIME, FORCE, PATH, strict=True)]
    (tmp_path / "x.csv").write_text("\n".join([head, *body]))
    with pytest.raises(InputError, match="name the columns of its table"):
        read_vendor_file(tmp_path / "x.csv")
