"""Tables that hold several tests below one another."""

import pytest
from tables import FORCE, NUMBERED, PATH, SHORT, TIME
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, read_each, read_vendor_file
from indentation_files.readers.vendor import Unreadable
from palpate.errors import InputError


def below_one_another(*tests, heading="t,P,h"):
    """A text of several tests, each under the same row of names and a title."""
    blocks = [
        [f"Test {k}", heading, *(f"{a:g},{b:g},{c:g}" for a, b, c in zip(*test, strict=True))]
        for k, test in enumerate(tests)
    ]
    return "\n".join(line for block in blocks for line in ["", *block]) + "\n"


ONE = (TIME, FORCE / 1e3, 1e3 * PATH)
OTHER = (TIME[:40], FORCE[:40] / 2e3, 900 * PATH[:40])


@pytest.mark.parametrize("columns", [SHORT, NUMBERED])
@pytest.mark.parametrize("workbook", [False, True])
def test_tests_below_one_another_under_the_same_header_are_read_each(tmp_path, workbook, columns):
    file = tmp_path / "x.csv"
    lines = below_one_another(ONE, OTHER, ONE, heading="t (s),P (mN),h (nm)").splitlines()
    if columns is SHORT:
        lines = [line.replace(" (s)", "").replace(" (mN)", "").replace(" (nm)", "") for line in lines]
    if workbook:
        cells = [[cell if not cell[:1].isdigit() else float(cell) for cell in line.split(",")] for line in lines]
        write_workbook(file, {"x": cells})
    else:
        file.write_text("\n".join(lines))
    tests = read_vendor_file(file, columns=columns)
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


@pytest.mark.parametrize("columns", [SHORT, ColumnMap(NUMBERED.names, SHORT.units)])
def test_a_header_repeated_within_a_test_parts_nothing(tmp_path, columns):
    file = tmp_path / "x.csv"
    first, second = (tuple(channel[half] for channel in ONE) for half in (slice(30), slice(30, None)))
    file.write_text(below_one_another(first, second))
    (test,) = read_vendor_file(file, columns=columns)
    assert test.recording.time == pytest.approx(TIME)


def test_tests_below_one_another_under_other_headers_are_refused(tmp_path):
    file = tmp_path / "x.csv"
    for heading, other in (("t,P,h", "t,P,H"), ("t,P,h\ns,mN,nm", "t,P,h\ns,uN,nm")):
        file.write_text(below_one_another(ONE, heading=heading) + below_one_another(OTHER, heading=other))
        with pytest.raises(InputError, match="write each of several tests to a file of its own"):
            read_vendor_file(file, columns=SHORT)


def test_a_header_that_first_comes_below_numbers_parts_nothing(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("\n".join(["0,0,0", *below_one_another(ONE, OTHER, heading="t (s),P (mN),h (nm)").splitlines()]))
    with pytest.raises(InputError, match="write each of several tests to a file of its own"):
        read_vendor_file(file, columns=NUMBERED)
