"""The page of a diagnosis: what a colleague would say, the picture, and the numbers behind it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.base.parameters import Parameter
from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS
from palpate.output import html_report

MOST_PARTS = 12


def sections(
    content: Mapping[str, Any], declared: Mapping[str, Parameter], figure: str | Path
) -> list[tuple[str, list[str]]]:
    """Return headings and pieces of HTML, from the content of `diagnosis.json`; the law has `declared` parameters."""
    found: list[tuple[str, list[str]]] = [
        (
            "What the recordings say",
            [html_report.paragraph(content["sentence"]), html_report.image(figure, "diagnosis")],
        )
    ]
    if content["candidates"]:
        found.append(("Accepted explanations", [html_report.table(explanations(content))]))
    found.append(_material(content, declared))
    if content["discriminating_test"]:
        test = content["discriminating_test"]
        words = (
            f"{test['test']} (expected power {test['expected_power']:.0%}) separates {' and '.join(test['separates'])}"
        )
        found.append(("What to measure next", [html_report.paragraph(words)]))
    if content["limits"]:
        found.append(
            ("What these recordings cannot say", [html_report.paragraph(words) for words in content["limits"]])
        )
    if content["similarity"]:
        words = (
            "For a sharp tip on a homogeneous body, depth / sqrt(load) at equal times cannot depend on the largest "
            "load, whatever the material's law. Where it does, a length or the instrument is missing."
        )
        rows = [{**row, "conditions": " and ".join(row["conditions"])} for row in content["similarity"]]
        found.append(
            ("The law of the sharp tip", [html_report.paragraph(words), html_report.table(pd.DataFrame(rows))])
        )
    if content["undetected_effects"]:
        words = (
            "What each effect on the recorded depth that is not named would amount to if it joined. Where the interval "
            "is wide, these recordings neither show the effect nor rule it out."
        )
        rows = [effect(name) | values for name, values in content["undetected_effects"].items()]
        found.append(("What may still hide", [html_report.paragraph(words), html_report.table(pd.DataFrame(rows))]))
    if content["joint_intervals"]:
        words = (
            "What each effect on the recorded depth, named or not, may amount to if all effects considered act at "
            "once. Where this is much wider than under one explanation, these recordings do not fix the amplitude."
        )
        rows = [effect(name) | values for name, values in content["joint_intervals"].items()]
        found.append(
            ("If all effects act at once", [html_report.paragraph(words), html_report.table(pd.DataFrame(rows))])
        )
    if content["laws"]:
        words = (
            "A hold at low load shows the drift, and unloadings from several loads show the frame, whatever the shape "
            "of the tip. Where the solid creeps, what these laws say of the base model's own curves is taken off, and "
            "makes the interval wider by as much both ways. A law without a lower end is a bound. They are data "
            "beside the curves, and an explanation to which the curves give an amplitude that contradicts them is "
            "not accepted. They say nothing about explanations with a mechanism of the last column, which breaks what "
            "they assume."
        )
        found.append(
            ("What exact laws say", [html_report.paragraph(words), html_report.table(pd.DataFrame(content["laws"]))])
        )
    if content["zero_points"]:
        words = (
            "The depth [nm] at which the loading curve of a sharp tip, load = C (depth - zero)^2, begins in each test; "
            "with frame_off, once the frame that the unloadings show is taken off. Creep and a blunt tip shift it too, "
            "which the interval does not hold: take differences between tests for offsets, not the values."
        )
        table = html_report.table(pd.DataFrame(content["zero_points"]))
        found.append(("Zero points by the law of the sharp tip", [html_report.paragraph(words), table]))
    found.append(("Where the base model fails", [located(content["location"])]))
    return found


def explanations(content: Mapping[str, Any]) -> pd.DataFrame:
    """Return the accepted explanations, one row a parameter of their mechanisms, best first."""
    columns = ["explanation", "probability", "parameter", "unit", "estimate", "lower", "upper"]
    rows = [
        {
            "explanation": " + ".join(candidate["mechanisms"]),
            "probability": candidate["probability"],
            **effect(name),
            **values,
        }
        for candidate in content["candidates"]
        for name, values in candidate["parameters"].items()
    ]
    return pd.DataFrame(rows, columns=columns)


def _material(content: Mapping[str, Any], declared: Mapping[str, Parameter]) -> tuple[str, list[str]]:
    """Return the section on the material's parameters; before and after where anything joined the base model."""
    before, after = content["parameters"]["before"], content["parameters"]["after"]
    table = pd.DataFrame(
        {"parameter": name, "unit": declared[name].unit, "before": before[name]["estimate"]}
        | {"after": found["estimate"], "lower": found["lower"], "upper": found["upper"]}
        for name, found in after.items()
    )
    if content["candidates"]:
        return "Material parameters before and after", [html_report.table(table)]
    alone = html_report.table(table.drop(columns="before").rename(columns={"after": "estimate"}))
    words = "The intervals hold if the base model is right, which it is not."
    warning = [html_report.paragraph(words)] if content["verdict"] == "unexplained" else []
    return "Material parameters of the base model", [*warning, alone]


def effect(name: str) -> dict[str, str]:
    """Return the first cells of a row on a mechanism's parameter, such as ``thermal_drift.rate``."""
    key, parameter = name.split(".")
    (unit,) = (p.unit for p in MECHANISMS[key].parameters if p.name == parameter)
    return {"parameter": name, "unit": unit}


def located(rows: list[dict[str, Any]]) -> str:
    """Return the parts of tests where the misfit is no chance, or a sentence that there is none."""
    clearest = [row for row in rows if row["q_value"] < CERTAIN]
    if clearest:
        return html_report.table(pd.DataFrame(clearest[:MOST_PARTS]))
    return html_report.paragraph(
        "No part of a test sticks out by itself. Whether the base model explains the recordings is judged by all parts "
        "together, and by what each mechanism would do to them."
    )


def write(
    content: Mapping[str, Any], declared: Mapping[str, Parameter], figure: str | Path, path: str | Path, title: str
) -> None:
    """Write `diagnosis.html`."""
    html_report.build(f"Diagnosis of {title}", sections(content, declared, figure), [], path)
