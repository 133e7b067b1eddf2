"""Optics11: depth before contact too, contact where the instrument found it, load from there."""

import numpy as np
import pytest

from indentation_files.readers import read_vendor_file
from palpate.errors import InputError

STIFFNESS = 0.34  # N/m, which is nN/nm
TIME = np.arange(0, 6, 0.01)
PIEZO = np.interp(TIME, [0, 0.5, 2.5, 3.5, 5.5], [0, 0, 10000, 10000, 0])
CONTACT, LEVEL = 6118.15, -60.3
BEYOND = np.clip(PIEZO - CONTACT, 0, None)
BENT = 0.3 * BEYOND  # a body that takes 0.7 of what the piezo moves on
HEAD = [
    "Date\t08/06/2021\tTime\t15:42:17\tStatus\tOK", "k (N/m)\t0.340", "", "Device:\tChiaro",
    "Control mode: Displacement", "D[Z1] (nm)\t0.000\tt[1] (s)\t0.500", "Comment: ", "",
]  # fmt: skip


NAMES = ["Time (s)", "Load (uN)", "Indentation (nm)", "Cantilever (nm)", "Piezo (nm)", "Auxiliary"]
NOISE = 0.3 * np.random.default_rng(0).standard_normal(len(TIME))

FROM_FIRST = PIEZO - BENT + 1e-3 * TIME  # zero at the first point alone


def export(tmp_path, indentation=BEYOND - BENT, auxiliary=True, comma=False, names=NAMES, noise=0 * TIME):
    cantilever = BENT + LEVEL + noise
    values = np.column_stack([TIME, STIFFNESS * cantilever / 1e3, indentation, cantilever, PIEZO, 0 * TIME])
    rows = ["\t".join(f"{x:.6f}" for x in row[: 5 + auxiliary]) for row in values]
    body = "\n".join(rows).replace(".", "," if comma else ".")
    file = tmp_path / "S-1 X-1 Y-1 I-1.txt"
    file.write_text("\r\n".join([*HEAD, "\t".join(names[: 5 + auxiliary]), body, ""]))
    return file


@pytest.mark.parametrize(("auxiliary", "comma"), [(True, False), (False, False), (True, True)])
def test_depth_is_piezo_less_cantilever_and_zero_where_the_instrument_found_contact(tmp_path, auxiliary, comma):
    (test,) = read_vendor_file(export(tmp_path, auxiliary=auxiliary, comma=comma), contact="none")
    r = test.recording
    touched = 0.5 + 2 * CONTACT / 10000
    assert r.time[0] == pytest.approx(-touched, abs=0.01)
    assert r.depth == pytest.approx(PIEZO - BENT - CONTACT, abs=1e-3)
    assert r.load == pytest.approx(1e-6 * STIFFNESS * BENT, abs=1e-9)
    assert test.metadata["k (N/m)"] == "0.340"
    assert test.metadata["Device"] == "Chiaro"
    assert test.metadata["t[1] (s)"] == "0.500"


def test_the_recording_begins_at_contact(tmp_path):
    (test,) = read_vendor_file(export(tmp_path))
    assert test.recording.depth[0] == pytest.approx(0, abs=50)  # the piezo moves 50 nm from point to point
    assert test.recording.depth.max() == pytest.approx(0.7 * (10000 - CONTACT), abs=1e-3)


@pytest.mark.parametrize("indentation", [0 * TIME, PIEZO - BENT + 74, PIEZO - BENT - NOISE, FROM_FIRST])
def test_without_contact_of_the_instrument_the_load_tells_it(tmp_path, indentation):
    """The column is zero throughout, counted from elsewhere, or from the file's first point, noisy or not."""
    (test,) = read_vendor_file(export(tmp_path, indentation, noise=NOISE * bool(indentation.any())))
    assert test.warnings[0].startswith("the file marks no contact, the load does not rise over the first 69 %")
    assert test.recording.depth.max() == pytest.approx(0.7 * (10000 - CONTACT), abs=60)


def test_an_indentation_that_is_negative_in_air_marks_contact_too(tmp_path):
    (test,) = read_vendor_file(export(tmp_path, PIEZO - BENT - CONTACT))
    assert test.marked
    assert test.recording.depth.max() == pytest.approx(0.7 * (10000 - CONTACT), abs=1e-3)


@pytest.mark.parametrize(("case", "brackets"), [(str.upper, "()"), (str.capitalize, "[]"), (str.lower, "()")])
def test_headings_in_other_capitals_and_brackets(tmp_path, case, brackets):
    names = [f"{case(word)} {brackets[0]}{unit}" for word, unit in (name.split(" (") for name in NAMES[:-1])]
    file = export(tmp_path, names=[*(name.replace(")", brackets[1]) for name in names), "Auxiliary"])
    assert read_vendor_file(file)[0].recording.depth.max() == pytest.approx(0.7 * (10000 - CONTACT), abs=1e-3)


def test_the_vendors_channels_are_final(tmp_path):
    with pytest.raises(InputError, match="final channels only"):
        read_vendor_file(export(tmp_path), corrections=frozenset())


def test_a_file_that_ends_before_the_retreat_is_told_to_be_cut_off(tmp_path):
    file = export(tmp_path)
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:300]))
    (test,) = read_vendor_file(file)
    assert test.warnings[0].startswith("ends under")
    assert test.warnings[0].endswith("not unloaded; the file may be cut off")
    (said,) = read_vendor_file(export(tmp_path))[0].warnings
    assert said.startswith("ends at 2.56 s, where the tip has left")
