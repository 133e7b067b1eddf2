"""Pages that open from disk: one HTML file, in light or dark, made of saved tables and figures alone."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template

import numpy as np
import pandas as pd

from palpate.base.rounding import rounded, unit_html
from palpate.observables import UNITS

PAGE = Template("""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<link rel="icon" href="data:,">
<style>
$style
</style>
</head>
<body>
$body
$script
</body>
</html>
""")
STYLE = Path(__file__).with_name("page.css")
MINUS = re.compile(r"(?<![\w.)\]])-(?=\d)")  # before a number, where a hyphen stands for it
NUMBER = re.compile(r"|[-−+<>]? ?\d+(\.\d+)?( × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?( %| nm| mN)?")  # none, or one with a short unit
TYPES = {".png": "image/png", ".svg": "image/svg+xml"}


def image(path: str | Path, seen: str, caption: str = "") -> str:
    """Return a figure with the picture inside it.

    Parameters
    ----------
    seen
        What is seen on it, for those who cannot look at it.
    caption
        Shown below it.
    """
    data = base64.b64encode(Path(path).read_bytes()).decode()
    below = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    source = f"data:{TYPES[Path(path).suffix]};base64,{data}"
    return f'<figure><img src="{source}" alt="{html.escape(seen)}">{below}</figure>'


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph of plain text."""
    return f"<p{f' class={kind!r}' if kind else ''}>{escaped(text)}</p>"


def escaped(text: str) -> str:
    """Return plain text as HTML, in which no line ends before a per cent sign."""
    return html.escape(text).replace(" %", "\u00a0%")


def table(frame: pd.DataFrame, caption: str = "") -> str:
    """Return a table; numbers to three digits (a share close to one to six), yes or no, nothing where it is unknown.

    A column ``unit`` is joined to its neighbour at the left, and shown with raised exponents.
    """
    units = frame["unit"].map(unit_html) if "unit" in frame else None
    cells = shown(frame.drop(columns="unit", errors="ignore"))
    numeric = [name for name in cells if cells[name].map(_is_number).all() and len(cells)]
    above = f"<caption>{escaped(caption)}</caption>" if caption else ""
    head = "".join(f"<th{' class=number' if name in numeric else ''}>{html.escape(str(name))}</th>" for name in cells)
    rows = []
    for k, row in enumerate(cells.itertuples(index=False)):
        texts = [MINUS.sub("−", html.escape(str(value))) for value in row]
        if units is not None and units.iloc[k] and texts:
            texts[0] += f" [{units.iloc[k]}]"
        marks = [" class=number" if name in numeric else "" for name in cells]
        rows.append("<tr>" + "".join(f"<td{m}>{t}</td>" for m, t in zip(marks, texts, strict=True)) + "</tr>")
    body = "\n".join(rows)
    return f'<div class="wide"><table>{above}<thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table></div>'


def _is_number(text: object) -> bool:
    return bool(NUMBER.fullmatch(str(text)))


def shown(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table with cells and headings as they are shown."""
    return frame.astype(object).map(cell).rename(columns=heading)


def heading(name: str) -> str:
    """Return what a table shows of a column's name: words, and the unit in brackets."""
    for unit in UNITS:
        if name.endswith(f"_{unit}"):
            return f"{name.removesuffix(f'_{unit}').replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def cell(value: object) -> object:
    """Return what a table shows of one value."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if np.isnan(value) else rounded(value, 6 if 0.999 < value < 1.0 else 3) if value % 1 else f"{value:g}"
    return "" if value is None else value


def page(title: str, body: Sequence[str], path: str | Path, script: str = "") -> None:
    """Write a page.

    Parameters
    ----------
    title
        Plain text.
    body
        Pieces of HTML.
    path
        File that is written.
    script
        Elements at the end of the page.
    """
    style = STYLE.read_text(encoding="utf-8")
    text = PAGE.substitute(title=html.escape(title), style=style, body="\n".join(body), script=script)
    Path(path).write_text(text, encoding="utf-8")


def build(title: str, sections: Sequence[tuple[str, Sequence[str]]], notes: Sequence[str], path: str | Path) -> None:
    """Write a page of sections.

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
    parts = [f"<h1>{html.escape(title)}</h1>", *(paragraph(note, "note") for note in notes)]
    for heading, pieces in sections:
        parts += [f"<h2>{html.escape(heading)}</h2>", *pieces]
    page(title, parts, path)


def definitions(rows: Mapping[str, str]) -> str:
    """Return a list of terms with what is said of each, as plain text."""
    return "<dl>" + "".join(f"<dt>{html.escape(k)}</dt><dd>{escaped(v)}</dd>" for k, v in rows.items()) + "</dl>"
