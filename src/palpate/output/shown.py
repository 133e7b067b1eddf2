"""How results are shown: tables as text, HTML for a notebook, and axes of Matplotlib."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from indentation_files.recording import Recording
from palpate.output import html_report
from palpate.output.figures.style import DOUBLE_COLUMN, styled


class Shown:
    """A result with a summary and a view in a notebook, from its sentences and tables."""

    def sentences(self) -> Sequence[str]:
        """Return sentences on the result."""
        raise NotImplementedError

    def tables(self) -> Sequence[pd.DataFrame]:
        """Return the tables that belong to it."""
        return ()

    def summary(self) -> str:
        """Return the result as text: what it is, sentences on it, then tables."""
        return "\n\n".join(["\n".join([repr(self), *self.sentences()]), *map(text_table, self.tables())])

    def _repr_html_(self) -> str:
        head = f"<p><strong>{html.escape(repr(self).strip('<>'))}</strong></p>"
        return "\n".join([head, *map(html_report.paragraph, self.sentences()), *map(html_report.table, self.tables())])


def text_table(frame: pd.DataFrame) -> str:
    """Return a table as text, with numbers and headings as the report writes them."""
    return html_report.shown(frame).to_string(index=False)


def extent(recording: Recording) -> str:
    """Return how long a recording lasts, and its depth at the largest load."""
    peak = int(np.argmax(recording.load))
    return (
        f"{len(recording)} points in {np.ptp(recording.time):.4g} s; at the largest load, {recording.load[peak]:.4g} "
        f"mN, the depth is {recording.depth[peak]:.4g} nm"
    )


def frame_of(recording: Recording) -> pd.DataFrame:
    """Return one row a point: time_s, load_mN, depth_nm, and stiffness_mN_per_nm where it was measured."""
    columns = {"time_s": recording.time, "load_mN": recording.load, "depth_nm": recording.depth}
    more = {} if recording.stiffness is None else {"stiffness_mN_per_nm": recording.stiffness}
    return pd.DataFrame(columns | more)


def axes_for(ax: Axes | None) -> Axes:
    """Return the axes to draw on: those given, or new ones, in the user's own style."""
    from matplotlib import pyplot as plt  # which chooses a window or Jupyter: only where a notebook draws

    return plt.subplots(layout="constrained")[1] if ax is None else ax


@styled
def composed(draw: Callable[..., None], *numbers: Any) -> np.ndarray:
    """Draw a whole figure of the report with `draw`, and return its visible axes (n,)."""
    from matplotlib import pyplot as plt

    figure: Figure = plt.figure(figsize=(DOUBLE_COLUMN, 0.62 * DOUBLE_COLUMN))
    draw(figure, *numbers)
    return np.array([ax for ax in figure.axes if ax.axison and ax.get_visible()])
