"""Files that mislead: each kind is read right, or told in one line; the inputs lie beside the repository."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from indentation_files.contact_interval import disagreeing, interval_of
from indentation_files.readers import ColumnMap, Unreadable, VendorTest, read_each, read_vendor_file
from indentation_files.readers.tagged import AVERAGED, averages
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


@pytest.mark.parametrize(
    "name", ["Provino medio", "Media de probetas", "Mittlere Kurve", "Courbe moyenne", "Mean curve (n=3)"]
)
def test_the_mean_is_known_by_its_name(name):
    assert AVERAGED.fullmatch(name)


@pytest.mark.parametrize("controlled", ["load", "depth"])
def test_the_mean_of_tests_under_one_program_is_known_to_the_last_digit(controlled):
    rng = np.random.default_rng(8)
    time = np.arange(0.0, 60.0, 0.2)
    program = np.minimum(time, 60.0 - time) / 30.0
    for _ in range(10):
        alike = program.round(5) + np.zeros((5, 1))
        other = (1 + 0.02 * rng.standard_normal((5, 1))) * program**2 + 1e-3 * rng.standard_normal((5, 300))
        load, depth = (alike, (500.0 * other).round(2)) if controlled == "load" else (other.round(5), 500.0 * alike)
        tests = [VendorTest(f"T{k}", Recording(time, load[k], depth[k], f"T{k}")) for k in range(5)]
        assert [test.name for test in averages(tests) if test.uncounted] == []
        mean = Recording(time, load.mean(axis=0).round(5), depth.mean(axis=0).round(2), "whole")
        assert [test.name for test in averages([*tests, VendorTest("whole", mean)]) if test.uncounted] == ["whole"]


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


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_test_of_kla_as_csv_is_read_as_its_sheet(tmp_path, separator):
    text = (CASES / "kla_export_as_csv/Test 001.CSV").read_text(encoding="latin1")
    if separator != ",":
        text = text.replace(",", separator).replace(".", ",")
    (tmp_path / "Test 001.CSV").write_text(text, encoding="latin1")
    (test,) = read_vendor_file(tmp_path / "Test 001.CSV")
    assert test.marked
    assert test.recording.load.max() == pytest.approx(45.0, abs=0.01)
    assert np.nanmax(test.recording.stiffness) == pytest.approx(0.186)
    stated = {name.split()[0]: value for name, value in test.metadata.items()}
    assert (stated["Modulus"], stated["Hardness"]) == ("70.6", "9.3")


def _written(path, heading, *columns):
    rows = ("\t".join(f"{value:.7g}" for value in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([heading, *rows]), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("thickness", "stiffness", "approach", "size"), [(0.6, 0.02, 0.5, 300), (0.3, 0.05, 0.4, 400), (0.5, 0.1, 0.2, 130)]
)
def test_contact_under_a_soft_layer_is_never_surely_wrong(tmp_path, thickness, stiffness, approach, size):
    """Its load stays below 4 % of the largest, or rises from the air by hardly more than the noise."""
    way = np.r_[np.linspace(-approach, 1.0, size), np.linspace(1.0, 0.5, size // 3)]
    load = np.clip((way - thickness) / (1 - thickness), 0.0, None) ** 2 + stiffness * np.clip(way, 0.0, None) ** 1.5
    load[size:] = load[size - 1] * np.linspace(1.0, 0.0, size // 3)
    load += 6e-4 * np.random.default_rng(size).standard_normal(len(load))
    time = 0.1 * np.arange(len(way))
    file = _written(
        tmp_path / "tissue.txt", "Time (s)\tForce (N)\tTravel (mm)", time, 40.0 * load, 9.0 * (way + approach)
    )
    (test,) = read_vendor_file(file, columns=NUMBERED)
    lower, upper = interval_of(test.recording)
    assert lower <= test.recording.depth.max() - 9.0e6 <= upper, "the contact found less the true one"
    assert any("is known to" in said for said in test.warnings)


@pytest.mark.parametrize(("rest", "told"), [(-0.03, True), (-0.002, False), (0.03, False)])
def test_a_load_that_is_negative_by_little_is_told(tmp_path, rest, told):
    load = np.r_[np.linspace(0.0, 1.0, 300), np.linspace(1.0, 0.0, 100)]
    noisy = load + rest + 1e-3 * np.random.default_rng(1).standard_normal(400)
    file = _written(tmp_path / "a.txt", "t (s)\tP (mN)\th (nm)", 0.1 * np.arange(400), 10.0 * noisy, 500.0 * load**0.5)
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert any("begins under" in said for said in test.warnings) == told
    assert test.recording.time[-1] > 39.0


def test_a_tip_that_retreats_from_a_large_preload_is_seen(tmp_path):
    rng = np.random.default_rng(5)
    up = np.linspace(0.0, 150.0, 1500)
    away = np.linspace(0.0, -900.0, 300)
    depth = np.r_[away, away[::-1] - 90.0, 3.2 * up**0.7 * 10.0 - 90.0] + 0.15 * rng.standard_normal(2100)
    load = np.r_[np.where(away > -90.0, 8.0 + away / 11.25, 0.0), np.zeros(300), up] + 0.04 * rng.standard_normal(2100)
    file = _written(tmp_path / "a.txt", "t (s)\tP (mN)\th (nm)", 0.01 * np.arange(2100), load, depth)
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.recording.depth.max() == pytest.approx(32.0 * 150.0**0.7, rel=0.01)
    assert any("the tip retreats by" in said for said in test.warnings)


def test_replicates_whose_contacts_disagree_are_told():
    time = np.arange(3.0)

    def found_at(depth, half, name):
        notes = (f"contact found by palpate: at {depth} nm (95 % interval)", f"contact_interval_nm: {-half} {half}")
        return Recording(time, time, 1000 * time, name, notes)

    alike = [found_at(10.0, 20.0, "P1_1"), found_at(5.0, 20.0, "P1_2"), found_at(12.0, 20.0, "P1_3")]
    assert list(disagreeing(alike)) == []
    (told,) = disagreeing([*alike, found_at(-461.0, 180.0, "P1_4")])
    assert told.startswith("P1_4.csv: contact was found at -461 (-641 to -281) nm of the file")
