"""Results as objects: one number for one quantity, whatever shows it."""

import json

import pytest
from results_of import DRIFT, diagnosis, saved

from palpate.base.rounding import interval, percent, rounded, unit_html
from palpate.diagnosis.summary_text import sentence
from palpate.output.results.answer import Answer
from palpate.output.results.calibration import Calibration
from palpate.output.results.diagnosis import Diagnosis
from palpate.output.results.misfit import progress


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((3.3041, 3.2203, 3.3971), "3.30 (3.22 to 3.40)"),
        ((2.701, 0.0151, 109.3), "2.7 (0.015 to 110)"),
        ((7009.0, 0.04, 218026.0), "7000 (0.040 to 220000)"),
        ((0.18737, 0.1033, 0.42411), "0.19 (0.10 to 0.42)"),
        ((72345.0, 71000.0, 73800.0), "72300 (71000 to 73800)"),
        ((2.5e-6, 1.1e-6, 4.2e-6), "2.5 (1.1 to 4.2) × 10⁻⁶"),
        ((-0.04, -0.61, 0.53), "0.0 (-0.6 to 0.5)"),
        ((0.25, 0.25, 0.25), "0.25"),
    ],
)
def test_an_estimate_is_rounded_by_its_interval(values, text):
    assert interval(*values) == text


def test_numbers_probabilities_and_units_are_written_as_people_write_them():
    assert [rounded(value) for value in (0.12345, 4321.0, 0.0, 1.5e-7)] == ["0.123", "4320", "0", "1.50 × 10⁻⁷"]
    assert [percent(value) for value in (0.0, 0.004, 0.5, 0.997, 1.0)] == ["< 1 %", "< 1 %", "50 %", "> 99 %", "> 99 %"]
    assert unit_html("GPa^-(2m_s+1)/s") == "GPa<sup>−(2<i>m</i><sub>s</sub>+1)</sup>/s"
    assert unit_html("-") == ""


def test_the_accepted_model_s_parameters_are_the_answer(tmp_path):
    found = saved(tmp_path, diagnosis())
    answer = Answer(found)
    (modulus,) = answer.parameters
    assert (modulus["estimate"], modulus["before"]["estimate"], modulus["identified"]) == (3.304, 3.978, True)
    assert Diagnosis(found).parameters["youngs_modulus"]["estimate"] == 3.304
    assert Calibration(found).values["youngs_modulus"] == 3.978
    assert answer.headline == "Thermal drift identified"
    assert answer.constants == {"steady_exponent": 0.2, "poisson_ratio": 0.34}
    content = json.loads(json.dumps(answer.to_mapping()))
    assert content["held_out"] == {"before_nm": 8.61, "after_nm": 5.42, "noise_nm": 2.1}
    assert content["effects"] == [
        DRIFT["thermal_drift.rate"] | {"name": "thermal_drift.rate", "unit": "nm/s", "probability": 1.0}
    ]
    assert {"law", "tip", "tests", "replicates", "verdict", "mechanisms", "next_test", "sentence"} <= set(content)


def test_what_a_file_lacks_is_left_out_and_what_it_holds_is_shown(tmp_path):
    words = [name for name, _ in Answer(saved(tmp_path, diagnosis())).facts()]
    assert words == ["Error of the held-out tests", "What is open"]
    part = {"condition": "A", "cycle": 1, "segment": "hold", "part": "late", "share": 0.02}
    more = {
        "discrepancy": {"share": 0.012, "lower": 0.008, "upper": 0.017, "class": "clock", "parts": [part]},
        "nothing_further": {"probability": 0.83, "hidden": [{"mechanism": "friction", "probability": 0.12}]},
        "model_free": [
            {
                "fact": "drift_rate",
                "estimate": 0.11,
                "lower": 0.10,
                "upper": 0.12,
                "unit": "nm/s",
                "suggests": ["thermal_drift"],
            }
        ],
        "inclusion": {"thermal_drift": 0.97},
        "discriminating_test": {"test": "a hold of 100 s", "expected_power": 0.93, "separates": []},
    }
    answer = Answer(saved(tmp_path, diagnosis(**more)))
    facts = dict(answer.facts())
    assert facts["Discrepancy of the law"].startswith(
        "1.20 % of the depth (0.80 to 1.70), of the class clock, most late in"
    )
    assert facts["Nothing further acts"] == "with a probability of 83 %; may act: friction 12 %"
    assert facts["Without a model"] == "drift rate 0.110 nm/s (0.100 to 0.120) (thermal drift)"
    assert facts["Test that would settle it"] == "a hold of 100 s (expected power 93 %)"
    assert answer.effects[0]["probability"] == 0.97


