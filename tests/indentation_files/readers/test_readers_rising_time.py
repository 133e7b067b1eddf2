"""Points whose time is out of order: the fewest are left out, whichever side of them is spoilt."""

import numpy as np
import pytest
from tables import NUMBERED

from indentation_files.readers import read_vendor_file
from indentation_files.readers.rising_time import increasing, stands_still

ROWS = [f"{t}\t{min(t, 100 - t)}\t{10 * min(t, 100 - t)}" for t in range(101)]


@pytest.mark.parametrize("spoilt", [-5.0, 0.0, 999.0, 1e6])
@pytest.mark.parametrize("place", [3, 50, 95])
def test_one_spoilt_time_costs_one_point(spoilt, place):
    time = np.arange(100.0)
    time[place] = spoilt
    assert np.flatnonzero(~increasing(time)).tolist() == [place]


def test_what_is_left_rises_and_no_more_could_be():
    rng = np.random.default_rng(3)
    for _ in range(200):
        time = rng.integers(0, 9, 8).astype(float)
        rising = increasing(time)
        assert (np.diff(time[rising]) > 0).all()
        chosen = [[bool(number >> k & 1) for k in range(8)] for number in range(256)]
        most = max(sum(mask) for mask in chosen if (np.diff(time[np.array(mask)]) > 0).all())
        assert rising.sum() == most


def test_a_time_that_is_repeated_stands_still():
    time = np.array([0.0, 1.0, 1.0, 2.0, 0.5, 3.0])
    rising = increasing(time)
    assert rising.tolist() == [True, True, False, True, False, True]
    assert stands_still(time, rising).tolist() == [False, False, True, False, False, False]


@pytest.mark.parametrize("above", ["1\t2\t3", "1\t0.001\t1"])
def test_a_row_of_numbers_or_factors_above_the_values_is_none_of_them(tmp_path, above):
    (tmp_path / "x.txt").write_text("\n".join(["Time (s)\tLoad (mN)\tDepth (nm)", above, *ROWS]))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=NUMBERED, contact="none")
    assert test.recording.time.tolist() == list(range(101))
    assert any("(line 2) is no value; if these are factors, --units" in warning for warning in test.warnings)
