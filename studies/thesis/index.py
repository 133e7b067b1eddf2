"""One page: every study of the thesis, its figure and tables beside the thesis' numbers, and a verdict on each."""

from __future__ import annotations

import datetime
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.output import html_report
from palpate.output.written_figures import shown
from studies.thesis.runs import Curves

ORDER = (
    "anova_aluminium",
    "rbf",
    "aluminium",
    "friction",
    "anova_epoxy",
    "sensitivity",
    "epoxy",
    "optimisers",
    "identifiability",
    "designs",
    "dimensionless",
    "baselines",
)
NOTES = (
    "The thesis' recordings are not public. Wherever its numbers rest on them, synthetic recordings of a known "
    "material take their place, and pattern and order are compared instead of digits.",
    "Snapshots are of small strains under a frictionless cone, but for the study of friction, which has both; the "
    "recordings are made with the same, so neither enters a calibration. The thesis had a friction of "
    "0.25; its own study of friction fits large strains alone, where 0.25 changes depths by less than 1 per cent.",
    "A verdict follows from the rule beside it: numbers that the thesis prints have a tolerance, numbers that it calls "
    "approximate must be met within a factor of two, orders and patterns must be the same.",
)


def write(
    outcomes: Mapping[str, Mapping[str, Any]],
    figures: Mapping[str, str | Path],
    curves: Sequence[Curves],
    path: str | Path,
    wall: str = "",
) -> None:
    """Write the page from saved outcomes, figures and curves; `wall` is the sentence of `elapsed`."""
    from studies.thesis import STUDIES
    from studies.thesis.figures import FIGURES

    keys = sorted(outcomes, key=lambda key: (ORDER.index(key) if key in ORDER else len(ORDER), key))
    sections = [
        ("What it took", [effort(outcomes, curves), html_report.paragraph(wall)]),
        ("Verdicts", [verdicts(outcomes, keys)]),
    ]
    for key in keys:
        outcome = outcomes[key]
        pieces = [findings_table(outcome["findings"]), shown(FIGURES[key], outcome, Path(figures[key]))]
        for title, rows in outcome["tables"].items():
            pieces.append(f"<details><summary>{title}</summary>{html_report.table(pd.DataFrame(rows))}</details>")
        sections.append((STUDIES[key].title, pieces))
    html_report.build("The thesis, reproduced", sections, NOTES, path)


def effort(outcomes: Mapping[str, Mapping[str, Any]], curves: Sequence[Curves]) -> str:
    """Say how many curves were simulated and how long everything took."""
    different, failed, coarser = set(), set(), set()
    for design in curves:
        accuracies = {labels.get("accuracy") for labels in design.labels}
        for labels, reason in zip(design.labels, design.reasons, strict=True):
            if labels["address"]:
                different.add(labels["address"])
                if reason:
                    failed.add(labels["address"])
                if len(accuracies) > 1 and labels["accuracy"] == "standard":
                    coarser.add(labels["address"])
    studies = sum(outcome["seconds"] for outcome in outcomes.values())
    return (
        f"<p>{len(different)} different curves, {len(failed)} of them failed, {len(coarser)} failed at fine accuracy "
        f"and are of standard accuracy; {studies:.0f} s in the studies beside the solver.</p>"
    )


def elapsed(began: datetime.datetime, now: datetime.datetime, files: Sequence[str | Path]) -> str:
    """Say how long this execution of the workflow has taken so far, and how much of the page it made itself."""
    own = sum(Path(file).stat().st_mtime >= began.timestamp() for file in files)
    return (
        f"This execution of the workflow began at {began:%Y-%m-%d %H:%M:%S} and wrote this page "
        f"{(now - began).total_seconds() / 60:.1f} minutes later; {own} of {len(files)} files of curves and tables "
        "were made in it, the others were there."
    )


def verdicts(outcomes: Mapping[str, Mapping[str, Any]], keys: Sequence[str]) -> str:
    """Count the verdicts, and list what differs."""
    found = [finding for key in keys for finding in outcomes[key]["findings"]]
    count = Counter(finding["verdict"] for finding in found)
    return (
        "<p>" + ", ".join(f"{number} {verdict}" for verdict, number in count.most_common()) + ".</p>"
        "<p>What differs:</p>" + findings_table([f for f in found if f["verdict"] == "differs"])
    )


def findings_table(findings: Sequence[Mapping[str, str]]) -> str:
    """Return findings as a table."""
    frame = pd.DataFrame(findings, columns=["what", "thesis", "here", "rule", "verdict", "why"])
    frame = frame.rename(columns={"why": "why, or what to bear in mind"})
    return re.sub("<(t[dh])>", r'<\1 style="text-align:left">', html_report.table(frame))
