"""Long text exports: what is read by columns is what is read row by row, and no more of it is kept than counts."""

import io
import tracemalloc

import numpy as np
import pytest
from tables import SHORT

from indentation_files import recording
from indentation_files.readers import lines, plain_numbers, read_vendor_file, source
from indentation_files.readers.decimals import numbers
from indentation_files.readers.lines import Lines
from palpate.errors import InputError

POINTS = 600
TIME = np.linspace(0.0, 60.0, POINTS)
LOAD = np.interp(TIME, [0, 30, 60], [0, 2, 0.01])
DEPTH = 250 * np.sqrt(LOAD / 2)
ROWS = [f"{t:.4f}\t{P:.6f}\t{h:.5e}" for t, P, h in zip(TIME, LOAD, DEPTH, strict=True)]
HYSITRON = ["Mon Apr 29", f"Number of Points = {POINTS}", "Time (s)\tLoad (mN)\tDepth (nm)"]
ANTON_PAAR = ["", "Indentation", "EIT=\t2.5 GPa", "Time (s)\tFn (mN)\tPd (nm)"]
NAMED = ["a laboratory", "t\tP\th", "s\tmN\tnm"]


def layout(head, rows=ROWS, tail=(), delimiter="\t", comma=False, ends="\n"):
    text = ends.join([*rows, *tail, ""]).replace(".", "," if comma else ".")
    return (ends.join(head) + ends + text).replace("\t", delimiter)


LAYOUTS = {
    "hysitron": layout(HYSITRON),
    "anton_paar": layout(ANTON_PAAR, comma=True, ends="\r\n"),
    "blank rows": layout(ANTON_PAAR, [*ROWS[:200], "", "", *ROWS[200:]]),
    "empty cells": layout(ANTON_PAAR, [*ROWS[:300], ROWS[300].rpartition("\t")[0] + "\t", *ROWS[301:]]),
    "invalid": layout(ANTON_PAAR, [*ROWS, "61.0\tNaN\t1.79769e308"]),
    "cut off": layout(ANTON_PAAR, [*ROWS, "61.0\t0.5"]),
    "words": layout(ANTON_PAAR, tail=["the end"]),
    "columns": layout(NAMED),
    "semicolons": layout(NAMED, delimiter=";", comma=True, ends="\r"),
    "commas": layout(NAMED, delimiter=","),
    "blanks": layout(NAMED, [f"  {row} " for row in ROWS], delimiter="   "),
    "no blank line": layout([*NAMED, ""], delimiter=";"),
    "two tests": layout(NAMED, [*ROWS, "", *ROWS]),
    "two headers": layout(NAMED, [*ROWS, *NAMED[1:], *ROWS]),
    "tail": layout(NAMED, tail=["mean\t1.0\t2.0", "the end"]),
    "padding": layout(NAMED, [*ROWS, *["0.0\t0.0\t0.0"] * 5]),
    "time goes back": layout(NAMED, [*ROWS[:300], ROWS[100], *ROWS[300:]]),
    "thousands": layout(NAMED, [row.replace("\t0.", "\t1,000.") for row in ROWS]),
    "whole numbers": layout(NAMED, [f"{k}\t{min(k, 700 - k)}\t{k}" for k in range(POINTS)], tail=["601\t5,5\t7"]),
    "narrow header": layout(["t\tP\th"], [row + "\t1.5" for row in ROWS], delimiter=","),
}


def lines_of(text):
    return Lines.of(io.BytesIO(text), "utf-8", last=len(text))


def found(path, columns):
    try:
        tests = read_vendor_file(path, columns=columns, contact="none")
    except InputError as error:
        return str(error)
    return [(t.name, t.warnings, t.metadata, t.recording.time, t.recording.load, t.recording.depth) for t in tests]


@pytest.mark.parametrize("kind", LAYOUTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_rows_read_at_once_and_one_by_one_are_the_same(tmp_path, monkeypatch, kind, encoding):
    path = tmp_path / "a.txt"
    path.write_bytes(LAYOUTS[kind].encode(encoding))
    columns = SHORT if "t\tP\th" in LAYOUTS[kind].replace(";", "\t").replace(",", "\t").replace("   ", "\t") else None
    slowly = found(path, columns)
    monkeypatch.setattr(plain_numbers, "SHORT", 0)
    monkeypatch.setattr(lines, "BLOCK", 1000)
    assert repr(found(path, columns)) == repr(slowly)


@pytest.mark.parametrize(("delimiter", "sign"), [("\t", "."), (";", ","), (",", "."), (" ", ".")])
def test_plain_numbers_are_those_of_the_cells(monkeypatch, delimiter, sign):
    monkeypatch.setattr(plain_numbers, "SHORT", 0)
    values = np.random.default_rng(1).standard_normal((500, 4)) * 10.0 ** np.arange(-150, 50, 50)
    cells = [[f"{value:.17g}".replace(".", sign) for value in row] for row in values]
    text = "\n".join(map(delimiter.join, cells)).encode()
    assert np.array_equal(plain_numbers.plain_numbers(lines_of(text), delimiter)[0].T, values)
    assert np.array_equal(numbers(cells, str), values)


@pytest.mark.parametrize("cell", ["x", "1 2", "infinity", "1,5,5", "1.5.5", "0x10", "'1", "1_0"])
def test_what_is_no_plain_number_is_left_to_the_reader_of_single_cells(monkeypatch, cell):
    monkeypatch.setattr(plain_numbers, "SHORT", 0)
    text = f"1.5\t2.5\n{cell}\t2.5\n".encode()
    assert plain_numbers.plain_numbers(lines_of(text), "\t") is None


@pytest.mark.parametrize("text", ["", "a", "a\n", "a\r\nb", "a\rb\n\r\n1", "\r\r\n\n1;2\n\nµ", "1\n2\r"])
@pytest.mark.parametrize("block", [1, 2, 3, 100])
def test_lines_end_where_a_text_s_do(monkeypatch, text, block):
    monkeypatch.setattr(lines, "BLOCK", block)
    whole = lines.BREAK.split(text)
    read = lines_of(text.encode())
    assert list(read) == [read[k] for k in range(len(read))] == whole
    assert list(read[1:]) == whole[1:]
    assert [line for _, line in read.in_words()] == [line for line in whole if set(line) & set("abµ")]


def test_of_a_long_test_evenly_spaced_points_and_the_last_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(recording, "MOST", 100)
    (tmp_path / "a.txt").write_text(LAYOUTS["hysitron"])
    (test,) = read_vendor_file(tmp_path / "a.txt", contact="none")
    assert test.recording.time == pytest.approx(np.append(TIME[::6], TIME[-1]), abs=1e-4)
    assert "101 of 600 points are kept" in test.warnings[-1]


@pytest.mark.parametrize(("head", "columns"), [(ANTON_PAAR, None), (NAMED, SHORT)])
def test_a_long_text_is_never_held_whole_and_its_columns_once(tmp_path, monkeypatch, head, columns):
    monkeypatch.setattr(recording, "MOST", 1000)
    for module in (lines, source):
        monkeypatch.setattr(module, "BLOCK", 1 << 16)
    rows = [f"{k / 1000:.3f}\t{np.interp(k, [0, 50_000, 100_000], [0, 2, 0.01]):.9f}\t{k:.9f}" for k in range(100_000)]
    (tmp_path / "a.txt").write_text(layout(head, rows))
    found(tmp_path / "a.txt", columns)
    tracemalloc.start()
    found(tmp_path / "a.txt", columns)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2.5 * 8 * 3 * len(rows)
