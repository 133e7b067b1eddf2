"""Air is no part of a test: it is left out, or told in one line, however a file counts its depth."""

import re
from pathlib import Path

import numpy as np
import pytest

from indentation_files.contact_interval import interval_of, joint_interval
from indentation_files.readers import ColumnMap, read_vendor_file
from indentation_files.readers.in_air import air_at_start, suspects
from indentation_files.readers.vendor import VendorTest
from indentation_files.readers.zero import decision, zeroed, zeroed_each
from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.configuration.condition import Condition
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS, Scale
from palpate.solver.study_scale import with_contact_sought
from palpate.study.protocol import trapezoid
from palpate.workflow_support.data_quality import anomalies

CASES = Path(__file__).parents[3] / "shared/cases/files"
NUMBERED = ColumnMap({"time": "1", "load": "2", "depth": "3"})
DEEP = 800.0
PRESSED = Condition("P", "calibrate", trapezoid(2.0, 20, 10, 20))


def pressed(time):
    """Load [mN] and depth [nm] of a cone from contact at time zero: 20 s up, 10 s hold, 20 s down, then away."""
    load = 2.0 * np.interp(time, [0, 20, 30, 50], [0, 1, 1, 0])
    loading = DEEP * np.sqrt(np.clip(load, 0, None) / 2.0)
    unloading = 400.0 + 400.0 * np.sqrt(load / 2.0)
    depth = np.where(time < 25, loading, unloading)
    return load, np.where(time > 50, 400.0 - 100.0 * (time - 50), depth)


def recording(before, offset=0.0, after=0.0, level=0.0):
    """A test behind `before` (times, depths) of air; after it the tip leaves, and the load cell reads `level` more."""
    rng = np.random.default_rng(4)
    time = np.arange(before[0][0] if len(before[0]) else 0.0, 50.0 + after, 0.1)
    load, depth = pressed(np.clip(time, 0, None))
    air = time < 0
    depth[air] = np.interp(time[air], *before) if air.any() else 0.0
    load += level * np.clip((time - 20) / 30, 0, 1) + 1e-4 * rng.standard_normal(len(time))
    return Recording(time - time[0], load, depth + offset, "glass")


APPROACH = ([-30.0, 0.0], [-3000.0, 0.0])
RETREAT = ([-4.0, -3.0, -2.0, 0.0], [0.0, -100.0, -100.0, 0.0])


@pytest.mark.parametrize(("late", "told"), [(0, False), (1, True), (12, True)])
def test_a_mark_set_after_the_load_has_risen_is_told(late, told):
    """12 points, 1.2 s, after contact the cone of `pressed` is 196 nm deep, a quarter of its largest depth."""
    whole = recording(APPROACH)
    mark = int(np.argmax(whole.time >= 30)) + late
    since, deep = whole.time - whole.time[mark], whole.depth - whole.depth[mark]
    test = VendorTest("T", Recording(since, whole.load, deep, "T"))
    said = [warning for warning in zeroed(test, "file").warnings if "marked too late" in warning]
    assert bool(said) == told
    if told:
        found = re.search(r"over the last (\S+) nm before the file's contact", said[0])
        assert float(found[1]) == pytest.approx(DEEP * np.sqrt(late / 200), rel=0.2)


@pytest.mark.parametrize("preload", [0.0, 0.2])
def test_a_test_under_load_at_zero_depth_is_told(preload):
    whole = recording(([], []))
    test = VendorTest("T", Recording(whole.time, whole.load + preload, whole.depth, "T"), marked=False)
    said = [warning for warning in zeroed(test, "file").warnings if "the load, or the depth, is not counted" in warning]
    assert len(said) == (1 if preload else 0)


def test_a_preload_that_is_taken_off_again_is_told_wherever_contact_is_put():
    """The tip presses by 0.1 of 2 mN, retreats into air, and comes back: its first touch is where it begins."""
    whole = recording(([-8.0, -6.0, -5.0, -4.0, 0.0], [0.0, 60.0, -100.0, -100.0, 0.0]))
    preload = np.interp(whole.time, [0.0, 2.0, 2.4], [0.0, 0.1, 0.0])
    test = VendorTest("T", Recording(whole.time, whole.load + preload, whole.depth, "T"), marked=False)
    for contact in ("file", "auto"):
        begun = zeroed(test, contact)
        assert begun.recording.depth.min() > -5 or any("the tip retreats by" in text for text in begun.warnings)


@pytest.mark.parametrize(
    ("air", "offset", "share"), [(APPROACH, 3000.0, "79 %"), (APPROACH, -500.0, "79 %"), (RETREAT, 0.0, "1")]
)
def test_contact_is_sought_where_a_file_marks_none_and_begins_in_air(air, offset, share):
    test = zeroed(VendorTest("glass", recording(air, offset), marked=False), "file")
    assert test.warnings[0].startswith(f"the file marks no contact, the load does not rise over the first {share}")
    assert ("retreats by 100 nm" in test.warnings[0]) == (air is RETREAT)
    assert test.recording.depth.max() == pytest.approx(DEEP, abs=25.0)
    lower, upper = interval_of(test.recording)
    assert lower < 0.0 < upper


