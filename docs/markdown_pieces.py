"""Numbers, units and tables as the pages write them (Markdown)."""

from __future__ import annotations

import re
from collections.abc import Iterable


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a table (Markdown)."""
    head = list(head)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines) + "\n"


def number(value: float) -> str:
    """Return a number as people write it."""
    return re.sub(
        r"e([+-])0*(\d)",
        lambda found: f"e{found[1].strip('+')}{found[2]}",
        f"{value:.{4 if abs(value) < 1000 else 6}g}",
    )


def span(lower: float, upper: float) -> str:
    """Return a range, which no line breaks."""
    return f"{number(lower)} to {number(upper)}".replace(" ", "&nbsp;").replace("-", "&#8209;")


def unit(text: str) -> str:
    """Return a unit with raised exponents (HTML)."""
    raised = re.sub(r"\^(-?\([^)]*\)|-?\d+)", r"<sup>\1</sup>", text)
    return re.sub(r"m_(\w)", r"m<sub>\1</sub>", raised)
