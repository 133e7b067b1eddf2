"""The blind trial: what is sealed, what the laboratory writes, and how answers are scored."""

import hashlib
import json
import math
import re
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from indentation_files.recording_file import read_recording
from palpate.configuration.study_file import load_study
from palpate.mechanisms import MECHANISMS
from palpate.study.protocol import trapezoid
from studies.blind_trial import score
from studies.blind_trial.cases import draw, seal
from studies.blind_trial.laboratory import background, first_order, write
from studies.blind_trial.trial import diagnose_case, score_case, strength
from studies.blind_trial.unknown import UNKNOWN, Curve

STUDIES = Path(score.__file__).parent
STUDY = {
    "study": "trial",
    "points": 12,
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34, "transient_exponent": 0.4},
    "parameters": {
        "youngs_modulus": [3.0, 3.5],
        "steady_coefficient": [0.05, 0.1],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.24],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "T010", "max_load": 1.0, "loading_time": 10, "unloading_time": 10}],
    "challenge": {"seed": 5, "none": 3, "one": 24, "two": 4, "unknown": 5, "accuracy": "standard"},
}


@pytest.fixture
def study(tmp_path):
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    return load_study(tmp_path / "study.yaml")


def test_cases_are_neutral_and_repeatable(study):
    cases = draw(study)
    assert Counter(case.kind for case in cases) == {"none": 3, "one": 24, "two": 4, "unknown": 5}
    assert [case.name for case in cases] == [f"case_{k:03d}" for k in range(36)]
    assert cases == draw(study)
    assert [case.kind for case in cases] != sorted(case.kind for case in cases)
    hidden = {key for case in cases for key in case.mechanisms}
    every = {key for key, mechanism in MECHANISMS.items() if mechanism.by_default}
    assert hidden == every, "every mechanism is concealed at least once"
    for case in cases:
        for key, values in case.mechanisms.items():
            MECHANISMS[key].check(values)


def test_the_seal_is_the_checksum_of_the_truth(study, tmp_path):
    checksum = seal(draw(study), tmp_path / "sealed.json")
    assert checksum == hashlib.sha256((tmp_path / "sealed.json").read_bytes()).hexdigest()
    assert len(json.loads((tmp_path / "sealed.json").read_text())) == 36


def test_recordings_tell_nothing_but_the_curve(study, tmp_path):
    case = next(case for case in draw(study) if "thermal_drift" in case.mechanisms and case.kind == "one")
    write(study, [case], tmp_path)
    folder = tmp_path / case.name
    assert sorted(file.name for file in folder.iterdir()) == ["T010_1.csv", "T010_2.csv", "T010_3.csv"]
    text = (folder / "T010_1.csv").read_text()
    assert "SYNTHETIC" in text
    assert "drift" not in text
    assert len(read_recording(folder / "T010_1.csv")) == 12


def test_company_changes_no_recording(study, tmp_path):
    """Cases are simulated together for speed; what each holds is its own."""
    cases = [case for case in draw(study) if case.kind != "two"][:3]
    write(study, cases, tmp_path / "together")
    for case in cases:
        write(study, [case], tmp_path / "alone")
        together, alone = (read_recording(tmp_path / w / case.name / "T010_2.csv") for w in ("together", "alone"))
        assert together.depth == pytest.approx(alone.depth, abs=1e-6)


def test_noise_has_the_strength_and_memory_asked_for():
    rng = np.random.default_rng(0)
    noise = first_order(20000, 0.8, rng)
    assert noise.std() == pytest.approx(1.0, rel=0.05)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.8, abs=0.02)
    time = np.linspace(1, 100, 100)
    ends = [background(time, 0.01, 1e9, rng)[-1] for _ in range(2000)]
    assert np.std(ends) == pytest.approx(0.01 * 100, rel=0.1)


@pytest.mark.parametrize("key", UNKNOWN)
def test_unknown_effects_vanish_with_their_strength(key):
    protocol = trapezoid(1.0, 10, 10, 10, points=60)
    time, load = protocol.sample_time, protocol.sample_load
    test = Curve(time, load, 400 * np.sqrt(load + 0.2), protocol)
    changed = [UNKNOWN[key](test, s, np.random.default_rng(1)) - test.depth for s in (0.0, 0.5, 1.0)]
    assert changed[0] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(changed[2]).max() > np.abs(changed[1]).max() > 1.0


OPENED = []


@pytest.fixture
def trial(tmp_path):
    """Write a trial whose diagnosis is quick: one material parameter, and mechanisms that need no simulations."""
    levels = {name: values[:1] for name, values in STUDY["parameters"].items()} | {"youngs_modulus": [3.0, 3.3, 3.6]}
    small = STUDY | {"parameters": levels, "diagnosis": {"mechanisms": ["thermal_drift", "frame_compliance"]}}
    (tmp_path / "small.yaml").write_text(yaml.safe_dump(small))
    study = load_study(tmp_path / "small.yaml")
    cases = draw(study)
    seal(cases, tmp_path / "sealed.json")
    case = next(case for case in cases if "thermal_drift" in case.mechanisms)
    write(study, [case], tmp_path / "recordings")
    return study, case, tmp_path


