"""Tables of strangers in which single rows, names or signs are not what they seem: read as meant, told, or refused."""

import numpy as np
import pytest
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, Unreadable, read_each, read_vendor_file
from indentation_files.readers.several_tests import without_stand_ins
from indentation_files.recording import Recording, copies
from palpate.errors import InputError

HEAD = "Time (s);Load (mN);Depth (nm)"
LOAD = [0, 1, 2, 3, 4, 4, 4, 4, 4, 3, 2, 1, 0]
DEPTH = [0, 300, 450, 550, 630, 650, 660, 668, 675, 650, 610, 550, 480]
ROWS = [f"{t};{p};{h}" for t, (p, h) in enumerate(zip(LOAD, DEPTH, strict=True))]
BY_NAME = ColumnMap({"time": "Time (s)", "load": "Load (mN)", "depth": "Depth (nm)"})
BY_NUMBER = ColumnMap({"time": "1", "load": "2", "depth": "3"})


def read(tmp_path, rows, columns=BY_NAME, head=HEAD, end="\n"):
    (tmp_path / "x.csv").write_text("\n".join([head, *rows]) + end, encoding="utf-8")
    return read_vendor_file(tmp_path / "x.csv", columns=columns, contact="none")


def whole(tests):
    (test,) = tests
    assert test.recording.depth.tolist() == DEPTH
    assert test.recording.load.tolist() == LOAD
    return " ".join(test.warnings)


@pytest.mark.parametrize("row", ["78;29;7013", "13;9.91E+37;480", "13;0;1e31"])
def test_totals_and_overflows_at_the_end_are_no_points(tmp_path, row):
    assert "line 15" in whole(read(tmp_path, [*ROWS, row]))


def test_a_film_that_breaks_at_the_end_is_kept(tmp_path):
    (test,) = read(tmp_path, [*ROWS[:9], "9;4;7013"])
    assert test.recording.depth[-1] == 7013


def test_a_number_that_is_cut_off_at_the_end_is_left_out(tmp_path):
    (test,) = read(tmp_path, [*ROWS[:12], "12;0;48"], end="")
    assert test.recording.depth.tolist() == DEPTH[:12]
    assert any("ends within a number" in warning for warning in test.warnings)
    assert whole(read(tmp_path, ROWS, end="")) == ""


@pytest.mark.parametrize("between", [["", "4;4.01;631"], ["", *ROWS[3:5]], [HEAD, *ROWS[3:5]]])
def test_segments_after_a_blank_row_that_overlap_are_one_test(tmp_path, between):
    rows = [f"{k / 10};{p:g};{h:g}" for k, p, h in zip(
        range(121), np.interp(np.arange(121), np.arange(13) * 10, LOAD),
        np.interp(np.arange(121), np.arange(13) * 10, DEPTH), strict=True)]  # fmt: skip
    repeated = [row if row in ("", HEAD) else rows[40] for row in between]
    (test,) = read(tmp_path, [*rows[:41], *repeated, *rows[41:]])
    assert len(test.recording) == 121


def test_rows_that_cannot_be_read_at_either_end_are_told(tmp_path):
    rows = [f"{k};{min(k, 100 - k)};{10 * min(k, 120 - k)}" for k in range(101)]
    unread = ["{} s;{} mN;{} nm".format(*row.split(";")) for row in rows]
    for some in ([*unread[:3], *rows[3:]], [*rows[:98], *unread[98:]]):
        (test,) = read(tmp_path, some)
        assert any("3 of 101 rows left out" in warning for warning in test.warnings)
    with pytest.raises(InputError, match="rows cannot be used"):
        read(tmp_path, [*rows[:60], *unread[60:]])


def test_columns_of_unlike_decimal_signs_are_refused(tmp_path):
    rows = [f"{k // 10 + 1},{k % 10}00;{k / 100:.4f};{3.1 * k:.2f}" for k in range(60)]
    with pytest.raises(InputError, match="has a decimal sign or parts thousands"):
        read(tmp_path, rows)
    with pytest.raises(InputError, match="decimal sign"):
        read(tmp_path, [row.replace("1,", "0,", 1) for row in rows[:10]] + rows[10:])


@pytest.mark.parametrize("values", [("", "5"), ("-", "5"), ("5", "0%")])
def test_a_channel_without_numbers_is_one_line(tmp_path, values):
    rows = [f"{k};{values[0]};{0 if k == 3 else values[1]}" for k in range(6)]
    with pytest.raises(InputError):
        read(tmp_path, rows)


