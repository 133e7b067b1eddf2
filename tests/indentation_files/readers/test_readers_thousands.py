"""Numbers with separators of thousands: commas, points, blanks and apostrophes."""

import numpy as np
import pytest
from tables import FORCE, PATH, SHORT, TIME

from indentation_files.readers import read_vendor_file
from palpate.errors import InputError


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


@pytest.mark.parametrize("parting", ["'", "\u2019", "\u2009", "\u202f", "\xa0"])
@pytest.mark.parametrize(("delimiter", "comma"), [(",", "."), (";", ","), ("\t", "."), (" ", "."), (" ", ",")])
@pytest.mark.parametrize("decimals", [0, 1])
def test_blanks_and_apostrophes_part_thousands(tmp_path, parting, delimiter, comma, decimals):
    depth = np.round(3e4 * PATH, decimals)
    signs = str.maketrans({"_": parting, ".": comma})
    rows = [[f"{x:_.{decimals}f}".translate(signs) for x in row] for row in zip(TIME, FORCE, depth, strict=True)]
    file = tmp_path / "x.csv"
    file.write_text("\n".join(delimiter.join(row) for row in [["t", "P", "h"], *rows]), encoding="utf-8")
    (test,) = read_vendor_file(file, columns=SHORT)
    assert test.recording.depth == pytest.approx(depth)
    assert test.recording.load == pytest.approx(np.round(FORCE, decimals))
    assert test.warnings == ()


def test_the_apostrophe_of_windows_parts_thousands(tmp_path):
    file = tmp_path / "x.csv"
    file.write_bytes("t;P;h\n0;0;0\n1;1;1’000.5\n2;2;1’234’567\n".encode("cp1252"))
    (test,) = read_vendor_file(file, columns=SHORT)
    assert test.recording.depth == pytest.approx([0, 1000.5, 1234567])


@pytest.mark.parametrize("cell", ["1'00", "1''000", "0'001", "1'000’000", "12'3456", "1'000e3"])
def test_an_apostrophe_elsewhere_makes_no_number(tmp_path, cell):
    (tmp_path / "x.csv").write_text(f"t;P;h\n0;0;0\n1;1;{cell}\n2;2;2\n")
    with pytest.raises(InputError, match=r"line 3: .* is not three numbers"):
        read_vendor_file(tmp_path / "x.csv", columns=SHORT)
