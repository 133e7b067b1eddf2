"""The page of a diagnosis: units beside numbers, and no list of places where none stands out."""

import pandas as pd
from palpate.output.diagnosis_page import _material, effect, located

from palpate.materials import LAWS
from palpate.output import html_report


def test_parameters_of_effects_carry_their_units():
    assert effect("thermal_drift.rate") == {"parameter": "thermal_drift.rate", "unit": "nm/s"}
    assert effect("friction.coefficient")["unit"] == "-"


def test_places_are_listed_only_where_they_stand_out():
    row = {"condition": "A", "segment": "hold", "part": "late", "residual_nm": 3.21987}
    said = located([{**row, "q_value": 0.01}, {**row, "condition": "B", "q_value": 0.4}])
    assert "3.22" in said
    assert "<td>A</td>" in said
    assert "<td>B</td>" not in said
    assert "No part of a test has a significant misfit" in located([{**row, "q_value": 0.4}])


def test_tables_show_nothing_where_nothing_is_known():
    shown = html_report.table(pd.DataFrame([{"lower": None, "held": True}, {"lower": 1.23456, "held": False}]))
    cells = [line.strip() for line in shown.splitlines() if "<td>" in line]
    assert cells == ["<td></td>", "<td>yes</td>", "<td>1.235</td>", "<td>no</td>"]


def test_nothing_comes_after_a_base_model_that_nothing_joined():
    found = {"youngs_modulus": {"estimate": 3.0, "lower": 2.9, "upper": 3.1, "identified": True}}
    content = {"parameters": {"before": found, "after": found}, "candidates": [], "verdict": "unexplained"}
    declared = {parameter.name: parameter for parameter in LAWS["elastic"].parameters}
    title, pieces = _material(content, declared)
    assert title == "Material parameters of the base model"
    assert "which it is not" in pieces[0] and "after" not in pieces[-1]
    title, pieces = _material(content | {"candidates": [{}], "verdict": "identified"}, declared)
    assert title == "Material parameters before and after" and "<th>after</th>" in pieces[-1]