def test_a_load_applied_at_once_begins_with_the_contact(tmp_path):
    rows = ["0;0;0", *(f"{i};{10 + 0.01 * ((7 * i) % 11):.2f};{900 + i}" for i in range(1, 40))]
    (test,) = read(tmp_path, rows)
    assert (test.recording.load[0], test.recording.depth[0], len(test.recording)) == (0.0, 0.0, 40)


def test_cycles_down_to_zero_keep_their_zeros(tmp_path):
    load = np.tile([2, 4, 6, 8, 10, 8, 6, 4, 2, 0], 10)
    rows = ["0;0;0", *(f"{k};{p};{100 + 20 * p + k}" for k, p in enumerate(load, 1))]
    (test,) = read(tmp_path, rows)
    assert len(test.recording) == 101


@pytest.mark.parametrize("row", [1, 20, 38])
def test_a_zero_that_drops_out_is_no_value_wherever_it_stands(row):
    load = np.linspace(5.0, 6.0, 40)
    load[row] = 0.0
    _, found, _ = without_stand_ins([np.arange(40.0), load, np.linspace(500.0, 900.0, 40)])
    assert np.flatnonzero(np.isinf(found)).tolist() == [row]


def test_names_in_quotes_over_two_lines_state_their_units(tmp_path):
    head = '"Time\n(s)";"Load\n(uN)";"Depth\n(um)"'
    (test,) = read(tmp_path, ROWS, BY_NUMBER, head)
    assert test.recording.load.max() == pytest.approx(4e-3)
    assert test.recording.depth.max() == pytest.approx(675e3)


@pytest.mark.parametrize(("encoding", "cut"), [("utf-32", 0), ("utf-16", 0), ("utf-16", 1)])
def test_wide_letters_are_read_also_where_the_last_is_cut(tmp_path, encoding, cut):
    content = "\n".join([HEAD, *ROWS, ""]).encode(encoding)
    (tmp_path / "x.csv").write_bytes(content[: len(content) - cut])
    assert whole(read_vendor_file(tmp_path / "x.csv", columns=BY_NAME, contact="none")) == ""


def test_exchanged_columns_and_tests_beside_are_told(tmp_path):
    exchanged = [";".join(row.split(";")[k] for k in (0, 2, 1)) for row in ROWS]
    (test,) = read(tmp_path, exchanged, BY_NUMBER, "Time;Depth;Load")
    assert any("'Depth' is taken as the load" in warning for warning in test.warnings)
    head = ";".join([HEAD, *(f"{name}.1" for name in HEAD.split(";"))])
    assert "stand there again" in whole(read(tmp_path, [f"{row};{row}" for row in ROWS], head=head))


@pytest.mark.parametrize("load", ["1000*Load (mN)", "Load (mN) /1000", "Load (mN) (x 0.001)", "Load (mN), x1000"])
def test_factors_beside_a_name_are_asked_for(tmp_path, load):
    with pytest.raises(InputError, match="is not known"):
        read(tmp_path, ROWS, BY_NUMBER, f"Time (s);{load};Depth (nm)")


def test_averages_are_no_replicates(tmp_path):
    table = [HEAD.split(";"), *([float(cell) for cell in row.split(";")] for row in ROWS)]
    names = ("A", "B", "Average", "Std")
    path = write_workbook(tmp_path / "x.xlsx", {name: table for name in names})
    left_out = [test.name for test in read_each(path, columns=BY_NAME) if isinstance(test, Unreadable)]
    assert left_out == ["Average", "Std"]


def test_a_workbook_that_mixes_numbers_and_texts_is_told(tmp_path):
    table = [HEAD.split(";"), *([float(cell) for cell in row.split(";")] for row in ROWS)]
    table[5][2] = "630.5"
    (test,) = read_vendor_file(write_workbook(tmp_path / "x.xlsx", {"A": table}), columns=BY_NAME, contact="none")
    assert any("the depth is a number in 12 cells and a text in 1" in warning for warning in test.warnings)


def test_a_test_exported_again_with_fewer_digits_is_the_same():
    rng, time = np.random.default_rng(0), np.linspace(0, 60, 100)
    noise = 0.3 * rng.standard_normal((2, 100))
    first, other = (Recording(time, np.sin(time / 20), 500 * np.sin(time / 20) + own, "a") for own in noise)
    again = Recording(np.round(first.time, 3), np.round(first.load, 3), np.round(first.depth, 1), "again")
    assert copies([first, other, again]) == [(again, first)]
