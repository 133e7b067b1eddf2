"""What a figure is: a table of numbers, how these are drawn, and what is said of them. One file a figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

Results = TypeVar("Results")
BROAD = 4.0  # inches, from which on a legend has three columns


@dataclass(frozen=True)
class PaperFigure(Generic[Results]):
    """One kind of figure of saved results, such as a `palpate.output.saved_set.SavedSet`.

    Parameters
    ----------
    name
        Of its files.
    title
        A few words.
    table
        Returns the numbers that are drawn; None where the results hold nothing to draw.
    draw
        Draws them on an empty figure, whose width is given and whose height it sets.
    caption
        Returns what is drawn, in sentences for readers of a paper.
    seen
        Returns what a look at the numbers shows, for those who cannot see the figure.
    of_study
        Whether all sets of recordings have the same one, because it shows none of them.
    """

    name: str
    title: str
    table: Callable[[Results], pd.DataFrame | None]
    draw: Callable[[Figure, pd.DataFrame], None]
    caption: Callable[[pd.DataFrame], str]
    seen: Callable[[pd.DataFrame], str]
    of_study: bool = False


def grid(figure: Figure, count: int, panel: tuple[float, float], most: int = 4) -> list[Axes]:
    """Return axes for `count` panels in rows that the width holds, and set the height [inch].

    Parameters
    ----------
    panel
        Least width and height of a panel [inch].
    most
        Panels of one row.
    """
    width = figure.get_figwidth()
    columns = max(1, min(most, count, int(width / panel[0])))
    rows = -(-count // columns)
    figure.set_figheight(rows * panel[1] + 0.45)
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for blank in axes[count:]:
        blank.set_visible(False)
    return list(axes[:count])


def bottom_row(axes: list[Axes], number: int) -> bool:
    """Return whether no panel lies below the one of that number."""
    return number + _columns(axes) >= len(axes)


def first_column(axes: list[Axes], number: int) -> bool:
    """Return whether a panel lies at the left end of its row."""
    return number % _columns(axes) == 0


def _columns(axes: list[Axes]) -> int:
    whole = axes[0].get_gridspec()
    return whole.ncols if whole else 1


def legend_below(figure: Figure, axis: Axes) -> None:
    """Write the legend of a panel below the figure, in as many columns as its width holds."""
    columns = 3 if figure.get_figwidth() > BROAD else 2
    figure.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=columns)
