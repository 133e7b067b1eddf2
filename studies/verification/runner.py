"""Runs the cases and writes what they found: verification.json, figures drawn from it, and a page of HTML."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from palpate import __version__
from palpate.errors import PalpateError
from palpate.output import html_report
from studies.verification import figure
from studies.verification.case import Outcome, Row, Settings, Verification, not_run
from studies.verification.cases import CASES

VERDICT = {True: "yes", False: "NO", None: "not a check"}


def run(settings: Settings, report: Callable[[str], None]) -> dict[str, Any]:
    """Run every case; one that cannot run is reported in its notes and counts as a check that failed.

    Parameters
    ----------
    report
        Called with one line a case as it finishes.

    Returns
    -------
    dict
        The content of verification.json: `version`, `quick`, `passed`, `checks`, `failed`, and `cases` with their rows,
        plots and notes.
    """
    cases: list[dict[str, Any]] = []
    for case in CASES:
        began = time.perf_counter()
        outcome = _outcome(case, settings)
        rows = [_plain(row) for row in outcome.rows]
        checked = [row for row in rows if row["passed"] is not None]
        good = sum(row["passed"] for row in checked)
        seconds = time.perf_counter() - began
        report(f"{case.title}: {good} of {len(checked)} checks passed ({seconds:.1f} s)")
        cases.append(
            {
                "key": case.key,
                "title": case.title,
                "seconds": round(seconds, 1),
                "rows": rows,
                "plots": [asdict(plot) for plot in outcome.plots],
                "notes": list(outcome.notes),
            }
        )
    verdicts = [row["passed"] for case in cases for row in case["rows"] if row["passed"] is not None]
    return {
        "version": __version__,
        "quick": settings.quick,
        "passed": all(verdicts),
        "checks": len(verdicts),
        "failed": verdicts.count(False),
        "cases": cases,
    }


def _outcome(case: Verification, settings: Settings) -> Outcome:
    try:
        return case.run(settings)
    except PalpateError as error:
        return Outcome([not_run(case.title, error)], notes=[str(error)])


def _plain(row: Row) -> dict[str, Any]:
    return asdict(row) | {"deviation": row.deviation, "passed": row.passed}


def write(result: dict[str, Any], folder: Path) -> None:
    """Write verification.json, figures/*.png and report.html to `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    plain = json.loads(json.dumps(result), parse_constant=lambda _: None)
    (folder / "verification.json").write_text(json.dumps(plain, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    sections = []
    for case in result["cases"]:
        pieces = list(map(html_report.paragraph, case["notes"]))
        if case["rows"]:
            pieces.append(html_report.table(pd.DataFrame(list(_table(case["rows"])))))
        for plot in case["plots"]:
            path = folder / "figures" / f"{plot['name']}.png"
            figure.draw(plot, path)
            pieces.append(html_report.image(path, f"{case['title']}: {plot['name']}"))
        sections.append((case["title"], pieces))
    html_report.build(
        f"palpate {result['version']}: verification", sections, list(_notes(result)), folder / "report.html"
    )


def refuse_failed(result: dict[str, Any], report: Path) -> None:
    """Raise `PalpateError`, which names the report, when a check failed."""
    if result["failed"]:
        raise PalpateError(f"{result['failed']} of {result['checks']} checks failed; see {report}")


def _notes(result: dict[str, Any]) -> Iterator[str]:
    yield f"{result['checks'] - result['failed']} of {result['checks']} checks passed."
    for case in result["cases"]:
        for row in case["rows"]:
            if row["passed"] is False:
                yield f"Failed: {case['title']}: {row['quantity']}, deviation {100 * row['deviation']:.3g} %."
    if result["quick"]:
        yield "This was a quick run: fewer cases, CalculiX left out."


def _table(rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for row in rows:
        yield {
            "quantity": row["quantity"],
            "expected": row["expected"],
            "found": row["found"],
            "deviation [%]": _per_cent(row["deviation"]),
            "allowed [%]": _per_cent(row["allowed"]),
            "passed": VERDICT[row["passed"]],
            "note": row["note"],
        }


def _per_cent(value: float | None) -> str:
    return "" if value is None or math.isnan(value) else f"{100 * value:.2g}"