def test_a_test_that_begins_at_contact_is_left_alone():
    whole = recording(([], []))
    test = zeroed(VendorTest("glass", whole, marked=False), "file")
    assert test.warnings == ()
    assert np.array_equal(test.recording.depth, whole.depth)
    assert interval_of(test.recording) is None


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("marked", [True, False])
def test_a_load_that_rises_from_contact_in_noise_is_no_air(marked, seed):
    """With 0.3 % of noise the load of a cone leaves it only after a twelfth of the depth."""
    time = np.arange(0.0, 50.0, 0.05)
    load, depth = pressed(time)
    noise = np.random.default_rng(seed).standard_normal((2, len(time)))
    begun = Recording(time, load + 6e-3 * noise[0], depth + noise[1], "cone")
    assert zeroed(VendorTest("cone", begun, marked=marked), "file").warnings == ()
    assert list(anomalies(PRESSED, [begun])) == []


def test_a_contact_that_was_sought_is_not_doubted_again():
    early = recording(([-8.0, 0.0], [-80.0, 0.0]), offset=80.0)
    sought = Recording(early.time, early.load, early.depth, "sought", ("contact_interval_nm: -30 90",))
    assert [len(list(anomalies(PRESSED, [test]))) for test in (early, sought)] == [1, 0]


@pytest.mark.parametrize("slope", [0.0, 2e-4, -2e-4])
@pytest.mark.parametrize("contact", ["file", "auto"])
def test_a_load_that_changes_with_the_depth_in_air_is_told(slope, contact):
    """By 0.2 mN/um, which over the 800 nm of the test adds 0.16 mN to its 2 mN."""
    whole = recording(APPROACH)
    whole = Recording(whole.time - 30.0, whole.load + slope * whole.depth, whole.depth, "glass")
    told = [line for line in zeroed(VendorTest("glass", whole), contact).warnings if "in air changes" in line]
    assert len(told) == bool(slope)
    for line in told:
        by, share = (float(word) for word in re.search(r"by (\S+) mN/um.* (\S+)% of the largest load", line).groups())
        assert by == pytest.approx(1e3 * slope, rel=0.02)
        assert share == pytest.approx(100 * slope * DEEP / (2 + slope * DEEP), abs=0.6)


def test_a_mark_set_too_early_is_told_and_kept():
    whole = recording(([-8.0, 0.0], [-80.0, 0.0]), offset=80.0)
    test = zeroed(VendorTest("glass", whole), "file")
    (said,) = test.warnings
    assert said.startswith("the load does not rise over the first")
    assert test.recording.depth.max() == pytest.approx(DEEP + 80.0)
    assert air_at_start(test.recording) == test.warnings, "palpate check says the same"


def test_many_tests_looked_at_together_are_those_that_are_told_one_by_one():
    tests = [recording(([], []), offset=k) for k in range(3)] + [recording(RETREAT), recording(APPROACH, 3000.0)]
    tests += [recording(([-8.0, 0.0], [-80.0, 0.0]), offset=80.0), recording(([], []), after=3.0)]
    told = [test for test in tests if air_at_start(test)]
    assert len(told) == 3
    assert suspects(tests) == told


def test_a_load_that_rises_at_once_in_few_points_is_no_air():
    time = np.linspace(0.0, 60.0, 60)
    load = np.minimum(time, 60.0 - time) / 30.0
    assert suspects([Recording(time, load, 300.0 * np.sqrt(load))]) == []


def test_a_retreat_after_the_mark_is_told():
    (said,) = zeroed(VendorTest("glass", recording(RETREAT)), "file").warnings
    assert said.startswith("the tip retreats by 100 nm after contact, before the load rises")


@pytest.mark.parametrize("level", [-0.004, 0.0, 0.004])
def test_a_test_ends_where_the_tip_leaves_though_the_load_cell_drifted(level):
    test = zeroed(VendorTest("glass", recording(([], []), after=20.0, level=level)), "file")
    assert test.recording.time[-1] == pytest.approx(50.0, abs=0.6)
    assert test.warnings[0].startswith(f"ends at {test.recording.time[-1] + 0.1:.4g} s, where the tip has left")


def test_reloading_after_the_tip_has_left_is_no_end():
    first, second = recording(([], []), after=8.0), recording(([], []))
    time = np.append(first.time, first.time[-1] + 0.1 + second.time)
    whole = Recording(time, np.append(first.load, second.load), np.append(first.depth, second.depth), "twice")
    assert len(zeroed(VendorTest("twice", whole), "file").recording) > 0.95 * len(whole)


def test_a_contact_far_from_the_file_s_own_is_told():
    whole = recording(APPROACH)
    test = VendorTest("glass", Recording(whole.time, whole.load, whole.depth + 3000.0, "glass"))
    assert any("from the file's own, more than the test is deep" in said for said in zeroed(test, "auto").warnings)


