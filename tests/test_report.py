"""What the report says in words."""

import re

import numpy as np
import pandas as pd
from test_config import TRUTH, load

from palpate.output.html_report import bound_sentence, misfit_sentence, search_sentences, table
from palpate.recordings.recording import SYNTHETIC, Recording
from palpate.workflow_support.study_report import synthetic_sets


def test_a_misfit_near_the_noise_does_not_speak_for_the_model():
    """A drift of 0.15 nm/s was found with a misfit of 1.17: the diagnosis above must not be contradicted."""
    calibration = {"conditions": {"a": {"rmse_nm": 1.1}}, "noise": {"a": {"replicates": 3}}, "misfit_ratio": 1.17}
    said = misfit_sentence(calibration)
    assert "explains the recordings" not in said
    assert "1.17); a small effect may still be present" in said
    assert "does not explain the recordings" in misfit_sentence(calibration | {"misfit_ratio": 3.0})


def test_headings_are_words_with_units():
    shown = table(pd.DataFrame({"rmse_nm": [1.23456], "condition_set": ["all"], "identified": [True]}))
    assert re.findall("<th>(.*?)</th>", shown) == ["rmse [nm]", "condition set", "identified"]
    assert re.findall("<td>(.*?)</td>", shown) == ["1.235", "all", "yes"]


def test_a_search_that_has_not_settled_is_told():
    assert "not converged" not in search_sentences({"converged": True})
    assert "not converged" in search_sentences({"converged": False})


def test_a_share_close_to_one_is_not_rounded_to_one():
    assert "<td>0.99997</td>" in table(pd.DataFrame({"r2": [0.99997]}))
    assert "<td>1</td>" in table(pd.DataFrame({"r2": [1.0]}))


def test_an_estimate_outside_its_range_is_told():
    inside, outside, limit = ({"at_bound": a, "outside": o} for a, o in ((False, False), (False, True), (True, True)))
    said = bound_sentence({"parameters": {"youngs_modulus": outside, "hardening": limit, "yield_stress": inside}})
    assert said.startswith("At a limit: hardening;") and "plausible range: youngs_modulus." in said
    assert bound_sentence({"parameters": {"youngs_modulus": inside}}) == ""


def test_sets_with_simulated_recordings_are_told_whoever_wrote_them(tmp_path):
    time = np.linspace(0.0, 60.0, 61)
    for name, notes in (("virtual", (f"{SYNTHETIC}: by a laboratory",)), ("mine", (f"{SYNTHETIC}: b",)), ("lab", ())):
        (tmp_path / name).mkdir()
        Recording(time, time, 9.0 * time, notes=("made on Monday", *notes)).write(tmp_path / name / "P1_T30_2.csv")
        Recording(time, time, 9.0 * time).write(tmp_path / name / "P1_T30_1.csv")
    sets = {name: str(tmp_path / name) for name in ("virtual", "mine", "lab")}
    study = load(tmp_path, recordings=sets, laboratory={"virtual": {"parameters": TRUTH}})
    assert synthetic_sets(study) == [
        "Recordings “virtual” are synthetic: written by a virtual laboratory, not measured.",
        "Recordings “mine” contain synthetic ones: simulated, not measured.",
    ]
