"""What the report says in words."""

import re

import pandas as pd

from palpate.report import bound_sentence, confirmation_sentences, misfit_sentence, table


def test_a_misfit_near_the_noise_does_not_speak_for_the_model():
    """A drift of 0.15 nm/s was found with a misfit of 1.17: the diagnosis above must not be contradicted."""
    calibration = {"conditions": {"a": {"rmse_nm": 1.1}}, "noise": {"a": {"replicates": 3}}, "misfit_ratio": 1.17}
    said = misfit_sentence(calibration)
    assert "explains the recordings" not in said
    assert "1.17); a small effect may hide in it" in said
    assert "does not explain the recordings" in misfit_sentence(calibration | {"misfit_ratio": 3.0})


def test_headings_are_words_with_units():
    shown = table(pd.DataFrame({"rmse_nm": [1.23456], "condition_set": ["all"], "identified": [True]}))
    assert re.findall("<th>(.*?)</th>", shown) == ["rmse [nm]", "condition set", "identified"]
    assert re.findall("<td>(.*?)</td>", shown) == ["1.235", "all", "yes"]


def test_the_surrogates_error_is_that_at_the_estimate():
    runs = [
        {"chi_square": 9.0, "surrogate_error_nm": {"T030": 7.0}},
        {"chi_square": 4.0, "surrogate_error_nm": {"T030": 1.8, "T240": 2.3}},
    ]
    assert "up to 2.3 nm from the finite elements" in confirmation_sentences({"confirmations": runs, "settled": True})
    assert "settled" not in confirmation_sentences({"confirmations": runs, "settled": True})
    assert "not settled: after 2 runs" in confirmation_sentences({"confirmations": runs, "settled": False})
    assert confirmation_sentences({"confirmations": []}) == ""


def test_a_share_close_to_one_is_not_rounded_to_one():
    assert "<td>0.99997</td>" in table(pd.DataFrame({"r2": [0.99997]}))
    assert "<td>1</td>" in table(pd.DataFrame({"r2": [1.0]}))


def test_an_estimate_at_an_end_of_its_range_is_told():
    parameters = {"youngs_modulus": {"at_bound": False}, "hardening": {"at_bound": True}}
    assert bound_sentence({"parameters": parameters}).startswith("At an end of its range: hardening.")
    assert bound_sentence({"parameters": {"youngs_modulus": {"at_bound": False}}}) == ""