def test_the_diagnosis_never_opens_the_seal(trial):
    """Every file that Python opens is noted; what is in the seal would end whatever reads it in another way."""
    study, case, folder = trial
    (folder / "sealed.json").write_text("{")
    sys.addaudithook(lambda event, details: OPENED.append(str(details[0])) if event == "open" else None)
    diagnose_case(study, folder / "recordings" / case.name, lambda line: None)
    opened = list(OPENED)
    assert any(file.endswith("_1.csv") for file in opened), "the hook works"
    assert not [file for file in opened if "sealed" in file]


def test_an_effect_is_as_strong_as_it_is_large(trial):
    """A drift adds in proportion to its rate; where nothing is concealed, nothing has a strength."""
    study, case, folder = trial
    recordings = folder / "recordings" / case.name
    slow, fast = (
        strength(study, replace(case, mechanisms={"thermal_drift": {"rate": rate}}), recordings) for rate in (0.1, 0.3)
    )
    assert slow > 0.0
    assert fast == pytest.approx(3.0 * slow)
    assert math.isnan(strength(study, replace(case, mechanisms={}), recordings))


def test_a_case_is_scored_by_its_diagnosis_and_its_strength(trial):
    study, case, folder = trial
    recordings = folder / "recordings" / case.name
    told, _ = diagnose_case(study, recordings, lambda line: None)
    (folder / "diagnosis.json").write_text(json.dumps(told))
    scored = score_case(study, case, folder / "diagnosis.json", recordings)
    assert scored["truth"] == "+".join(sorted(case.mechanisms))
    assert scored["verdict"] == told["verdict"]
    assert scored["strength"] == pytest.approx(strength(study, case, recordings))


def answer(verdict, candidates=(), truth=("friction",), kind="one"):
    listed = [
        {"mechanisms": list(names), "probability": p, "parameters": {f"{names[0]}.coefficient": interval}}
        for names, p, interval in candidates
    ]
    diagnosis = {
        "verdict": verdict,
        "mechanisms": listed[0]["mechanisms"] if verdict == "identified" else [],
        "candidates": listed,
        "fit": {"validate": {"before_rmse_nm": 9.0, "after_rmse_nm": 1.1}, "noise_nm": 1.0},
        "parameters": {"after": {"youngs_modulus": {"lower": 3.0, "upper": 3.4}}},
        "p_value": 0.001,
    }
    mechanisms = {key: {"coefficient": 0.2} for key in truth}
    case = {"name": "c", "kind": kind, "mechanisms": mechanisms, "unknown": {}, "parameters": {"youngs_modulus": 3.2}}
    return score.row(case, diagnosis, 5.0)


def test_the_rule_tells_right_from_wrong():
    interval = {"lower": 0.1, "upper": 0.3}
    right = answer("identified", [(("friction",), 0.99, interval)])
    wrong = answer("identified", [(("adhesion",), 0.99, interval)])
    either = answer("ambiguous", [(("adhesion",), 0.6, interval), (("friction",), 0.4, interval)])
    silent = answer("adequate", truth=(), kind="none")
    claimed = answer("identified", [(("friction",), 0.9, interval)], truth=(), kind="none")
    assert (right["exact"], right["covered"], right["wrong_name"]) == (True, True, False)
    assert (right["amplitudes_held"], right["amplitudes"], right["material_held"]) == (1, 1, 1)
    assert (wrong["exact"], wrong["covered"], wrong["wrong_name"]) == (False, False, True)
    assert (either["exact"], either["covered"], either["wrong_name"]) == (False, True, False)
    assert (silent["claims"], claimed["claims"]) == (False, True)
    table = score.summary(pd.DataFrame([right, wrong, either, silent, claimed])).set_index("figure")
    assert table.loc["claims on null cases", "count"] == 1
    assert table.loc["strong single effects covered", ["count", "of"]].tolist() == [2, 3]
    assert table.loc["wrong single name on any single effect", "count"] == 1
    assert table.loc["claims on null cases", "upper"] > 0.8, "two cases prove little"


def test_the_documents_table_follows_from_the_cases():
    """Each row of the page counts what the rule counts, in the same order."""
    cases = pd.read_csv(STUDIES / "cases.csv", keep_default_na=False, na_values=[""])
    page = (STUDIES.parents[1] / "docs" / "blind_trial.md").read_text(encoding="utf-8")
    (table,) = re.findall(r"\| figure of merit \| \d+ cases \| 95 % interval \| target \| before \|\n(?:\|.*\n)+", page)
    shown = [(int(count), int(of)) for count, of in re.findall(r"\| (\d+) of (\d+) \|", table)]
    counted = score.summary(cases)
    following = iter(zip(counted["count"], counted["of"], strict=True))
    assert len(shown) > 10
    assert all(row in following for row in shown)
    assert f"{len(cases)} cases" in table
