"""What files say of tip and sample goes into a draft, where they say it alike and it can be simulated."""

import math
from pathlib import Path

import numpy as np
import pytest
from public_files import XP, needs_recordings

from indentation_files.readers import read_vendor_file
from indentation_files.recording import Recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.draft.guess_table import evaluated
from palpate.draft.known_tip import KnownTip
from palpate.draft.remarks import not_taken
from palpate.draft.solid import Solid
from palpate.draft.stated import Stated, hardness, youngs_modulus

UP = np.linspace(0.0, 1.0, 50)
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


def anton_paar(area, depth):
    return {"Ap": f"{area:.2f} nm²", "hc": f"{depth:.2f} nm"}


def of_sphere(radius, depth):
    """Anton Paar's entries for a sphere, whose cap of this height has the area pi (2 R h - h^2) at its edge."""
    return anton_paar(math.pi * (2.0 * radius * depth - depth**2), depth)


def test_the_vendor_s_contact_area_tells_a_sphere_from_a_pyramid():
    spheres = [of_sphere(5e5, depth) for depth in (9e3, 12e3, 16e3)]
    tip = KnownTip.of(Stated.by_all(spheres), None, 2e4)
    assert (tip.keys["shape"], tip.keys["radius"]) == ("sphere", pytest.approx(5e5, rel=0.01))
    assert "contact area" in tip.why
    pyramid = [anton_paar(24.5 * depth**2 + 2000.0 * depth, depth) for depth in (900.0, 1500.0)]
    assert KnownTip.of(Stated.by_all(pyramid), None, 1800.0) == KnownTip()
    assert KnownTip.of(Stated.by_all([*spheres, of_sphere(1e5, 9e3)]), None, 2e4) == KnownTip()


def test_an_area_function_may_lack_its_first_term():
    """As one that was fitted to a sphere: A = 2 pi R h."""
    tip = KnownTip.of(Stated(area=(0.0, 2.0 * math.pi * 1e4)), None, 200.0)
    assert tip.keys["shape"] == "area_function"


def test_an_area_function_is_as_sharp_as_its_first_term():
    cube_corner = KnownTip({"shape": "cone", "half_angle": 42.28})
    tip = KnownTip.of(Stated(area=(math.pi * math.tan(math.radians(42.28)) ** 2, 100.0)), None, 500.0)
    assert tip.elastic_load(500.0, 0.3) == pytest.approx(cube_corner.elastic_load(500.0, 0.3))


def test_a_contact_area_of_another_tip_is_reported_where_it_is_not_taken():
    named = [("a", anton_paar(2.6 * 1000.0**2, 1000.0))]
    (remark,) = not_taken(named, Stated(poisson_ratio=0.3), KnownTip(), 1000.0, 0.3)
    assert "2.6 times the square of its depth" in remark
    assert not not_taken(
        [("a", anton_paar(24.6 * 1000.0**2, 1000.0))], Stated(poisson_ratio=0.3), KnownTip(), 1000.0, 0.3
    )


def test_the_ratio_that_optics11_writes_into_its_modulus_is_taken():
    metadata = {"E[eff] (Pa)": "23434.7", "E[v=0.400] (Pa)": "17576.0"}
    assert Stated.by_all([metadata]).poisson_ratio == 0.4
    assert youngs_modulus(metadata) == pytest.approx(17576e-9) and hardness(metadata) is None


def test_a_modulus_by_hertz_stands_in_for_that_by_unloading():
    assert youngs_modulus({"EHz": "755.57 kPa"}) == pytest.approx(755.57e-6)
    assert youngs_modulus({"EHz": "755.57 kPa", "EIT": "840.33 kPa"}) == pytest.approx(840.33e-6)


def test_a_plane_strain_modulus_is_shown_as_the_file_states_it():
    modulus, _ = evaluated(Solid(60.0, 70.0, 9.0), [{"EIT/(1-vs^2)": "78.7 GPa"}] * 2, 0.35)
    assert modulus.why == (
        "the files state 78.7 GPa (median of 2 tests) for E/(1 - nu^2), 69.06 GPa with a Poisson's ratio of 0.35"
    )


def test_what_unloading_gives_back_is_a_part_of_the_work_of_loading_and_hold():
    """By 100 nm in loading and in unloading at a constant rate, and by 50 nm in the hold between them at 1 mN."""
    load = np.concatenate([UP, np.ones(50), UP[::-1]])
    depth = np.concatenate([100.0 * UP, np.linspace(100.0, 150.0, 50), 150.0 - 100.0 * (1.0 - UP[::-1])])
    test = Recording(np.arange(len(load)), load, depth, "held")
    assert Solid.of([test], KnownTip({"shape": "cone", "half_angle": 70.3}), 0.3).returned == pytest.approx(
        0.5, abs=0.02
    )
