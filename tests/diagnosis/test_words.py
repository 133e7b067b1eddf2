"""The summary of a diagnosis: one sentence for each verdict, from what diagnosis.json holds."""

import pytest

from palpate.diagnosis.summary_text import sentence


def quantity(estimate):
    return {"estimate": estimate, "lower": 0.8 * estimate, "upper": 1.2 * estimate}


FRAME = {"frame_compliance.compliance": quantity(0.27)}
ROUNDED = {
    "mechanisms": ["frame_compliance", "tip_rounding"],
    "probability": 0.86,
    "parameters": FRAME | {"tip_rounding.radius": quantity(190.0)},
}
SHIFTED = {
    "mechanisms": ["frame_compliance", "zero_offset"],
    "probability": 0.14,
    "parameters": FRAME | {"zero_offset.offset": quantity(12.0)},
}
DRIFT = {"mechanisms": ["thermal_drift"], "probability": 0.9, "parameters": {"thermal_drift.rate": quantity(0.12)}}


def content(verdict, *candidates, held_out=(14.1, 1.9), risen=None):
    (before, after), risen = held_out, risen or {}
    return {
        "verdict": verdict,
        "law_within_tolerance": verdict != "unexplained",
        "p_value": 0.001,
        "pattern": None,
        "discrepancy": {"share": 0.0012, "lower": 0.0005, "upper": 0.003, "class": "scaling"},
        "nothing_further": {
            "probability": 0.9,
            "hidden": [{"mechanism": "friction", "probability": 0.06}, {"mechanism": "adhesion", "probability": 0.01}],
        },
        "location": [
            {"condition": "P1", "segment": "hold", "part": "late", "residual_nm": 12.0, "q_value": 0.001},
        ],
        "candidates": list(candidates),
        "fit": {
            "calibrate": {"before_rmse_nm": 9.0, "after_rmse_nm": 2.0, "risen_nm": {}},
            "validate": {"before_rmse_nm": before, "after_rmse_nm": after, "risen_nm": risen},
            "noise_nm": 1.7,
        },
        "parameters": {
            "before": {"youngs_modulus": quantity(3.0)},
            "after": {"youngs_modulus": {"estimate": 3.2, "lower": 3.15, "upper": 3.25}},
        },
        "missing": {"mechanisms": [], "location": [], "trends": []},
        "discriminating_test": None,
        "tried": [{"mechanisms": [], "parameters": {}}],
    }


def test_an_identified_effect_comes_with_its_amplitude_its_gain_and_the_bias_it_made():
    said = sentence(content("identified", DRIFT))
    assert "Thermal drift, rate 0.120 nm/s (0.096 to 0.144)" in said
    assert "held-out error falls from 14.1 to 1.9 nm; noise and scatter alone would leave 1.7 nm" in said
    assert "Young's modulus is 6 % too low" in said


def test_held_out_tests_that_are_described_worse_are_named():
    said = sentence(content("identified", DRIFT, risen={"P2": 4.53, "P3": 3.47}))
    assert "falls from 14.1 to 1.9 nm, though it rises to 4.5 nm under P2 and 3.5 nm under P3; noise" in said


def test_an_adequate_model_comes_with_the_test_that_would_show_what_could_hide():
    test = {"test": "a hold of 100 s at 1 mN", "expected_power": 0.93, "hidden_effect": {"thermal_drift.rate": -0.31}}
    assert sentence(content("adequate") | {"discriminating_test": test}).endswith(
        " A hold of 100 s at 1 mN would distinguish a thermal drift of -0.31 nm/s, which these do not exclude, from "
        "none with a probability of 93 %."
    )


def test_how_far_the_law_is_off_is_said_with_what_it_resembles_and_the_tolerance():
    within = sentence(content("adequate"))
    assert "departs from the law by 0.12 % of the depth (0.05 to 0.30), alike at all loads" in within
    assert "tolerance" not in within
    assert "more than the tolerance of the study" in sentence(content("unexplained"))
    undecided = sentence(content("identified", DRIFT) | {"law_within_tolerance": "undecided"})
    assert "is undecided" in undecided
    neither = sentence(content("adequate") | {"law_within_tolerance": "undecided"})
    assert "describes the recordings;" not in neither
    assert "No effect of the library is certain" in neither
    assert "departs from the law" not in sentence(content("adequate") | {"discrepancy": None}), "an exact law"


