"""The sections below the first screen, of one set of recordings."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from typing import Any

import pandas as pd

from palpate.base.rounding import interval_of, percent, rounded
from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS, quantity_in_words
from palpate.output.figures import curve_panels, curves, residuals
from palpate.output.html_report import paragraph, table
from palpate.output.report import further_evidence_sections
from palpate.output.results.answer import Answer
from palpate.output.results.diagnosis import titles_of

WORDS = {"calibrate": "fitted", "validate": "held\u00a0out"}
KINDS = {
    "frame": "compliance of frame or mount",
    "zero": "zero point",
    "tip": "shape of the tip",
    "size": "indentation size effect",
    "layer": "film or skin",
    "flow": "plastic flow",
    "controller": "lag of the controller",
    "load": "error of the load",
}  # families of effects in words, where the key is not one
MOST_PARTS = 12  # rows of the table of misfits
Picture = Callable[[str], str]  # a figure by its name, with its caption, or nothing
EXACT = {
    "model_free": (
        "Facts",
        "What the recordings show before any law of the material is fitted, with 95 % intervals. One in twenty of "
        "these misses the truth by chance; where an interval excludes what is found without any effect, the mechanisms "
        "that it suggests are listed.",
    ),
    "laws": (
        "Amplitudes from exact laws",
        "A hold at low load gives the drift, and the initial slopes of unloadings from several loads give the frame "
        "compliance, whatever the shape of the tip. Where the solid creeps, the amplitudes that these laws give for "
        "the base model's own curves are subtracted, and widen the interval by as much on both sides. A law without a "
        "lower end is an upper bound. An explanation whose amplitude from the curves contradicts them is not accepted. "
        "The last column lists the mechanisms that break the assumptions of a law.",
    ),
    "zero_points": (
        "Zero points by the law of a sharp tip",
        "The depth [nm] at which the loading curve of a sharp tip, load = C (depth - zero)^2, begins in each test; "
        "with frame_off, after the compliance that the unloadings give is subtracted. Creep and a blunt tip shift it, "
        "too, which the interval does not include: use differences between tests as offsets, not the values.",
    ),
}  # heading and explanation of the table that shows each of these entries of `diagnosis.json`


def sections(found: Answer, picture: Picture) -> list[tuple[str, list[str]]]:
    """Return headings and pieces of HTML."""
    every = [("Curves", _curves(found, picture))]
    if found.diagnosis:
        every.append(("Where the base model fails", _fails(found, picture)))
        every.append(("Explanations", _explanations(found, picture)))
        every.append(("Identifiability", _identifiability(found)))
        every.append(("What the recordings show without a model", _exact(found)))
    every.append(("Uniaxial tests of the bulk", further_evidence_sections.uniaxial(found, picture)))
    every.append(("Imprints", further_evidence_sections.imprint(found, picture)))
    every.append(("Calibration sets", _calibrations(found, picture)))
    return [(heading, pieces) for heading, pieces in every if pieces]


def _curves(found: Answer, picture: Picture) -> list[str]:
    name = html.escape(found.saved.name)
    drawn = curves.table(found.saved)["condition"].unique()
    options = "".join(
        f'<option value="{k}">{html.escape(found.saved.labels[condition])}{_held_out(found, condition)}</option>'
        for k, condition in enumerate(drawn)
    )
    over = (
        '<option value="time">time</option><option value="drive">load</option><option value="response">depth</option>'
    )
    if not found.saved.study.condition(drawn[0]).observable.is_depth:
        over = over.replace(">load<", ">displacement<").replace(">depth<", ">response<")
    static = "".join(map(picture, ("curves", "residuals")))
    return [
        f'<div class="interactive" data-set="{name}"><div class="controls">'
        f'<label>condition <select class="condition">{options}</select></label>'
        f'<label>residual over <select class="over">{over}</select></label>'
        '<span class="soft">Drag to zoom, double-click to go back; click a name in the legend to hide a curve.</span>'
        "</div>"
        '<div class="plot curve" role="img" aria-label="recorded and simulated curves of the chosen condition"></div>'
        '<div class="plot residual" role="img" aria-label="recorded less simulated response of the chosen condition">'
        f'</div><div class="static">{static}</div></div>',
        _errors(found),
    ]


def _held_out(found: Answer, condition: str) -> str:
    return " (held out)" if found.saved.study.condition(condition).role == "validate" else ""


def _errors(found: Answer) -> str:
    """Return the errors of the conditions, with and without the effects."""
    left, rows = residuals.table(found.saved), []
    for name, part in left.groupby("condition", sort=False):
        unit = curve_panels.unit_of(part)
        row = {"condition": found.saved.labels[str(name)], "role": WORDS[part["role"].iloc[0]]}
        for key, words in curve_panels.MODELS.items():
            if (values := curve_panels.response(part, key)) is not None:
                row[words] = f"{rounded(float((values**2).mean() ** 0.5), 2)} {unit}"
        if (band := curve_panels.response(part, "band")) is not None:
            row["noise and scatter"] = f"{rounded(float((band**2).mean() ** 0.5) / residuals.COVERED, 2)} {unit}"
        rows.append(row)
    return table(pd.DataFrame(rows), "Error of each condition: root mean square of recorded less simulated response")


def _fails(found: Answer, picture: Picture) -> list[str]:
    assert found.diagnosis
    content, pieces = found.diagnosis.content, [picture("misfit_map")]
    clearest = [row for row in content["location"] if row["q_value"] < CERTAIN]
    if clearest:
        pieces.append(_located(found, clearest))
    else:
        pieces.append(
            paragraph(
                "No part of a test has a significant misfit by itself. The test of the base model uses all parts "
                f"together, and the effect of each mechanism on them (p = {rounded(content['p_value'], 2)})."
            )
        )
    if left := content["missing"]:
        pieces.append(f"<h3>Residual of the closest explanation, {html.escape(titles_of(left['mechanisms']))}</h3>")
        parts = [row for row in left["location"] if row["q_value"] < CERTAIN]
        pieces.append(_located(found, parts) if parts else paragraph("No part alone has a significant misfit."))
        pieces += [table(pd.DataFrame(left["trends"]))] if left["trends"] else []
    return pieces


def _located(found: Answer, rows: list[Mapping[str, Any]]) -> str:
    """Return the parts of tests with a significant misfit."""
    texts = (
        {
            "test": found.saved.labels[row["condition"]],
            "segment": row["segment"],
            "part": row["part"],
            "mean residual [nm]": f"{row['residual_nm']:+.1f}".replace("-", "−"),
            "q-value": rounded(row["q_value"], 2) if row["q_value"] > 1e-4 else "< 0.0001",
        }
        for row in rows[:MOST_PARTS]
    )
    return table(pd.DataFrame(texts), "Parts of tests with a significant misfit, most significant first")


def _explanations(found: Answer, picture: Picture) -> list[str]:
    assert found.diagnosis
    accepted = found.diagnosis.candidates
    rows = (
        {
            "explanation": row["explanation"],
            "probability": percent(row["probability"]),
            "quantity": quantity_in_words(row["parameter"]),
            "estimate (95 %)": interval_of(row) + ("" if row["unit"] == "-" else f" {row['unit']}"),
        }
        for row in accepted.to_dict("records")
    )
    caption = "Accepted explanations, with the probability that these effects act and no others"
    pieces = [table(pd.DataFrame(rows), caption)] if len(accepted) else []
    tried = found.diagnosis.tried
    pieces.append(picture("explanations"))
    every = pd.DataFrame(
        {
            "explanation": [titles_of(entry["mechanisms"]) for entry in found.diagnosis.content["tried"]],
            "probability": [percent(value) for value in tried["probability"]],
            "log evidence": [f"{value:.1f}" for value in tried["log_evidence"]],
            "error [nm]": [rounded(value, 2) for value in tried["rmse_nm"]],
            "accepted": tried["accepted"],
        }
    )
    note = "The most probable fit first; a probability is that these effects act by more than the smallest effect"
    pieces.append(f"<details><summary>All {len(every)} fits</summary>{table(every, note)}</details>")
    return pieces


def _identifiability(found: Answer) -> list[str]:
    assert found.diagnosis
    content, pieces = found.diagnosis.content, _inclusion(found)
    if joint := content["joint_intervals"]:
        alone = {effect["name"]: interval_of(effect) for effect in found.effects}
        rows = (
            _effect(found, name)
            | {
                "accepted model (95 %)": alone.get(name, "-"),
                "if all effects act (95 %)": interval_of(entry),
                "most correlated with": quantity_in_words(entry["correlated_with"]) if entry["correlated_with"] else "",
                "correlation": f"{entry['correlation']:.2f}".replace("-", "−"),
            }
            for name, entry in joint.items()
        )
        pieces += [
            paragraph(
                "Amplitude of each effect on the recorded depth if all effects considered act at once. Where its "
                "interval is much wider than in the accepted model, these recordings do not determine the amplitude."
            ),
            table(pd.DataFrame(rows)),
        ]
    if undetected := content["undetected_effects"]:
        rows = (
            _effect(found, name) | {"amplitude if added (95 %)": interval_of(entry)}
            for name, entry in undetected.items()
        )
        pieces += [
            paragraph(
                "Effects outside the accepted model, each added to it. A wide interval means that these recordings "
                "neither show the effect nor rule it out."
            ),
            table(pd.DataFrame(rows)),
        ]
    if limits := content["limits"]:
        pieces += ["<h3>Limits of these recordings</h3>", *map(paragraph, limits)]
    return pieces


def _effect(found: Answer, name: str) -> dict[str, str]:
    """Return the cells that name an amplitude and its unit."""
    return {"effect": quantity_in_words(name), "unit": found.saved.quantity(name).unit}


def _inclusion(found: Answer) -> list[str]:
    """Return how probable it is that each effect acts, and what one that does not show may change."""
    assert found.diagnosis
    pieces: list[str] = []
    if inclusion := found.diagnosis.inclusion:
        rows = ({"effect": MECHANISMS[key].title, "probability": percent(value)} for key, value in inclusion.items())
        caption = "Probability that an effect acts by more than the smallest effect, over all sets of effects"
        pieces.append(table(pd.DataFrame(rows), caption))
    if (further := found.diagnosis.nothing_further) and further.get("may_cover"):
        rows = (
            {"kind of effect": KINDS.get(key, key), "change [nm]": rounded(value, 2)}
            for key, value in further["may_cover"].items()
        )
        caption = "Largest change of a curve by an effect of each kind that the recordings do not exclude at 95 %"
        pieces.append(table(pd.DataFrame(rows), caption))
    return ['<div class="pair">', *pieces, "</div>"] if pieces else []


def _exact(found: Answer) -> list[str]:
    assert found.diagnosis
    pieces = []
    for key, (heading, text) in EXACT.items():
        if rows := found.diagnosis.content[key]:
            shown = pd.DataFrame([_without_codes(row, found.saved.labels) for row in rows])
            pieces += [f"<h3>{heading}</h3>", paragraph(text), table(shown)]
    return pieces


def _without_codes(row: Mapping[str, Any], labels: Mapping[str, str]) -> dict[str, Any]:
    """Return a row with estimate and interval in one column, and titles of mechanisms and tests in place of keys."""
    shown: dict[str, Any] = {}
    for name, value in row.items():
        if name == "estimate" and {"lower", "upper"} <= row.keys():
            shown["estimate (95 %)"] = _open_interval(row)
        elif isinstance(value, list):
            shown[name] = ", ".join(MECHANISMS[each].title if each in MECHANISMS else each for each in value) or "none"
        elif isinstance(value, str):
            for code, label in labels.items():
                value = value.replace(code, label)
            shown[name] = value
        elif name not in ("lower", "upper"):
            shown[name] = value
    return shown


def _open_interval(row: Mapping[str, Any]) -> str:
    """Return an estimate with its interval, of which an end may be unknown."""
    if None not in (row["estimate"], row["lower"], row["upper"]):
        return interval_of(row)
    ends = [
        f"{words} {rounded(row[key])}"
        for key, words in (("lower", "at least"), ("upper", "at most"))
        if row[key] is not None
    ]
    return ", ".join(([rounded(row["estimate"])] if row["estimate"] is not None else []) + ends)


def _calibrations(found: Answer, picture: Picture) -> list[str]:
    made = found.calibration
    sentences = made.sentences()[1:] if found.diagnosis else made.sentences()  # errors are those of the diagnosis
    return [picture("parameters"), *map(paragraph, sentences)]
