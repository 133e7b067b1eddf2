"""Convergence of the genetic algorithm: the smallest sum of objectives in each generation."""

from __future__ import annotations

from itertools import cycle

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.saved_set import SavedSet

UNITS = {"mean_square": "nm$^2$", "relative": "-"}
STYLES = ("-", "--", "-.", ":")


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return condition set, generation, the smallest sum of objectives in its front, and the unit."""
    rows = [
        {"condition_set": name, "generation": row["generation"], "best_sum": row["best_sum"]}
        | {"unit": UNITS[calibration["settings"]["objective"]]}
        for name, calibration in saved.calibrations.items()
        for row in calibration["history"]
    ]
    return pd.DataFrame(rows) if rows else None


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw one line a condition set."""
    figure.set_figheight(min(2.8, 0.75 * figure.get_figwidth()))
    axis = figure.subplots()
    for (name, part), style in zip(frame.groupby("condition_set", sort=False), cycle(STYLES)):
        axis.semilogy(part["generation"], part["best_sum"], style, label=name, lw=1.0)
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter(ScalarFormatter())
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("generation")
    axis.set_ylabel(f"sum of the objectives [{frame['unit'].iloc[0]}]")
    axis.legend(title="calibrated on")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Smallest sum of the conditions' objectives in the front of each generation of the genetic algorithm. Of "
        "several objectives a whole front survives, so that this sum may rise again."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return first and best value of each set."""
    parts = frame.groupby("condition_set", sort=False)["best_sum"]
    return "; ".join(f"{name} falls from {part.iloc[0]:.3g} to {part.min():.3g}" for name, part in parts) + "."


FIGURE = PaperFigure("search", "Genetic search on the surrogates", table, draw, caption, seen)
