"""How results are shown: tables as text, HTML for a notebook, and axes of Matplotlib."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.output import html_report
from palpate.output.figures.style import styled


def text_table(frame: pd.DataFrame) -> str:
    """Return a table as text, with numbers and headings as the report writes them."""
    return frame.astype(object).map(html_report.cell).rename(columns=html_report.heading).to_string(index=False)


def page(title: str, sentences: Sequence[str], *frames: pd.DataFrame) -> str:
    """Return a title, sentences and tables as HTML for a notebook."""
    head = f"<p><strong>{html.escape(title)}</strong></p>"
    return "\n".join([head, *map(html_report.paragraph, sentences), *map(html_report.table, frames)])


def axes_for(ax: Axes | None) -> Axes:
    """Return the axes to draw on: those given, or new ones, in the user's own style."""
    return plt.subplots(layout="constrained")[1] if ax is None else ax


@styled
def composed(compose: Callable[[Figure], None]) -> np.ndarray:
    """Draw a whole figure of the report with `compose`, and return its visible axes (n,)."""
    figure = plt.figure()
    compose(figure)
    return np.array([ax for ax in figure.axes if ax.axison])
