"""Fischer: tests one below another, in mN, um and s, with decimal commas; a spoilt one costs only itself."""

import numpy as np
import pytest

from indentation_files.readers import Unreadable, read_each, read_vendor_file
from palpate.cli.main import main

TIME = np.arange(0.1, 60, 0.1)
LOAD = np.interp(TIME, [0, 30, 60], [0.4, 300, 30])
DEPTH = np.interp(TIME, [0, 30, 60], [30, 1535, 900])
SERIES = """FS1.hap\tName of the application
\tApplication comment
Standard\tName of test parameters
F = ESP n 300.000mN/120s/37s
C = ---
1\tNumber of block
3928,59\t44,652\t6,01398\tHM\tx\ty
16970,8\ts²\tStatistics of block
"""
HEAD = """FS1.hap   26.05.2020  15:17:54
Indenter shape correction: Hardness
HM  0.300000/     30.0/      0.0=   3928.6
Block : 1   Value : {}
x=    44.65  y=     6.01
EIT/(1-vs^2)\t[GPa]\t     83.7
hmax\t[µm]\t    1.535

Calculation of tangent with Power Law Method

"""


def export(tmp_path, *bodies, columns="F\th\tt"):
    text = SERIES + "".join(f"{HEAD.format(n)}{columns}\n{body}" for n, body in enumerate(bodies, 1))
    file = tmp_path / "FS1.txt"
    file.write_bytes(text.replace("\n", "\r\n").encode("latin-1"))
    return file


def body(factor=1.0, more=""):
    rows = zip(factor * LOAD, DEPTH / 1e3, TIME, strict=True)
    return "".join(f"{load:.6g}\t{depth:.6g}\t{time:.6g}{more}\n".replace(".", ",") for load, depth, time in rows)


@pytest.mark.parametrize(("columns", "more"), [("F\th\tt", ""), ("F\th\tt\tHMu\tHM", "\t1.5\t2.5")])
def test_tests_below_one_another_in_their_units(tmp_path, columns, more):
    tests = read_vendor_file(export(tmp_path, body(more=more), body(0.5, more), columns=columns))
    assert [test.name for test in tests] == ["Block 1 Value 1", "Block 1 Value 2"]
    for test, factor in zip(tests, (1, 0.5), strict=True):
        assert test.recording.time == pytest.approx(TIME, abs=1e-6)
        assert test.recording.load == pytest.approx(factor * LOAD, rel=1e-5)
        assert test.recording.depth == pytest.approx(DEPTH, rel=1e-5)
        assert test.metadata["hmax [µm]"] == "1.535"
        assert test.metadata["F"] == "ESP n 300.000mN/120s/37s"


def test_two_series_in_one_file_are_read_under_their_names(tmp_path):
    file = export(tmp_path, body())
    second = file.read_bytes().replace(b"FS1.hap", b"FS2.hap")
    file.write_bytes(file.read_bytes() + second)
    tests = read_vendor_file(file)
    assert [test.name for test in tests] == ["FS1.hap Block 1 Value 1", "FS2.hap Block 1 Value 1"]
    assert [len(test.recording) for test in tests] == [len(TIME)] * 2


def test_a_spoilt_test_costs_only_itself(tmp_path):
    first, second = read_each(export(tmp_path, body().replace("\t10\n", "\tten\n"), body()))
    assert isinstance(first, Unreadable)
    assert "line 119" in str(first.error)
    assert second.recording.load == pytest.approx(LOAD, rel=1e-5)


@pytest.mark.parametrize("bodies", [(), ("",)])
def test_a_series_without_tests_is_refused_in_one_line(tmp_path, bodies, capsys):
    assert main(["read", str(export(tmp_path, *bodies)), "-o", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_series_that_is_cut_off_in_its_last_test_says_so(tmp_path):
    file = export(tmp_path, body(), body())
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:-250]))
    whole, cut = read_each(file)
    assert whole.warnings == ()
    assert cut.warnings == ("ends under 255.9 of 300 mN, not unloaded; the file may be cut off",)


ODD = [(1.0, 1e-3, ""), (1.0, 1.0, "hmax = 1.535 µm"), (1e3, 1e-3, "Fmax = 300.000 mN")]


@pytest.mark.parametrize(("load", "depth", "odd"), ODD)
def test_units_that_the_stated_maxima_contradict_are_reported(tmp_path, load, depth, odd):
    body = "\n".join(f"{load * f:.6g}\t{depth * h:.6g}\t{t:.6g}" for t, f, h in zip(TIME, LOAD, DEPTH, strict=True))
    (test,) = read_vendor_file(export(tmp_path, body), contact="none")
    said = [warning for warning in test.warnings if "one of the units may be wrong" in warning]
    assert bool(said) == bool(odd) and all(odd in warning for warning in said)
