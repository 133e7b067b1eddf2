"""How many evaluations each optimiser needs to come within 10, 1 and 0.1 per cent of the least value known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure, legend_below
from palpate.output.figures.style import BASE, RECORDED, SIMULATED, SMALLEST

LOOKS = {"10": ("0.65", "o"), "1": (BASE["color"], "D"), "0.1": (SIMULATED, "s")}
ACROSS = {"evaluations": "evaluations (cross: budget spent)", "seconds": "time [s]"}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a run and level, with evaluations and seconds to reach it; these are empty where it did not."""
    return pd.DataFrame(
        {"optimiser": run["optimiser"], "seed": run["seed"], "within_percent": level}
        | dict(zip(ACROSS, run["reached"].get(level, (None, None)), strict=True))
        | {"budget": outcome["series"]["budget"]}
        for run in outcome["series"]["runs"]
        for level in LOOKS
    )


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw every run as a mark: evaluations on the left, time on the right; a cross at the budget where it failed."""
    figure.set_figheight(3.2)
    names, budget = list(dict.fromkeys(frame["optimiser"])), frame["budget"].iloc[0]
    axes = figure.subplots(1, 2, sharey=True)
    for j, (level, (colour, marker)) in enumerate(LOOKS.items()):
        rows = frame[frame["within_percent"] == level]
        places = rows["optimiser"].map(names.index) + 0.25 * (j - 1)
        look = {"ls": "none", "marker": marker, "color": colour, "ms": 3.5, "alpha": 0.8, "label": f"within {level} %"}
        for axis, key in zip(axes, ACROSS, strict=True):
            axis.plot(rows[key], places, **look)
        for place, missed in places[rows["evaluations"].isna()].value_counts().items():
            axes[0].plot(1.3 * budget, place, "x", color=colour, ms=4)
            at = {"xytext": (5, -2), "textcoords": "offset points", "fontsize": SMALLEST}
            axes[0].annotate(f"{missed} runs", (1.3 * budget, place), **at)
    axes[0].axvline(budget, color=RECORDED, lw=0.6, ls=":")
    axes[0].set_yticks(range(len(names)), names)
    axes[0].invert_yaxis()
    for axis, label in zip(axes, ACROSS.values(), strict=True):
        axis.set(xscale="log", xlabel=label)
    legend_below(figure, axes[1])


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Evaluations of the surrogates, and time, that each run of each optimiser needs to come within 10, 1 and 0.1 % "
        f"of the least value known. Crosses: runs that did not within the budget of {frame['budget'].iloc[0]:g}."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return how many runs of each optimiser come closest."""
    close = frame[frame["within_percent"] == list(LOOKS)[-1]].groupby("optimiser", sort=False)["evaluations"]
    texts = (f"{name} {runs.notna().sum()} of {len(runs)}" for name, runs in close)
    return f"Runs that come within 0.1 %: {', '.join(texts)}."


FIGURE = PaperFigure("optimisers", "Optimisers on the same surrogates", table, draw, caption, seen, of_study=True)
