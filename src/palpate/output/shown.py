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


class ShownCurve(Shown):
    """A recording with its points as arrays, as a table and as a curve."""

    recording: Recording

    time = property(lambda self: self.recording.time, doc="Time [s], shape (n,).")
    load = property(lambda self: self.recording.load, doc="Load [mN], shape (n,).")
    depth = property(lambda self: self.recording.depth, doc="Depth [nm], shape (n,).")

    def extent(self) -> str:
        """Return how long the recording lasts, and its depth at the largest load."""
        peak = int(np.argmax(self.load))
        return (
            f"{len(self.recording)} points in {np.ptp(self.time):.4g} s; at the largest load, {self.load[peak]:.4g} "
            f"mN, the depth is {self.depth[peak]:.4g} nm"
        )

    def to_frame(self) -> pd.DataFrame:
        """Return one row a point: time_s, load_mN, depth_nm, and stiffness_mN_per_nm where it was measured."""
        stiffness = self.recording.stiffness
        more = {} if stiffness is None else {"stiffness_mN_per_nm": stiffness}
        return pd.DataFrame({"time_s": self.time, "load_mN": self.load, "depth_nm": self.depth} | more)

    def draw(self, ax: Axes) -> None:
        """Draw the load over the depth with its labels."""
        raise NotImplementedError

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the load [mN] over the depth [nm] on `ax` or new axes, and return them."""
        ax = axes_for(ax)
        self.draw(ax)
        ax.set(xlabel="depth [nm]", ylabel="load [mN]")
        ax.legend()
        return ax


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