def test_the_user_s_own_contact_of_single_tests():
    tests = [VendorTest(f"Test {k}", recording(APPROACH, 3000.0), marked=False) for k in (1, 2, 3)]
    found = zeroed_each(Path("x"), tests, {"Test 2": 3010.0, 3: 2990.0})
    taken = [decision(test.recording, one.recording) for test, one in zip(tests, found, strict=True)]
    assert [words for words, _ in taken] == ["found by palpate", "given by the user", "given by the user"]
    assert [depth for _, depth in taken] == pytest.approx([3000.0, 3010.0, 2990.0], abs=25.0)
    with pytest.raises(InputError, match="has no test '7'"):
        zeroed_each(Path("x"), tests, {7: 1.0})


def test_the_file_s_own_contact_may_lie_before_its_first_row():
    time = np.linspace(0.1, 60.0, 600)
    test = VendorTest("late", Recording(time, 0.4 + time, 31.0 + 4.0 * time, "late"))
    assert decision(test.recording, zeroed(test, "file").recording) == ("the file's own", pytest.approx(0.0))


def test_the_interval_becomes_the_range_of_a_zero_offset(tmp_path):
    scale = Scale(500.0, 1.0, 3.0, 60.0, 30.0, 70.3, 0.1)
    one = Recording(np.arange(3.0), np.arange(3.0), np.arange(3.0), "a", ("contact_interval_nm: -4 9",))
    one.write(tmp_path / "a_1.csv")
    again = read_recording(tmp_path / "a_1.csv")
    other = Recording(np.arange(3.0), np.arange(3.0), np.arange(3.0), "b", ("contact_interval_nm: -6 2",))
    searched = MECHANISMS["zero_offset"].searched(with_contact_sought(scale, [again, other]))["offset"]
    assert (searched.lower, searched.upper) == (-6.0, 9.0)
    marked = Recording(np.arange(3.0), np.arange(3.0), np.arange(3.0), "c")
    assert joint_interval([one, marked]) is None
    assert with_contact_sought(scale, [one, marked]) is scale


def test_a_comment_that_is_no_interval_gets_one_line():
    bad = Recording(np.arange(3.0), np.arange(3.0), np.arange(3.0), "a", ("contact_interval_nm: 9 -4",))
    with pytest.raises(InputError, match="'9 -4' is no interval"):
        interval_of(bad)


@pytest.mark.skipif(not CASES.is_dir(), reason="no folder ../shared/cases beside the repository")
@pytest.mark.parametrize(
    ("file", "columns", "contact", "depth", "words"),
    [
        ("auto_contact_start_transient/gel.txt", None, "auto", (1000, 1180), "the tip has left"),
        ("auto_contact_tilt_interference/tilt.txt", NUMBERED, "auto", (1450, 1550), "the tip has left"),
        ("auto_contact_tilt_interference/interference.txt", NUMBERED, "auto", (1450, 1600), "the tip has left"),
        ("columns_approach_from_zero/test.txt", NUMBERED, "file", (870, 910), "over the first 77 % of the depth"),
        ("columns_retreat_before_contact/test.txt", NUMBERED, "file", (870, 910), "retreats by 100 nm"),
        ("kla_surface_marked_early/early.xlsx", None, "file", (960, 965), "does not rise over the first"),
        ("optics11_contact_unmarked/brain.txt", None, "file", (960, 1100), "the file marks no contact"),
        ("optics11_retreat_kept/gel.txt", None, "file", (955, 965), "the tip has left"),
    ],
)
def test_cases_from_outside(file, columns, contact, depth, words):
    (test,) = read_vendor_file(CASES / file, contact=contact, columns=columns)
    assert depth[0] < test.recording.depth.max() < depth[1]
    assert any(words in said for said in test.warnings)
    assert test.recording.depth.min() > -50.0


def test_read_and_draft_say_the_same(tmp_path, capsys):
    whole = recording(APPROACH, 3000.0)
    file = tmp_path / "test.txt"
    table = np.column_stack([whole.time, whole.load, whole.depth])
    np.savetxt(file, table, header="Time (s)\tLoad (mN)\tDepth (nm)", comments="", delimiter="\t")
    columns = ["--columns", "time=1,load=2,depth=3"]
    assert main(["read", str(file), *columns, "-o", str(tmp_path / "read")]) == 0
    said = capsys.readouterr().err.splitlines()
    assert main(["draft", str(file), *columns, "-o", str(tmp_path / "draft")]) == 0
    told = capsys.readouterr().err
    assert "the file marks no contact" in said[0]
    assert all(line.removeprefix("palpate: ") in told for line in said)
    (drafted,) = (tmp_path / "draft").rglob("*_1.csv")
    assert interval_of(read_recording(drafted)) == interval_of(read_recording(tmp_path / "read/test.csv"))
