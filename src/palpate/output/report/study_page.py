"""The page of a study, and ``report.json``, which holds its first screen."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.output.html_report import page, paragraph, table
from palpate.output.report import first_screen
from palpate.output.report.plot_data import plot_data
from palpate.output.report.sections import sections
from palpate.output.results.answer import Answer
from palpate.output.results.law_candidates import UNDER, choice_sentences, choice_table
from palpate.output.saved_set import SavedSet

HERE = Path(__file__).parent
SCRIPTS = ("plotly-basic.min.js", "page.js")
Drawn = Callable[[str, SavedSet | None], str]  # a figure by name, of a set or of the study


def report_json(study: Study, sets: Sequence[SavedSet], made_from: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of ``report.json``: the answers, versions, seed, and the laws compared, if any."""
    chosen = {"law_choice": study.choice} if study.choice else {}
    return chosen | {
        "study": study.name,
        "sets": [Answer(saved).to_mapping() for saved in sets],
        "versions": {"python": made_from["python"], **made_from["libraries"], "commit": made_from["git_commit"]},
        "seed": study.seed,
    }


def write(
    study: Study,
    sets: Sequence[SavedSet],
    drawn: Drawn,
    snapshots: pd.DataFrame,
    made_from: Mapping[str, Any],
    path: Path,
) -> None:
    """Write the report.

    Parameters
    ----------
    study, sets
        The study, and the results of its sets of recordings.
    drawn
        Returns a figure of a set by its name, or of the study where the set is None, as HTML; nothing where there is
        none.
    snapshots
        The table of all snapshots.
    made_from
        Versions, seed and checksums, see `palpate.workflow_support.manifest.of`.
    path
        File that is written.
    """
    answers = [Answer(saved) for saved in sets]
    top = [f"<main><h1>{html.escape(study.title)}</h1>"]
    if not sets:
        top.append(paragraph("The study names no recordings: surrogates were made, nothing was calibrated.", "note"))
    elif not study.diagnosis.enabled:
        top.append(paragraph("The study does without a diagnosis: whether its law is enough was not tested.", "note"))
    top += [first_screen.overview(answers)] if len(answers) > 1 else [first_screen.answer(found) for found in answers]
    below: list[tuple[str, str, list[str]]] = []
    for found in answers:
        prefix = f"{found.saved.name}: " if len(answers) > 1 else ""
        if prefix:
            below.append((f"{prefix}answer", f"{found.saved.name}-answer", [first_screen.answer(found)]))
        for heading, pieces in sections(found, lambda name, saved=found.saved: drawn(name, saved)):  # type: ignore[misc]
            below.append((prefix + heading, f"{found.saved.name}-{heading}".replace(" ", "-").lower(), pieces))
    if study.choice:
        compared = [table(choice_table(study.choice)), paragraph(UNDER, "soft")]
        below.append(("Choice of the law", "law", [paragraph(choice_sentences(study.choice)), *compared]))
    below.append(("How the result was computed", "computed", _computed(study, answers, drawn, snapshots, made_from)))
    contents = "".join(f'<li><a href="#{key}">{html.escape(heading)}</a></li>' for heading, key, _ in below)
    body = [*top, f'<nav aria-label="Contents"><h2>Contents</h2><ol>{contents}</ol></nav>']
    for heading, key, pieces in below:
        body += [f'<section id="{key}"><h2>{html.escape(heading)}</h2>', *pieces, "</section>"]
    scripts = [plot_data(sets), *(f"<script>{_script(name)}</script>" for name in SCRIPTS)] if sets else []
    page(study.title, [*body, "</main>"], path, "\n".join(scripts))


def _script(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8").replace("</script", "<\\/script")


def _computed(
    study: Study, answers: Sequence[Answer], drawn: Drawn, snapshots: pd.DataFrame, made_from: Mapping[str, Any]
) -> list[str]:
    """Return surrogates, search history, source, versions and checksums, each folded."""
    failed = int((snapshots["status"] != "ok").sum())
    summaries = answers[0].saved.surrogates if answers else {}
    missing = [paragraph(summary["missing"], "note") for summary in summaries.values() if summary["missing"]]
    simulated = paragraph(f"{len(snapshots)} snapshots, {failed} failed.")
    pieces = [_folded("Snapshots and surrogates", [simulated, *missing, drawn("surrogates", None)])]
    text = paragraph(
        "The estimate is that of the finite elements themselves, by least squares from the optimum of the genetic "
        "search on surrogates, which is in calibration.json, and from points scattered over the ranges."
    )
    pieces += [_folded(f"Search: {found.saved.name}", [text, drawn("search", found.saved)]) for found in answers]
    if study.source:
        facts = "; ".join(f"{key} {value}" for key, value in study.source.items() if key not in ("file", "recordings"))
        pieces.append(_folded("Source of the recordings", [paragraph(facts)]))
    libraries = ", ".join(f"{name} {number}" for name, number in made_from["libraries"].items())
    versions = f"Python {made_from['python']}, {libraries}; commit {made_from['git_commit']}; seed {made_from['seed']}."
    files = pd.DataFrame({"file": made_from["files"].keys(), "SHA-256": made_from["files"].values()})
    origin = [paragraph(versions), f'<div class="files">{table(files)}</div>']
    return [*pieces, _folded("Inputs and versions", origin)]


def _folded(heading: str, pieces: Sequence[str]) -> str:
    return f"<details><summary>{html.escape(heading)}</summary>{''.join(pieces)}</details>"
