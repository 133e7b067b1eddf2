"""What readers take from public files against the results that the makers' own programs wrote into them."""

import numpy as np
import pytest
from public_files import RECORDINGS, needs_recordings
from python_calamine import load_workbook

from indentation_files.readers import read_vendor_file
from indentation_files.readers.numbers_in_text import number
from palpate.draft.stated import coefficients

DIAMOND_MODULUS, DIAMOND_RATIO = 1141.0, 0.07


@needs_recordings
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(
    "name",
    ["FS_XP", "FS_Calibration", "NiAl_250nm_TUIL_max_depth_1000nm_GM3_SM_previousGM1"],
    ids=lambda name: name[:6],
)
def test_xp_hardness_and_modulus_follow_from_load_depth_and_stiffness(name):
    """Oliver and Pharr (1992), at each point of loading beyond 500 nm.

    They take the file's area function, a diamond tip and epsilon = 0.75, and hold to the channels Hardness and Modulus.
    """
    file = RECORDINGS / f"micromechanics/{name}.xls"
    workbook = load_workbook(file)
    for test in read_vendor_file(file, contact="none"):
        head, _, *rows = workbook.get_sheet_by_name(test.name).to_python()
        cells = np.array(
            [[row[head.index(n)] or np.nan for n in ("Time On Sample", "Hardness", "Modulus")] for row in rows]
        )
        r, ratio = test.recording, float(test.metadata["Poissons Ratio"])
        _, hardness, modulus = cells[np.searchsorted(cells[:, 0], r.time)].T
        contact_depth = r.depth - 0.75 * r.load / r.stiffness
        area = sum(c * contact_depth ** (2 / 2**k) for k, c in enumerate(coefficients(test.metadata)))
        reduced = 1e6 * np.sqrt(np.pi) / 2 * r.stiffness / np.sqrt(area)
        own = (1 - ratio**2) / (1 / reduced - (1 - DIAMOND_RATIO**2) / DIAMOND_MODULUS)
        loading = (r.depth > 500) & (np.arange(len(r)) < np.argmax(r.load)) & (hardness < 1e3) & (modulus < 1e3)
        assert loading.sum() > 20
        assert 1e6 * (r.load / area)[loading] == pytest.approx(hardness[loading], rel=1e-3)
        assert own[loading] == pytest.approx(modulus[loading], rel=1e-3)


@needs_recordings
def test_fischer_s_largest_depth_is_the_one_stated():
    for test in read_vendor_file(RECORDINGS / "micromechanics/FS1.txt"):
        assert test.recording.load.max() == pytest.approx(300, rel=1e-3)
        assert test.recording.depth.max() == pytest.approx(1e3 * number(test.metadata["hmax [µm]"]), rel=3e-3)


@needs_recordings
def test_kla_s_largest_load_is_the_one_stated():
    """The file's ``Pmax`` is 0.8 % below the load that it asked for, which the channel reaches."""
    tests = read_vendor_file(RECORDINGS / "micromechanics_indentationGUI/FusedSilica.xlsx")
    for test in tests:
        assert test.recording.load.max() == pytest.approx(float(test.metadata["Target Load [mN]"]), rel=1e-3)
        assert test.recording.load.max() == pytest.approx(float(test.metadata["Pmax [mN]"]), rel=0.01)


@needs_recordings
def test_the_load_of_a_jpk_curve_rises_to_its_setpoint():
    pytest.importorskip("afmformats")
    (test,) = read_vendor_file(RECORDINGS / "afmformats/force-save-example.jpk-force", contact="none")
    load = test.recording.load
    assert load.max() - np.median(load[:800]) == pytest.approx(1e3 * float(test.metadata["setpoint"]), rel=0.01)
    assert test.recording.time[-1] == pytest.approx(float(test.metadata["duration"]), abs=1e-3)
