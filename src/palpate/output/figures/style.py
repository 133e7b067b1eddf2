"""One look for all figures: sizes for a journal's columns, colours that print in grey, byte-identical files.

Series of lines have the colours of M. Okabe and K. Ito (2008), which people who confuse red and green can distinguish.
Drawing opens no window and leaves Matplotlib's own settings as they were.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
from cycler import cycler
from matplotlib.figure import Figure

RECORDED, SIMULATED, SURROGATE, TRUTH = "0.15", "#c1432e", "#2f6fa7", "#3f8f4f"
SERIES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#d55e00")
DOUBLE_COLUMN = 7.2  # inches

styled = matplotlib.rc_context(
    {
        "font.size": 8,
        "axes.titlesize": 8,
        "axes.prop_cycle": cycler(color=SERIES),
        "axes.spines.top": False,
        "axes.spines.right": False,
        "legend.frameon": False,
        "lines.linewidth": 1.2,
        "figure.constrained_layout.use": True,
        "savefig.dpi": 200,
    }
)
"""The look, as the decorator of a function that draws."""


def subplots(rows: int = 1, columns: int = 1, *, figsize: tuple[float, float], **more: Any) -> tuple[Figure, Any]:
    """Return a figure of a size [inch] and its axes; `more` is what `matplotlib.figure.Figure.subplots` takes."""
    figure = Figure(figsize=figsize)
    return figure, figure.subplots(rows, columns, **more)


def save(figure: Figure, path: str | Path) -> None:
    """Write a PNG that is the same, byte for byte, whenever its content is."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Software": None})


@styled
def write(path: str | Path, compose: Callable[..., None], *drawn: Any) -> None:
    """Write the figure that `compose`, such as `explained_curves.compose`, draws of what is `drawn`."""
    figure = Figure()
    compose(figure, *drawn)
    save(figure, path)


def mark_synthetic(figure: Figure, synthetic: bool) -> None:
    """Say on the figure itself that the recordings are not measured."""
    if synthetic:
        figure.text(
            0.995, 0.995, "synthetic recordings", ha="right", va="top", color="0.45", fontsize=7, style="italic"
        )
