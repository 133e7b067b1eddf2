"""One page: every study of the thesis, its figure and tables beside the thesis' numbers, and a verdict on each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from palpate import report
from palpate.thesis.runs import Curves

ORDER = (
    "anova_aluminium",
    "rbf",
    "aluminium",
    "friction",
    "anova_epoxy",
    "sensitivity",
    "optimisers",
    "identifiability",
    "dimensionless",
    "baselines",
)
NOTES = (
    "The thesis' recordings are not public. Wherever its numbers rest on them, synthetic recordings of a known "
    "material take their place, and pattern and order are compared instead of digits.",
)


def write(
    outcomes: Mapping[str, Mapping[str, Any]],
    figures: Mapping[str, str | Path],
    curves: Sequence[Curves],
    path: str | Path,
) -> None:
    """Write the page from saved outcomes, figures and curves."""
    from palpate.thesis import STUDIES

    keys = sorted(outcomes, key=lambda key: (ORDER.index(key) if key in ORDER else len(ORDER), key))
    sections = [("What it took", [effort(outcomes, curves)]), ("Verdicts", [verdicts(outcomes, keys)])]
    for key in keys:
        outcome = outcomes[key]
        pieces = [findings_table(outcome["findings"]), report.image(figures[key], STUDIES[key].title)]
        for title, rows in outcome["tables"].items():
            pieces.append(f"<details><summary>{title}</summary>{report.table(pd.DataFrame(rows))}</details>")
        sections.append((STUDIES[key].title, pieces))
    report.build("The thesis, reproduced", sections, NOTES, path)


def effort(outcomes: Mapping[str, Mapping[str, Any]], curves: Sequence[Curves]) -> str:
    """Say how many curves were simulated and how long everything took."""
    seconds: dict[str, float] = {}
    failed = set()
    for design in curves:
        for labels, reason, spent in zip(design.labels, design.reasons, design.seconds, strict=True):
            if labels["address"]:
                seconds[labels["address"]] = float(spent)
                if reason:
                    failed.add(labels["address"])
    solver, studies = sum(seconds.values()), sum(outcome["seconds"] for outcome in outcomes.values())
    return (
        f"<p>{len(seconds)} different curves, {len(failed)} of them failed; {solver:.0f} s in the solver, "
        f"{studies:.0f} s in the studies: {(solver + studies) / 60:.1f} min of one core in all.</p>"
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
    frame = pd.DataFrame(findings, columns=["what", "thesis", "here", "verdict", "why"])
    return report.table(frame).replace("<td>", '<td style="text-align:left">')
