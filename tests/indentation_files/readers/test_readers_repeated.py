"""Names that a file repeats: columns with other numbers under one name, and tests below one another in one file."""

import numpy as np
import pytest
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, read_vendor_file
from palpate.errors import InputError

TIME = np.linspace(0.0, 20.0, 101)
LOAD = np.interp(TIME, [0.0, 10.0, 20.0], [0.0, 5.0, 0.0])
DEPTH = 300.0 * np.sqrt(LOAD)
HEADS = {
    "Indentation\n\n": ("Time (s)", "Pd (nm)", "Fn (mN)"),
    f"Mon Mar 1\n\nNumber of Points = {len(TIME)}\n": ("Time (s)", "Depth (nm)", "Load (mN)"),
    "Device:\tPiuma\n\n": ("Time (s)", "Indentation (nm)", "Load (mN)", "Cantilever (nm)", "Piezo (nm)"),
}
VALUES = {"Time": TIME, "Load": LOAD, "Fn": LOAD, "Cantilever": 0 * TIME}


def text(head, names, turned=1.0, again=False):
    """A text whose second column may stand once more at the end, with other numbers."""
    names = (*names, names[1]) if again else names
    values = [VALUES.get(name.split()[0], DEPTH) for name in names]
    values[-1] = values[-1] * (turned if again else 1.0)
    rows = ["\t".join(f"{value:.6f}" for value in row) for row in zip(*values, strict=True)]
    return head + "\n".join(["\t".join(names), *rows, ""])


@pytest.mark.parametrize(("head", "names"), HEADS.items())
def test_columns_of_one_name_with_other_numbers_are_refused(tmp_path, head, names):
    (tmp_path / "x.txt").write_text(text(head, names, 1.2, again=True))
    with pytest.raises(InputError) as raised:
        read_vendor_file(tmp_path / "x.txt")
    assert f"several columns are called {names[1]!r}; give the columns by their numbers" in str(raised.value)
    (tmp_path / "x.txt").write_text(text(head, names, 1.0, again=True))
    (test,) = read_vendor_file(tmp_path / "x.txt")
    assert test.recording.depth.max() == pytest.approx(DEPTH.max(), abs=1e-3)


@pytest.mark.parametrize("units", [["s", "mN", "nm", "um"], ["s", "mN", "nm", "nm"]])
def test_so_are_those_of_a_workbook_in_the_same_unit(tmp_path, units):
    turned = 1e-3 if units[3] == "um" else 1.2
    rows = np.column_stack([TIME, LOAD, DEPTH, turned * DEPTH]).tolist()
    file = write_workbook(tmp_path / "x.xlsx", {"Test 1": [["TIME", "LOAD", "DEPTH", "DEPTH"], units, *rows]})
    if units[3] == "um":
        assert read_vendor_file(file)[0].recording.depth.max() == pytest.approx(DEPTH.max())
        return
    with pytest.raises(InputError, match="several columns are called 'DEPTH'"):
        read_vendor_file(file)


@pytest.mark.parametrize(("head", "names"), HEADS.items())
def test_another_test_below_is_no_sign_of_a_file_that_is_cut_off(tmp_path, head, names):
    (tmp_path / "x.txt").write_text(2 * text(head, names))
    with pytest.raises(InputError) as raised:
        read_vendor_file(tmp_path / "x.txt")
    assert f"{head.split()[0]}" in str(raised.value) and "is not a row of numbers" in str(raised.value)
    assert "cut off" not in str(raised.value)
    columns = ColumnMap({"time": names[0], "load": names[2], "depth": names[1]})
    assert [len(test.recording) for test in read_vendor_file(tmp_path / "x.txt", columns=columns)] == [101, 101]


def test_more_points_than_announced_are_no_sign_of_it_either(tmp_path):
    head, names = list(HEADS.items())[1]
    (tmp_path / "x.txt").write_text(text(head.replace("101", "60"), names))
    with pytest.raises(InputError, match="holds 101 points, 60 were announced; more than one test may be in it"):
        read_vendor_file(tmp_path / "x.txt")