@pytest.mark.parametrize(
    ("verdict", "headline", "open_"),
    [
        ("adequate", "No effect is missing", "nothing that these recordings could show"),
        (
            "unexplained",
            "Unexplained: something else is missing",
            "not identified: Young's modulus; what the model lacks",
        ),
        ("suspected", "Thermal drift suspected", "whether the effect acts"),
    ],
)
def test_every_verdict_has_its_words(tmp_path, verdict, headline, open_):
    answer = Answer(saved(tmp_path, diagnosis(verdict)))
    assert (answer.headline, dict(answer.facts())["What is open"]) == (headline, open_)


@pytest.mark.parametrize(
    ("alone", "friction", "headline"),
    [
        (0.97, 0.02, "No effect is missing"),
        (0.8, 0.1, "No effect is needed"),
        (0.3, 0.61, "An effect is likelier than none, most likely friction (61 %)"),
        (0.4, 0.25, "An effect is likelier than none, most likely friction (25 %)"),
    ],
)
def test_an_adequate_model_does_not_hide_an_effect_that_is_likelier_than_none(tmp_path, alone, friction, headline):
    """The sentence below the headline follows the same rule."""
    hidden = [
        {"mechanism": key, "probability": p, "parameters": {}} for key, p in [("friction", friction), ("skin", 0.01)]
    ]
    further = {"probability": alone, "hidden": hidden, "may_cover": {}}
    content = diagnosis("adequate", nothing_further=further)
    assert Answer(saved(tmp_path, content)).headline == headline
    more = {"law_within_tolerance": True, "discrepancy": None}
    assert ("an effect beside it is likelier" in sentence(content | more)) == ("likelier than none" in headline)


def test_recordings_that_were_not_diagnosed_say_so(tmp_path):
    answer = Answer(saved(tmp_path))
    assert answer.headline == "Calibrated, not diagnosed"
    assert "not diagnosed" in dict(answer.facts())["What is open"]
    assert answer.held_out["before_nm"] == 8.61
    assert answer.to_mapping()["verdict"] is None


def test_a_misfit_near_the_noise_does_not_speak_for_the_model(tmp_path):
    """A drift of 0.15 nm/s was found with a misfit of 1.17: the diagnosis must not be contradicted."""
    found = saved(tmp_path)
    content = found.calibrations["all"]
    text = Calibration(saved(tmp_path, calibrations={"all": content | {"misfit_ratio": 1.17}})).misfit_sentence()
    assert "explains the recordings" not in text
    assert "1.17); a small effect may still be present" in text
    assert "does not explain the recordings" in Calibration(found).misfit_sentence()


def test_a_departure_of_the_law_is_stated_and_not_called_noise(tmp_path):
    """The discrepancy is among the errors by which chi-square counts, which is near one whatever is left."""
    content = saved(tmp_path).calibrations["all"] | {"misfit_ratio": 1.1, "converged": False}
    content |= {"discrepancy": {"share": 0.079, "lower": 0.071, "upper": 0.088}}
    text = Calibration(saved(tmp_path, calibrations={"all": content})).misfit_sentence()
    assert text.startswith("Beside noise the base model departs from the recordings by 7.9 % of the depth (7.1 to 8.8)")
    assert progress(content).startswith("misfit 4.20 to 8.61 nm, a departure of the law by 7.9")
    assert progress(content).endswith("the search has not converged")


def test_estimates_outside_their_range_and_searches_that_have_not_settled_are_told(tmp_path):
    found = saved(tmp_path)
    content = found.calibrations["all"]
    assert "outside the plausible range: Young's modulus." in Calibration(found).bound_sentence()
    entry = content["parameters"]["youngs_modulus"] | {"at_bound": True}
    changed = content | {"converged": False, "parameters": {"youngs_modulus": entry}}
    bounded = Calibration(saved(tmp_path, calibrations={"all": changed}))
    assert bounded.bound_sentence().startswith("At a limit: Young's modulus;")
    assert "not converged" in bounded.convergence_sentence()
    assert Calibration(found).convergence_sentence() == ""


def test_the_lines_for_a_terminal_name_law_verdict_parameters_and_error(tmp_path):
    lines = Answer(saved(tmp_path, diagnosis())).lines()
    assert [line.split()[0] for line in lines] == ["law", "verdict", "parameters", "error"]
    assert "Thermal drift identified: thermal drift, rate 0.113 nm/s (0.101 to 0.125)" in lines[1]
    assert "Young's modulus 3.30 GPa (3.22 to 3.40)" in lines[2]
    assert "8.6 nm without the effects, 5.4 nm with them" in lines[3]
