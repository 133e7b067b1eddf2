"""One look for all figures: sizes for a journal's columns, lines that print in grey, byte-identical files.

The curves of the base model and of the accepted model differ in style and in luminance, so that they are told apart in
grey print. Series of lines have the colours of M. Okabe and K. Ito (2008), which people who confuse red and green can
distinguish. Drawing opens no window and leaves Matplotlib's own settings as they were.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
from cycler import cycler
from matplotlib.figure import Figure

RECORDED, SIMULATED, SURROGATE, TRUTH = "0.15", "#a8181f", "#2f6fa7", "#3f8f4f"
BASE: dict[str, Any] = {"color": "#62a8d4", "linestyle": (0, (4, 1.6)), "linewidth": 1.3}  # luminance 0.35
ACCEPTED: dict[str, Any] = {"color": SIMULATED, "linestyle": "-", "linewidth": 1.2}  # luminance 0.09
SERIES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#d55e00")
DOUBLE_COLUMN = 7.2  # inches
SMALLEST = 7  # pt, of any text
LETTERS = 14  # of a title in an inch of width
RESOLUTION = 300  # dots per inch of a raster image

LOOK: dict[Any, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": SMALLEST,
    "ytick.labelsize": SMALLEST,
    "legend.fontsize": SMALLEST,
    "legend.title_fontsize": SMALLEST,
    "figure.titlesize": 9,
    "figure.labelsize": 8,
    "axes.prop_cycle": cycler(color=SERIES),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "mathtext.default": "it",
    "figure.constrained_layout.use": True,
    "savefig.dpi": RESOLUTION,
    "pdf.fonttype": 42,  # text as text
    "svg.fonttype": "none",
    "svg.hashsalt": "palpate",
}
UNDATED = {
    "pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}

styled = matplotlib.rc_context(LOOK)
"""The look, as the decorator of a function that draws."""


def subplots(rows: int = 1, columns: int = 1, *, figsize: tuple[float, float], **more: Any) -> tuple[Figure, Any]:
    """Return a figure of a size [inch] and its axes; `more` is what `matplotlib.figure.Figure.subplots` takes."""
    figure = Figure(figsize=figsize)
    return figure, figure.subplots(rows, columns, **more)


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure, of the format that the path ends in, as a file that is the same whenever its content is."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata=UNDATED[Path(path).suffix[1:]])


def headed(figure: Figure, title: str, synthetic: bool) -> None:
    """Write the title above a figure, if there is one, and that the recordings are not measured, where they are not."""
    marked = "synthetic recordings" if synthetic else ""
    if title:
        room, mark = round(LETTERS * figure.get_figwidth()), f"({marked})" if marked else ""
        between = "   " if len(title) + 3 + len(mark) <= room else "\n"
        figure.suptitle(between.join(filter(None, (textwrap.fill(title, room), mark))))
    elif marked:
        figure.suptitle(marked, fontsize=SMALLEST, style="italic", color="0.35")


def drawn(draw: Callable[..., None], *numbers: Any, width: float = DOUBLE_COLUMN) -> Figure:
    """Return a figure of a width [inch] on which `draw` has drawn; to be called within `styled` or the user's style."""
    figure = Figure(figsize=(width, 0.62 * width))
    draw(figure, *numbers)
    return figure
