"""A first study from recordings: tests of one load history belong together, and the ranges hold what was pressed."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from elastic_tests import MODULUS, elastic
from law_examples import ALONE

from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.draft import first_study
from palpate.draft.grouping import grouped
from palpate.draft.guesses import ranges
from palpate.draft.known_tip import KnownTip
from palpate.draft.law_choice import chosen_law, family_of
from palpate.draft.prescribed_drive import Drive
from palpate.draft.solid import Solid
from palpate.errors import InputError
from palpate.materials import LAWS
from palpate.solver.simulation import simulate
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specification import Specification

CONE = Indenter("cone", half_angle=70.3)


def test_tests_of_one_load_history_are_one_condition():
    tests = [elastic(4.0, 20), elastic(1.0, 20, noise=2e-3), elastic(4.05, 20), elastic(1.0, 60), elastic(1.0, 20, 30)]
    groups = grouped(tests, Drive())
    assert [(group.name, len(group.recordings)) for group in groups] == [
        ("P1_T20", 1), ("P1_T20b", 1), ("P1_T60", 1), ("P4_T20", 2),
    ]  # fmt: skip
    assert [group.history["hold_time"] for group in groups[:2]] == [0.0, 30.0]
    assert groups[2].history == {"max_load": 1.0, "loading_time": 60.0, "hold_time": 0.0, "unloading_time": 60.0}


def test_the_order_of_the_tests_does_not_matter():
    tests = [elastic(1.0, 20), elastic(1.0, 20, 30), elastic(1.01, 20)]
    sizes = [sorted(len(group.recordings) for group in grouped(order, Drive())) for order in (tests, tests[::-1])]
    assert sizes == [[1, 2], [1, 2]]


def test_no_two_conditions_have_one_name():
    holds = [elastic(1.0, 20, 10.0 * k) for k in range(30)]
    names = [group.name for group in grouped(holds, Drive())]
    assert len(names) == len(set(names)) == 30
    assert names[:2] == ["P1_T20", "P1_T20b"]


def test_what_is_no_trapezoid_follows_its_recording():
    time = np.linspace(0.0, 40.0, 400)
    curved = replace(elastic(1.0, 20), time=time, load=np.sin(np.pi * time / 40.0) ** 2, depth=time)
    assert grouped([curved], Drive())[0].history == {"load_history": "recorded"}


def test_a_test_that_was_cut_short_while_it_was_unloaded_follows_its_recording():
    whole = elastic(1.0, 20)
    short, nearly = (whole.at(whole.time < end) for end in (34.0, 39.5))
    assert "load_history" not in grouped([nearly], Drive())[0].history
    assert [group.history.get("load_history") for group in grouped([short, whole], Drive())] == ["recorded", None]


def test_the_ranges_hold_what_was_pressed():
    """Sneddon's solid is elastic: its depth tells the modulus, and unloading but for the factors beta and epsilon."""
    solid = Solid.of([elastic(1.0, 20), elastic(4.0, 20)], KnownTip(), 0.35)
    assert solid.secant == pytest.approx(MODULUS, rel=1e-6)
    assert solid.modulus == pytest.approx(MODULUS, rel=0.1)
    for law in ALONE:
        low, high = ranges(law, solid, 20.0)["youngs_modulus"].values
        assert low < MODULUS < high
        needed = {p.name for p in LAWS[law].declared({}) if p.default is None}
        assert needed <= {*ranges(law, solid, 20.0), "poisson_ratio"}


def test_the_ranges_hold_an_epoxy_that_creeps_while_it_is_unloaded():
    """The solid of the default study: without a hold its unloadings say three times its modulus."""
    truth = {
        "youngs_modulus": 3.28, "steady_coefficient": 0.09, "steady_exponent": 0.2, "transient_coefficient": 0.24,
        "transient_exponent": 0.47, "retardation_time": 0.25,
    }  # fmt: skip
    pressed = simulate(
        Specification(
            "nonlinear_burgers", truth | {"poisson_ratio": 0.34}, CONE, trapezoid(1, 20, 0, 20), kinematics="small"
        )
    )
    solid = Solid.of([Recording(pressed.time, pressed.load, pressed.depth)], KnownTip(), 0.35)
    found = ranges("nonlinear_burgers", solid, 20.0).items()
    guessed = {name: values for name, (values, _) in found if len(values) > 1}
    assert guessed.keys() == truth.keys()
    for name, (low, high) in guessed.items():
        assert low < truth[name] < high, name