def test_what_remains_open_is_said_with_its_probability():
    said = sentence(content("identified", DRIFT))
    assert "nothing further of the library acts has a probability of 90 %; most likely hidden: friction (6 %)." in said


def test_where_no_part_is_significant_the_pattern_that_rejected_the_base_model_is_named():
    found = content("identified", DRIFT) | {"location": [], "pattern": "thermal drift"}
    assert "in no single part significantly, but in all together, as thermal drift does" in sentence(found)


def test_a_parameter_that_is_nearly_nothing_is_given_by_value_not_in_percent():
    parameters = {
        "before": {"transient_coefficient": quantity(0.00183)},
        "after": {"transient_coefficient": {"estimate": 0.0003, "lower": 0.0, "upper": 0.0008}},
    }
    said = sentence(content("identified", DRIFT) | {"parameters": parameters})
    assert "transient coefficient is 0.0018 in place of 3.0 × 10⁻⁴." in said


def test_what_comes_nearest_is_said_where_nothing_explains():
    tried = {"mechanisms": ["film_on_substrate", "friction"], "parameters": {}}
    for name, value in {"film_on_substrate.thickness": 511.4, "film_on_substrate.substrate_modulus": 70.0}.items():
        tried["parameters"][name] = value
    tried["parameters"]["friction.coefficient"] = 0.123
    unexplained = content("unexplained")
    said = sentence(unexplained | {"tried": [tried]})
    film = "film on a substrate (thickness 511 nm, substrate modulus 70.0 GPa) with friction (coefficient 0.123)"
    assert f"The closest is {film}." in said
    assert "The closest" not in sentence(unexplained)


def test_what_all_explanations_share_is_said():
    said = sentence(content("ambiguous", ROUNDED, SHIFTED))
    assert "Each of these explains it" in said
    assert "All of them need frame compliance." in said
    assert "All of them" not in sentence(content("ambiguous", DRIFT, SHIFTED))


def test_a_single_suspicion_is_no_name():
    said = sentence(content("suspected", DRIFT, held_out=(None, None)))
    assert "These recordings do not suffice to identify it; the fitted error falls from 9.0 to 2.0 nm" in said


@pytest.mark.parametrize(
    ("verdict", "words"),
    [("adequate", "no effect of the library is needed beside it"), ("unexplained", "something else is missing")],
)
def test_no_effect_is_named_without_need(verdict, words):
    said = sentence(content(verdict))
    assert words in said
    assert "hermal" not in said


def test_an_error_that_rises_is_reported():
    assert "rises from 5.2 to 6.2 nm" in sentence(content("identified", DRIFT, held_out=(5.2, 6.2)))


def test_a_suspicion_names_the_effect_that_may_be_none():
    spread = {"estimate": 0.3, "lower": -0.6, "upper": 1.1}
    shifted = {"mechanisms": ["zero_offset"], "probability": 1.0, "parameters": {"zero_offset.offset": spread}}
    said = sentence(content("suspected", shifted))
    assert "do not suffice to identify it, because the mean of the zero offset may be zero" in said


def test_what_the_missing_physics_would_have_to_change_is_said_with_figures():
    rows = [("unloading", "late", -9.0, 1e-4), ("hold", "whole", 4.0, 1e-3), ("loading", "early", 1.0, 0.4)]
    names = ("segment", "part", "residual_nm", "q_value")
    located = [{"condition": "P1", **dict(zip(names, row, strict=True))} for row in rows]
    trend = {"by": "load", "unit": "mN", "from": 1.0, "to": 10.0}
    trends = [trend | {"residual_from": 0.001, "residual_to": 0.02, "p_value": 0.001}]
    said = sentence(content("unexplained") | {"missing": {"mechanisms": [], "location": located, "trends": trends}})
    parts = "let it recover more late in unloading of P1 (-9 nm) and let it creep more in the hold of P1 (+4 nm)"
    trend_words = "from a load of 1 to 10 mN the difference goes from +0.1% to +2.0% of the depth"
    assert f"What is missing would have to {parts}; {trend_words}." in said
