"""A study's report: one HTML file that opens from disk, made of saved tables and figures alone."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template

import numpy as np
import pandas as pd

from palpate.inference.calibration_result import MOST_MISFIT

PAGE = Template("""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>$title</title>
<style>
 body {font: 15px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222}
 h1 {font-size: 1.5rem} h2 {font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #ddd}
 table {border-collapse: collapse; font-size: .88rem; margin: .8rem 0} th, td {padding: .2rem .7rem; text-align: right}
 th {border-bottom: 1px solid #999} td:first-child, th:first-child {text-align: left} img {max-width: 100%}
 .note {background: #fff6e0; padding: .5rem .8rem; border-left: 4px solid #d9a520}
</style>
<h1>$title</h1>
$body
</html>
""")


def image(path: str | Path, caption: str) -> str:
    """Return a figure with the picture inside it."""
    data = base64.b64encode(Path(path).read_bytes()).decode()
    return f'<figure><img src="data:image/png;base64,{data}" alt="{html.escape(caption)}"></figure>'


def paragraph(text: str) -> str:
    """Return a paragraph of plain text."""
    return f"<p>{html.escape(text)}</p>"


def table(frame: pd.DataFrame) -> str:
    """Return a table; numbers to four digits (a share close to one to six), yes or no, nothing where it is unknown."""
    return shown(frame).to_html(index=False, border=0)


def shown(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table with cells and headings as they are shown."""
    return frame.astype(object).map(cell).rename(columns=heading)


def heading(name: str) -> str:
    """Return what a table shows of a column's name: words, and the unit in brackets."""
    for unit in ("nm", "mN"):
        if name.endswith(f"_{unit}"):
            return f"{name.removesuffix(f'_{unit}').replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def cell(value: object) -> object:
    """Return what a table shows of one value."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.{6 if 0.999 < value < 1.0 else 4}g}"
    return "" if value is None else value


def build(title: str, sections: Sequence[tuple[str, Sequence[str]]], notes: Sequence[str], path: str | Path) -> None:
    """Write the report.

    Parameters
    ----------
    title
        Title of the page.
    path
        File that is written.
    sections
        Heading and pieces of HTML of each section.
    notes
        Sentences that a reader must not miss, shown first.
    """
    parts = [f'<p class="note">{html.escape(note)}</p>' for note in notes]
    for heading, pieces in sections:
        parts += [f"<h2>{html.escape(heading)}</h2>", *pieces]
    Path(path).write_text(PAGE.substitute(title=html.escape(title), body="\n".join(parts)), encoding="utf-8")


def misfit_sentence(calibration: Mapping) -> str:
    """Return how far simulation and recordings agree, and what that means."""
    errors = [entry["rmse_nm"] for entry in calibration["conditions"].values()]
    loads = [entry["rmse_mN"] for entry in calibration["conditions"].values() if "rmse_mN" in entry]
    span = f"Root mean square misfit {_span(errors)} nm over the conditions."
    if loads:
        span = (
            f"{span} Under displacement control the misfit of the load is {_span(loads)} mN; "
            "in nm it is the equivalent difference of depth under the same load."
        )
    if all(entry["replicates"] == 1 for entry in calibration["noise"].values()):
        return (
            f"{span} There are no replicates, so the noise of the recordings is not known: it was taken from the "
            "misfit itself, which therefore cannot test the model. Look at the misfit in time: a smooth pattern, "
            "rather than noise, means that the model lacks something."
        )
    ratio = calibration["misfit_ratio"]
    if ratio < MOST_MISFIT:
        return (
            f"{span} As a whole that is about the noise of the recordings (chi-square per degree of freedom: "
            f"{ratio:.2f}); a small effect may still be present, which the diagnosis tests."
        )
    return (
        f"{span} The model does not explain the recordings to their noise: chi-square per degree of freedom is "
        f"{ratio:.3g}. Something is missing from it; intervals are widened accordingly and may still be too narrow."
    )


def _span(errors: Sequence[float]) -> str:
    """Return the smallest and the largest error as text."""
    return f"{min(errors):.3g} to {max(errors):.3g}" if len(errors) > 1 else f"{errors[0]:.3g}"


def bound_sentence(calibration: Mapping) -> str:
    """Return which estimates lie outside their range, or at a limit of the law."""
    names = {key: [n for n, e in calibration["parameters"].items() if e[key]] for key in ("at_bound", "outside")}
    beyond = [name for name in names["outside"] if name not in names["at_bound"]]
    sentences = []
    if names["at_bound"]:
        sentences.append(f"At a limit: {', '.join(names['at_bound'])}; the other estimates may compensate for it.")
    if beyond:
        sentences.append(
            f"Outside the plausible range: {', '.join(beyond)}. Check the range, and that the law suits the material."
        )
    return " ".join(sentences)


def search_sentences(calibration: Mapping) -> str:
    """Return how the estimate was found, and whether the search converged."""
    found = (
        "The estimate is that of the finite elements themselves, by least squares from the optimum of the genetic "
        "search on surrogates, which is in calibration.json, and from points scattered over the ranges."
    )
    return " ".join(filter(None, (found, convergence_sentence(calibration))))


def convergence_sentence(calibration: Mapping) -> str:
    """Return what to do where the search has not converged; nothing where it has."""
    remedy = "hold parameters constant that the data cannot separate, or narrow the ranges"
    return "" if calibration["converged"] else f"The search has not converged: {remedy}."
