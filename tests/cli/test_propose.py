"""`palpate propose`: the next test as a method and as a study that holds it, from saved results alone."""

import json

import numpy as np
import pytest
import results_of
import yaml
from study_file import STUDY, TRUTH

from indentation_files.recording import Recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.diagnosis.next_test import feasible
from palpate.study.indenter import Indenter

GAIN = {"expected_power": 0.83, "distance": 9.0, "separates": ["thermal_drift", "thermal_drift+friction"]}
LABORATORY = {"lab": {"parameters": TRUTH}}


def proposed(folder, monkeypatch, test, tip=None, laboratory=True, **more):
    """Write a study and a diagnosis that proposes a test, in `folder`, from which commands then run."""
    monkeypatch.chdir(folder)
    changes = {"recordings": {"lab": "results/s/recordings/lab"}, "laboratory": LABORATORY} if laboratory else {}
    values = STUDY | changes | ({"indenter": tip} if tip else {}) | more
    (folder / "study.yaml").write_text(yaml.safe_dump(values, sort_keys=False))
    name = next(iter(values["recordings"]))
    (folder / "results/s" / name).mkdir(parents=True)
    content = results_of.diagnosis("ambiguous", discriminating_test=test)
    (folder / "results/s" / name / "diagnosis.json").write_text(json.dumps(content))
    return folder / "results/s" / name / "next"


def every_test(tip):
    """Return each test that a diagnosis may propose, as it is saved, with its load history."""
    return [
        pytest.param({"test": test.phrase, **test.settings, **GAIN}, test, id=test.phrase)
        for test in feasible(1.0, 30.0, tip)
    ]


@pytest.mark.parametrize(("saved", "test"), every_test(Indenter("cone", 70.3)))
def test_the_study_holds_the_test_that_was_proposed(tmp_path, monkeypatch, capsys, saved, test):
    """Its condition has the load history with which the diagnosis simulated it, and the tip."""
    folder = proposed(tmp_path, monkeypatch, saved)
    assert main(["propose", "study.yaml"]) == 0
    study = load_study(folder / "study.yaml")
    condition = study.condition("next1")
    protocol = condition.protocol
    assert condition.role == "calibrate" and study.name == "s_next"
    time = np.linspace(0.0, protocol.knot_time[-1], 50)
    expected = np.interp(time, test.protocol.knot_time, test.protocol.knot_drive)
    np.testing.assert_allclose(np.interp(time, protocol.knot_time, protocol.knot_drive), expected, atol=1e-12)
    assert study.tip_of(condition) == (test.indenter or Indenter("cone", 70.3))
    assert study.indenter == Indenter("cone", 70.3)
    assert [each.name for each in study.conditions[:-1]] == ["P1_T30"]
    assert main(["check", str(folder / "study.yaml")]) == 0
    assert "probability of 83 %" in capsys.readouterr().out


def test_the_method_gives_what_a_laboratory_needs(tmp_path, monkeypatch, capsys):
    saved = {"test": "a hold", "max_load": 2.0, "loading_time": 30.0, "low_load": 0.2, "low_hold_time": 300.0, **GAIN}
    folder = proposed(tmp_path, monkeypatch, saved)
    main(["propose", "study.yaml"])
    text = (folder / "method.txt").read_text()
    assert text in capsys.readouterr().out
    assert "load: to 2 mN in 30 s; to 0.2 mN in 27 s; hold for 300 s; to 0 mN in 3 s" in text
    assert "tip: cone, half-angle 70.3°, the same as before" in text
    assert "separates: thermal drift | thermal drift with friction" in text
    assert "number: 3 tests" in text


def test_a_tip_that_the_study_has_is_named(tmp_path, monkeypatch, capsys):
    ball = {"name": "ball", "shape": "sphere", "radius": 1e4}
    entries = [*STUDY["conditions"], STUDY["conditions"][0] | {"name": "S1", "indenter": ball}]
    (*_, test) = feasible(1.0, 30.0, Indenter("cone", 70.3), {"ball": 2.0})
    saved = {"test": test.phrase, **test.settings, **GAIN, "tip": test.tip}
    folder = proposed(tmp_path, monkeypatch, saved, conditions=entries)
    assert main(["propose", "study.yaml"]) == 0
    assert "tip: ball, sphere, radius 10000 nm, as before" in capsys.readouterr().out
    study = load_study(folder / "study.yaml")
    assert study.condition("next1").tip == "ball"
    assert study.condition("next1").protocol.max_load == pytest.approx(6.0)


def trapezoid():
    return {"test": "faster", "max_load": 1.0, "loading_time": 9.0, "hold_time": 0.0, "unloading_time": 9.0, **GAIN}


def test_measured_recordings_stay_where_they_are_and_the_new_ones_join_them(tmp_path, monkeypatch, capsys):
    folder = proposed(tmp_path, monkeypatch, trapezoid(), laboratory=False, recordings={"real": "measured"})
    main(["propose", "study.yaml"])
    assert (
        "next1_1.csv, next1_2.csv, next1_3.csv with the header time_s,load_mN,depth_nm, in measured"
        in (folder / "method.txt").read_text()
    )
    (tmp_path / "measured").mkdir()
    for name, time in (("P1_T30", 30.0), ("next1", 9.0)):
        clock = np.linspace(0.0, 2.0 * time, 101)
        load = 1.0 - np.abs(clock / time - 1.0)
        Recording(clock, load, 400.0 * np.sqrt(load)).write(tmp_path / f"measured/{name}_1.csv")
    assert main(["check", str(folder / "study.yaml")]) == 0
    assert "1 of P1_T30, 1 of next1" in capsys.readouterr().out


def test_further_sets_of_conditions_take_the_test_in(tmp_path, monkeypatch):
    folder = proposed(tmp_path, monkeypatch, trapezoid(), condition_sets={"all": ["P1_T30"], "few": ["P1_T30"]})
    main(["propose", "study.yaml"])
    study = load_study(folder / "study.yaml")
    assert study.condition_sets == {"all": ("P1_T30", "next1"), "few": ("P1_T30",)}


def test_a_second_round_has_a_name_of_its_own(tmp_path, monkeypatch):
    again = STUDY["conditions"][0] | {"name": "next1"}
    folder = proposed(tmp_path, monkeypatch, trapezoid(), conditions=[*STUDY["conditions"], again])
    main(["propose", "study.yaml"])
    assert [each.name for each in load_study(folder / "study.yaml").conditions] == ["P1_T30", "next1", "next2"]


def test_where_nothing_is_open_one_line_says_so(tmp_path, monkeypatch, capsys):
    proposed(tmp_path, monkeypatch, None)
    assert main(["propose", "study.yaml"]) == 0
    assert capsys.readouterr().out == "no test is proposed: lab is ambiguous\n"


def test_what_is_missing_is_said_in_one_line(tmp_path, monkeypatch, refused):
    folder = proposed(tmp_path, monkeypatch, trapezoid())
    assert "'labb' is no set of recordings of s (did you mean 'lab'?)" in refused(
        "propose", "study.yaml", "--recordings", "labb"
    )
    (folder.parent / "diagnosis.json").unlink()
    line = refused("propose", "study.yaml")
    assert "results/s/lab/diagnosis.json: is missing; run the study with its diagnosis first" in line
    assert "'nothing' is no file, and results holds no study of that name" in refused("propose", "nothing")
