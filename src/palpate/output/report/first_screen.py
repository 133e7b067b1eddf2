"""The first screen: of each set of recordings the verdict, the accepted parameters, errors, and what is open."""

from __future__ import annotations

import html
from collections.abc import Sequence

from palpate.base.parameters import in_words
from palpate.base.rounding import interval_of, rounded, unit_html
from palpate.output.html_report import definitions, paragraph
from palpate.output.results.answer import Answer
from palpate.output.results.law_candidates import choice_sentences


def answer(found: Answer) -> str:
    """Return the answer of one set of recordings."""
    name = html.escape(found.saved.name)
    about = f"{found.law}, {found.tip}. {found.tests_in_words}."
    synthetic = " The recordings are synthetic, not measured." if found.saved.synthetic else ""
    effects = "".join(f"<li>{html.escape(text)}</li>" for text in found.effect_sentences)
    return "\n".join(
        [
            f'<section class="answer {found.verdict or "none"}" id="{name}">',
            f'<p class="soft">Recordings <b>{name}</b>: {html.escape(about + synthetic)}</p>',
            f"<h2>{html.escape(found.headline)}</h2>",
            f'<ul class="effects">{effects}</ul>' if effects else "",
            paragraph(found.sentence),
            *([paragraph(choice_sentences(choice))] if (choice := found.saved.study.choice) else []),
            *([paragraph(instrument.in_words)] if (instrument := found.saved.study.instrument) else []),
            f'<div class="two"><div>{parameters(found)}</div><div>{definitions(dict(found.facts()))}</div></div>',
            "</section>",
        ]
    )


def parameters(found: Answer) -> str:
    """Return the table of the accepted model's parameters, with those of the base model beside them."""
    accepted, verdict = bool(found.saved.accepted), found.verdict
    whichever = any(entry["over_all_sets"] for entry in found.parameters)
    heads = ["parameter", "estimate (95 %)"] + (["base model (95 %)"] if accepted else [])
    heads += ["whichever effects act (95 %)"] if whichever else []
    rows = []
    for entry in found.parameters:
        unit = unit_html(entry["unit"])
        name = f"{html.escape(in_words(entry['name']))}{f' [{unit}]' if unit else ''}"
        unknown = "" if entry["identified"] else '<br><span class="soft">not identified</span>'
        cells = [name, f'<span class="accepted">{interval_of(entry)}</span>{unknown}']
        cells += [interval_of(entry["before"])] if accepted else []
        cells += [interval_of(entry["over_all_sets"])] if whichever else []
        rows.append("".join(f"<td>{cell}</td>" for cell in cells))
    with_effects = "accepted model" if verdict != "ambiguous" else "best of the explanations"
    caption = f"Parameters of the {with_effects if accepted else 'base model'}"
    if verdict == "unexplained":
        caption += "; their intervals assume that it is right, which it is not"
    units = {name: found.saved.quantity(name).unit for name in found.constants}
    held = ", ".join(
        f"{in_words(name)} {value:g}{'' if units[name] == '-' else f' {units[name]}'}"
        for name, value in found.constants.items()
    )
    note = paragraph(f"Held constant: {held}.", "soft") if held else ""
    head = "".join(f"<th>{text}</th>" for text in heads)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return (
        f'<div class="wide"><table class="estimates"><caption>{caption}</caption><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>{note}"
    )


def overview(answers: Sequence[Answer]) -> str:
    """Return one row a set of recordings, where a study has several."""
    heads = ["recordings", "law, tip, tests", "verdict", "parameters (95 %)", "error before, after, noise [nm]", "open"]
    rows = []
    for found in answers:
        name = html.escape(found.saved.name)
        values = "<br>".join(
            f"{html.escape(in_words(entry['name']))} {interval_of(entry)} {unit_html(entry['unit'])}"
            for entry in found.parameters[:2]
        )
        errors = (found.held_out[key] for key in ("before_nm", "after_nm", "noise_nm"))
        effects = "".join(f"<br>{html.escape(text)}" for text in found.effect_sentences)
        cells = [
            f'<a href="#{name}">{name}</a>',
            html.escape(f"{found.law}, {found.tip}; {found.tests_in_words}"),
            f"<b>{html.escape(found.headline)}</b>{effects}",
            values,
            ", ".join("-" if error is None else rounded(error, 2) for error in errors),
            html.escape(dict(found.facts())["What is open"]),
        ]
        rows.append("".join(f"<td>{cell}</td>" for cell in cells))
    head = "".join(f"<th>{text}</th>" for text in heads)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