def test_a_draft_is_a_study_that_passes_its_check(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for load in (1.0, 2.0, 4.0):
        for site in (1, 2):
            elastic(load * (1 + 1e-3 * site), 20).write(tmp_path / f"day 1, {load} mN, site {site}.csv")
    files = sorted(str(file) for file in tmp_path.glob("*.csv"))
    assert main(["draft", *files, files[0], "-o", "my study", "--law", "elastic"]) == 0
    told = capsys.readouterr()
    assert "2 of P1_T20, 2 of P2_T20, 2 of P4_T20" in told.out
    assert f"the same recording as {files[0]}, day 1, 1.0 mN, site 1; left out" in told.err
    study = load_study("my study/study.yaml")
    assert study.name == "my_study"
    roles = {condition.name: condition.role for condition in study.conditions}
    assert roles == {"P1_T20": "calibrate", "P2_T20": "validate", "P4_T20": "calibrate"}
    assert sorted(file.name for file in (tmp_path / "my study/recordings").iterdir()) == [
        f"P{load}_T20_{site}.csv" for load in (1, 2, 4) for site in (1, 2)
    ]
    assert yaml.safe_load((tmp_path / "my study/study.yaml").read_text())["recordings"] == {
        "lab": "my study/recordings"
    }


def test_a_stiffness_by_oscillation_lies_beside_a_draft_and_is_drafted_again(tmp_path, monkeypatch, capsys):
    """Recordings have three columns; a draft of them has the stiffness again, and none is left if it fails."""
    monkeypatch.chdir(tmp_path)
    test = elastic(1.0, 20)
    stiffness = np.where(test.load > 0.1, 0.01 * np.sqrt(test.load), np.nan)
    replace(test, stiffness=stiffness).write(tmp_path / "test.csv")
    for given, output in (("test.csv", "first"), ("first/recordings", "second")):
        assert main(["draft", given, "-o", output, "--law", "elastic"]) == 0
        assert "left out" not in capsys.readouterr().err
        written = tmp_path / output / "recordings" / "P1_T20_1.csv"
        assert "\ntime_s,load_mN,depth_nm\n" in "\n" + written.read_text()
        assert read_recording(written).stiffness == pytest.approx(stiffness, rel=1e-6, nan_ok=True)

    def unsound(study):
        raise InputError("is not sound", remedy="mend it")

    monkeypatch.setattr(first_study, "check_given", unsound)
    assert main(["draft", "test.csv", "-o", "third", "--law", "elastic"]) == 2
    assert not (tmp_path / "third").exists()


def test_what_is_no_polymer_is_drafted_as_a_metal_under_diamond(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    metal = elastic(1.0, 20)
    replace(metal, depth=0.2 * metal.depth).write(tmp_path / "metal.csv")
    assert main(["draft", "metal.csv", "-o", "out"]) == 0
    study = load_study("out/study.yaml")
    assert study.model == "bilinear_plasticity"
    assert (study.indenter.modulus, study.indenter.poisson_ratio) == (1141.0, 0.07)
    low, high = study.levels["youngs_modulus"]
    assert low < 25 * MODULUS < high
    assert main(["draft", "metal.csv", "-o", "open", "--law", "auto"]) == 0
    study = load_study("open/study.yaml")
    assert study.family == "glass" and study.law_is_open  # as hard for its modulus as no metal is
    assert main(["draft", "metal.csv", "-o", "asked", "--law", "nonlinear_burgers"]) == 0
    assert "no polymer's; --law bilinear_plasticity" in capsys.readouterr().err


@pytest.mark.parametrize("law", sorted(ALONE))
@pytest.mark.parametrize("ratio", [1.0, 3.0, 8.0])
def test_the_range_of_any_law_holds_the_modulus_of_a_stiff_solid(law, ratio):
    """Tungsten: unloading tells 411 GPa, while its plastic indent is as deep as an elastic body's of much less."""
    if law == "elastic":
        pytest.skip("a solid that yields is no elastic one")
    low, high = ranges(law, Solid(411.0 / ratio, 411.0, 5.0), 20.0)["youngs_modulus"].values
    assert low < 411.0 < high


def test_a_test_without_unloading_is_drafted_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    test = elastic(1.0, 20)
    test.at(slice(0, 150)).write(tmp_path / "loading.csv")
    assert main(["draft", "loading.csv", "-o", "out", "--law", "bilinear_plasticity"]) == 0
    low, high = load_study("out/study.yaml").levels["youngs_modulus"]
    assert low < MODULUS < high


def test_the_family_follows_from_stiffness_hardness_and_loss():
    families = {
        "polymer": Solid(1.4, 2.5, 0.13, 0.06, 0.25),
        "metal": Solid(40.0, 200.0, 4.0, 0.001, 0.1),
        "glass": Solid(50.0, 72.0, 9.0, 0.001, 0.6),
        "gel": Solid(1e-5, 1e-5, 1e-6, 0.05, 0.8),
        "": Solid(1.4, math.nan, math.nan, 0.06),  # nothing is unloaded
    }
    assert {family: family_of(solid) for family, solid in families.items()} == {family: family for family in families}


def test_what_gives_all_work_back_is_elastic():
    assert chosen_law(Solid.of([elastic(1.0, 20)], KnownTip(), 0.35))[0] == "elastic"
    assert chosen_law(Solid(1.4, 2.5, 0.13, 0.06, 0.25))[0] == "nonlinear_burgers"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.csv", "-o", "out"], "missing.csv: cannot be read"),
        (["good.csv", "-o", "standing"], "standing/study.yaml: exists already"),
        (["good.csv", "-o", "out", "--sphere", "-5"], "--sphere"),
        (["good.csv", "-o", "out", "--sphere", "inf"], "--sphere"),
        (["short.csv", "-o", "out"], "short.csv, short, time_s: only 5 points follow contact"),
        (["unloaded.csv", "-o", "out"], "unloaded.csv, unloaded: the load is 0 mN at all 401 points"),
        (["pulled.csv", "-o", "out"], "pulled.csv, pulled, load_mN: the load never rises above zero"),
    ],
)
def test_what_cannot_be_drafted_is_told_in_one_line(tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "standing").mkdir()
    (tmp_path / "standing/study.yaml").write_text("precious")
    test = elastic(1.0, 20)
    test.write(tmp_path / "good.csv")
    replace(test, load=0.0 * test.load).write(tmp_path / "unloaded.csv")
    replace(test, load=test.load - 3.0).write(tmp_path / "pulled.csv")
    test.at(slice(0, None, 90)).write(tmp_path / "short.csv")
    try:
        code = main(["draft", *arguments])
    except SystemExit as leaving:
        code = leaving.code
    lines = capsys.readouterr().err.splitlines()
    assert code == 2
    assert len(lines) == 1 and words in lines[0], lines
    assert (tmp_path / "standing/study.yaml").read_text() == "precious"
    assert not (tmp_path / "out").exists()
