"""What files say of tip and sample goes into a draft, where they say it alike and it can be simulated."""

from pathlib import Path

import pytest
from test_readers import XP, needs_recordings

from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.draft.known_tip import KnownTip
from palpate.draft.solid import Solid
from palpate.draft.stated import Stated
from palpate.recordings.readers import read_vendor_file

ROUNDED = {"Area Coefficient 1": "24.6954", "Area Coefficient 2": "395.770081", "Area Coefficient 3": "-16.1315828"}


@pytest.mark.parametrize(
    ("metadata", "area", "poisson_ratio"),
    [
        ([ROUNDED | {"Poissons Ratio": "0.18"}] * 2, (24.6954, 395.770081, -16.1315828), 0.18),
        ([ROUNDED, ROUNDED | {"Area Coefficient 2": "400"}], (), None),
        ([{"Tip C0": "24.5 nm^2/nm^2", "Tip C1": "800 nm^2/nm", "Tip C2": "0 nm^2/nm^0.5"}], (24.5, 800.0), None),
        ([{"Tip C0": "24.5 nm^2/nm^2", "Tip C1": "0 nm^2/nm"}], (), None),
        ([{"Tip C0": "24.5 nm^2/nm^2", "Tip C1": "-329697 nm^2/nm"}], (), None),
        ([{"Poisson's Ratio of Sample [None]": "0,188"}], (), 0.188),
        ([{"Poissons Ratio": "0.5"}], (), None),
        ([{"Poissons Ratio": ""}, {}], (), None),
    ],
    ids=["xp", "tips differ", "hysitron", "ideal tip", "no tip", "decimal comma", "incompressible", "empty"],
)
def test_what_all_tests_state_alike_is_taken(metadata, area, poisson_ratio):
    assert Stated.by_all(metadata) == Stated(area, poisson_ratio)


@needs_recordings
def test_a_draft_takes_the_tip_and_poisson_s_ratio_of_its_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["draft", str(XP), "--law", "bilinear_plasticity", "-o", "silica"]) == 0
    study = load_study("silica/study.yaml")
    assert study.indenter.area == (24.6954, 395.770081, -16.1315828)
    assert study.fixed["poisson_ratio"] == 0.18
    text = Path("silica/study.yaml").read_text()
    assert text.count("as the files state") == 2
    assert main(["draft", str(XP), "--law", "bilinear_plasticity", "--sphere", "5000", "-o", "ball"]) == 0
    assert load_study("ball/study.yaml").indenter.radius == 5000.0


@needs_recordings
def test_the_stated_tip_brings_unloading_near_the_modulus_of_fused_silica():
    """72 GPa; the ideal Berkovich tip takes a smaller contact for the same stiffness and says more."""
    tests = read_vendor_file(XP)
    recordings = [test.recording.from_contact() for test in tests]
    stated = Stated.by_all([test.metadata for test in tests])
    with_tip, ideal = (Solid.of(recordings, tip, 0.18) for tip in (KnownTip.of(stated, None, 1000.0), KnownTip()))
    assert with_tip.modulus == pytest.approx(72.0, rel=0.05)
    assert ideal.modulus > with_tip.modulus
