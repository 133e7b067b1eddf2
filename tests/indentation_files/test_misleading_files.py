"""Files that mislead: each kind is read right, or told in one line; the inputs lie beside the repository."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from indentation_files.contact_of_replicates import disagreeing
from indentation_files.readers import ColumnMap, Unreadable, VendorTest, read_each, read_vendor_file
from indentation_files.readers.tagged import averages
from indentation_files.recording import Recording
from palpate.errors import InputError

CASES = Path(__file__).parents[3] / "shared/cases/files"
NUMBERED = ColumnMap({"time": "1", "load": "2", "depth": "3"})
TESTXPERT = ColumnMap({"time": "Temps d'essai", "load": "Force standard", "depth": "Allongement"})

pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="no folder ../shared/cases beside the repository")


@pytest.mark.parametrize(
    ("file", "columns", "load", "depth"),
    [
        ("load_drop_taken_for_contact/no_approach.txt", NUMBERED, (99, 101), (470, 475)),
        ("load_drop_taken_for_contact/with_approach.txt", None, (59, 61), (370, 395)),
        ("load_drop_taken_for_contact/with_approach_deep.txt", None, (59, 61), (385, 412)),
        ("curved_baseline_keeps_air/rises_as_a_parabola.txt", NUMBERED, (8.5e-7, 9.8e-7), (200, 370)),
        ("curved_baseline_keeps_air/rises_near_the_surface.txt", NUMBERED, (8.5e-7, 9.8e-7), (200, 370)),
    ],
)
def test_contact_needs_air_before_it_and_air_may_curve(file, columns, load, depth):
    (test,) = read_vendor_file(CASES / file, columns=columns)
    assert load[0] < test.recording.load.max() < load[1]
    assert depth[0] < test.recording.depth.max() < depth[1]


def test_contact_lies_before_a_soft_layer():
    (test,) = read_vendor_file(CASES / "contact_after_soft_layer/tissue.txt", columns=NUMBERED)
    assert 10.0e6 < test.recording.depth.max() < 11.6e6, "13 mm less 2.4 to 3 mm, or where the layer first shows"


@pytest.mark.parametrize(("file", "rest"), [("reads_minus_0.36.txt", -0.36e-3), ("reads_minus_1.2.txt", -1.2e-3)])
def test_a_negative_load_at_rest_is_told_and_no_zero_to_cut_at(file, rest):
    (test,) = read_vendor_file(CASES / "negative_load_at_rest" / file, columns=NUMBERED)
    assert any("begins under" in said and "not counted from contact" in said for said in test.warnings)
    assert test.recording.time[-1] > 15.0
    assert test.recording.load.max() - rest == pytest.approx(1e-3, rel=0.02)


def test_a_depth_that_is_not_zero_at_contact_is_counted_from_there(tmp_path):
    make = CASES / "contact_found_off_zero_kept/make.py"
    subprocess.run([sys.executable, make], cwd=tmp_path, check=True)
    (test,) = read_vendor_file(tmp_path / "preload_zero.txt")
    assert test.recording.depth[0] == pytest.approx(0.0, abs=1.0)
    assert test.recording.depth.max() == pytest.approx(805.0, abs=2.0)
    assert any("counted from where the test begins" in said for said in test.warnings)


def test_the_mean_of_the_specimens_is_no_specimen():
    found = read_each(CASES / "average_sheet_of_testxpert/essai.xlsx", columns=TESTXPERT)
    left_out = {test.name for test in found if isinstance(test, Unreadable)}
    assert "Eprouvette moyenne" in left_out
    assert [test.name for test in found if test.name not in left_out] == ["A1 1", "A1 2", "A1 3"]
    assert not any("call of its own" in str(test.error) for test in found if isinstance(test, Unreadable))


def _replicates(rng, count):
    """Tests of one method whose stiffness and zero scatter by some per cent of the depth."""
    time = np.linspace(0.0, 60.0, 400)
    load = np.minimum(time, 60.0 - time) / 30.0
    factors, zeros = 1.0 + 0.01 * rng.standard_normal((2, count))
    return [
        VendorTest(f"test_{k}", Recording(time, zeros[k] * load, factors[k] * 500 * np.sqrt(load), f"test_{k}"))
        for k in range(count)
    ]


def test_the_mean_is_known_by_its_numbers_and_no_replicate_is_taken_for_it():
    rng = np.random.default_rng(3)
    for _ in range(20):
        tests = _replicates(rng, 16)
        assert [test.name for test in averages(tests) if test.uncounted] == []
        load, depth = (np.mean([getattr(test.recording, key) for test in tests], axis=0) for key in ("load", "depth"))
        mean = VendorTest("whole", Recording(tests[0].recording.time, load.round(4), depth.round(1), "whole"))
        assert [test.name for test in averages([*tests, mean]) if test.uncounted] == ["whole"]


def test_the_library_s_own_reason_is_told():
    pytest.importorskip("afmformats")
    with pytest.raises(InputError, match="constant-height-pause") as told:
        read_each(CASES / "jpk_pause_at_constant_height/relaxation.jpk-force")
    assert "as text" in told.value.remedy


def test_a_curve_saved_by_afmformats_as_tab_is_read_with_its_spring():
    pytest.importorskip("afmformats")
    (test,) = read_vendor_file(CASES / "afmformats_tab/curve.tab", contact="none")
    assert test.metadata["spring constant"] == "0.03"
    assert np.ptp(test.recording.load) < 1e-4


def test_a_test_of_kla_as_csv_is_read_as_its_sheet():
    (test,) = read_vendor_file(CASES / "kla_export_as_csv/Test 001.CSV")
    assert test.marked
    assert test.recording.load.max() == pytest.approx(45.0, abs=0.01)
    assert np.nanmax(test.recording.stiffness) == pytest.approx(0.186)
    stated = {name.split()[0]: value for name, value in test.metadata.items()}
    assert (stated["Modulus"], stated["Hardness"]) == ("70.6", "9.3")


def test_replicates_whose_contacts_disagree_are_told():
    time = np.arange(3.0)

    def found_at(depth, half, name):
        notes = (f"contact found by palpate: at {depth} nm (95 % interval)", f"contact_interval_nm: {-half} {half}")
        return Recording(time, time, 1000 * time, name, notes)

    alike = [found_at(10.0, 20.0, "P1_1"), found_at(5.0, 20.0, "P1_2"), found_at(12.0, 20.0, "P1_3")]
    assert list(disagreeing(alike)) == []
    (told,) = disagreeing([*alike, found_at(-461.0, 180.0, "P1_4")])
    assert told.startswith("P1_4.csv: contact was found at -461 (-641 to -281) nm of the file")
