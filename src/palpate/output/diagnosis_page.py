"""The page of a diagnosis: its summary, the figure, and the numbers behind them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.base.parameters import Parameter
from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS
from palpate.output import html_report

MOST_PARTS = 12  # rows of the table of misfits
TABLES = {
    "similarity": (
        "Scaling law of a sharp tip",
        "For a sharp tip on a homogeneous body, depth / sqrt(load) at equal times cannot depend on the largest load, "
        "whatever the material's law. Where it does, the model lacks a length scale or an effect of the instrument.",
    ),
    "undetected_effects": (
        "Undetected effects",
        "The amplitude of each effect on the recorded depth outside the explanation, if it were added to it. A wide "
        "interval means that these recordings neither show the effect nor rule it out.",
    ),
    "joint_intervals": (
        "Joint intervals of all effects",
        "The amplitude of each effect on the recorded depth if all effects considered act at once. Where its interval "
        "is much wider than under one explanation, these recordings do not determine the amplitude.",
    ),
    "laws": (
        "Amplitudes from exact laws",
        "A hold at low load gives the drift, and the initial slopes of unloadings from several loads give the frame "
        "compliance, whatever the shape of the tip. Where the solid creeps, the amplitudes that these laws give for "
        "the base model's own curves are subtracted, and widen the interval by as much on both sides. A law without a "
        "lower end is an upper bound. The amplitudes are data beside the curves: an explanation whose amplitude from "
        "the curves contradicts them is not accepted. The last column lists the mechanisms that break the assumptions "
        "of a law: it does not apply to explanations with one of these.",
    ),
    "zero_points": (
        "Zero points by the law of a sharp tip",
        "The depth [nm] at which the loading curve of a sharp tip, load = C (depth - zero)^2, begins in each test; "
        "with frame_off, after the compliance that the unloadings give is subtracted. Creep and a blunt tip shift it, "
        "too, which the interval does not include: use differences between tests as offsets, not the values.",
    ),
}  # heading and explanation of the table that shows each of these entries of `diagnosis.json`


def sections(
    content: Mapping[str, Any], declared: Mapping[str, Parameter], figure: str | Path
) -> list[tuple[str, list[str]]]:
    """Return headings and pieces of HTML.

    Parameters
    ----------
    content
        Content of `diagnosis.json`.
    declared
        Parameters of the law by name.
    figure
        The diagnosis as a PNG file.
    """
    verdict = [html_report.paragraph(content["sentence"]), html_report.image(figure, "diagnosis")]
    found: list[tuple[str, list[str]]] = [("Verdict", verdict)]
    if content["candidates"]:
        found.append(("Accepted explanations", [html_report.table(explanations(content))]))
    found.append(_material(content, declared))
    if test := content["discriminating_test"]:
        power = f"expected power {test['expected_power']:.0%}"
        text = f"{test['test']} ({power}) separates {' and '.join(test['separates'])}"
        found.append(("Next test", [html_report.paragraph(text)]))
    if content["limits"]:
        found.append(("Limits of these recordings", [html_report.paragraph(text) for text in content["limits"]]))
    for key, (heading, text) in TABLES.items():
        if content[key]:
            table = html_report.table(pd.DataFrame(_rows(key, content[key])))
            found.append((heading, [html_report.paragraph(text), table]))
    found.append(("Misfit of the base model by parts of the tests", [located(content["location"])]))
    if left := content["missing"]:
        closest = " with ".join(left["mechanisms"]) or "the base model"
        trends = [html_report.table(pd.DataFrame(left["trends"]))] if left["trends"] else []
        found.append((f"Residual of the closest explanation, {closest}", [located(left["location"]), *trends]))
    return found


def _rows(key: str, entry: Any) -> list[dict[str, Any]]:
    """Return the rows of the table that shows an entry of `diagnosis.json`."""
    if key == "similarity":
        return [{**row, "conditions": " and ".join(row["conditions"])} for row in entry]
    return [effect(name) | values for name, values in entry.items()] if isinstance(entry, Mapping) else entry


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
    """Return the section on the material's parameters, before and after where an explanation was accepted."""
    before, after = content["parameters"]["before"], content["parameters"]["after"]
    table = pd.DataFrame(
        {"parameter": name, "unit": declared[name].unit, "before": before[name]["estimate"]}
        | {"after": found["estimate"], **{key: found[key] for key in ("lower", "upper", "identified")}}
        for name, found in after.items()
    )
    if content["candidates"]:
        return "Material parameters before and after", [html_report.table(table)]
    alone = html_report.table(table.drop(columns="before").rename(columns={"after": "estimate"}))
    text = "The intervals assume that the base model is right, which it is not."
    warning = [html_report.paragraph(text)] if content["verdict"] == "unexplained" else []
    return "Material parameters of the base model", [*warning, alone]


def effect(name: str) -> dict[str, str]:
    """Return the first cells of a row on a mechanism's parameter, such as ``thermal_drift.rate``."""
    key, parameter = name.split(".")
    (unit,) = (p.unit for p in MECHANISMS[key].parameters if p.name == parameter)
    return {"parameter": name, "unit": unit}


def located(rows: list[dict[str, Any]]) -> str:
    """Return the parts of tests with a significant misfit, or a sentence that there is none."""
    clearest = [row for row in rows if row["q_value"] < CERTAIN]
    if clearest:
        return html_report.table(pd.DataFrame(clearest[:MOST_PARTS]))
    return html_report.paragraph(
        "No part of a test has a significant misfit by itself. The test of the base model uses all parts together, and "
        "the effect of each mechanism on them."
    )


def write(
    content: Mapping[str, Any], declared: Mapping[str, Parameter], figure: str | Path, path: str | Path, title: str
) -> None:
    """Write `diagnosis.html`.

    Parameters
    ----------
    content, declared, figure
        See `sections`.
    path
        File that is written.
    title
        Title of the study.
    """
    html_report.build(f"Diagnosis of {title}", sections(content, declared, figure), [], path)
