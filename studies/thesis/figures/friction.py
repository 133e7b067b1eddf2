"""Friction: by how much it makes the largest and the residual depth shallower, over loading times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure, legend_below
from palpate.output.figures.style import BASE, RECORDED, SIMULATED

LOOKS = {0.125: ("0.6", "o-", 3.5), 0.25: (BASE["color"], "o--", 3.5), 0.5: (SIMULATED, "s-", 6)}
DEPTHS = {"max_depth": "largest depth", "residual_depth": "residual depth"}
LOAD = 1.0  # mN, of the tests that are drawn


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a test, coefficient of friction and kind of strains."""
    return pd.DataFrame(outcome["series"]["rows"])


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw both depths, for small and large strains; panels without curves say so."""
    figure.set_figheight(4.6)
    axes = figure.subplots(2, 2, sharex=True)
    for row, kinematics in zip(axes, ("small", "large"), strict=True):
        for axis, (depth, title) in zip(row, DEPTHS.items(), strict=True):
            _panel(axis, frame[frame["kinematics"] == kinematics], f"{depth}_reduction_percent")
            axis.set_title(f"{title}, {kinematics} strains")
        row[0].set_ylabel("reduction of the depth [%]")
    for axis in axes[-1]:
        axis.set_xlabel("loading time [s]")
    legend_below(figure, axes[-1, 0])


def _panel(axis, frame: pd.DataFrame, key: str) -> None:
    known = frame[(frame["max_load"] == LOAD) & frame[key].notna()].sort_values("loading_time")
    times = sorted(set(frame["loading_time"]))
    for coefficient, (colour, style, size) in LOOKS.items():
        own = known[known["friction"] == coefficient]
        axis.semilogx(
            own["loading_time"], own[key], style, ms=size, mfc="none", color=colour, label=f"f = {coefficient:g}"
        )
    axis.axhline(0, color=RECORDED, lw=0.5)
    axis.set_xticks(times, [f"{time:g}" for time in times])
    axis.minorticks_off()
    if known.empty:
        axis.text(0.5, 0.5, "not run", ha="center", va="center", transform=axis.transAxes)


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        f"By how much friction between tip and sample makes tests of {LOAD:g} mN shallower than without friction, over "
        "the loading time, at the largest load and after unloading."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the largest reduction of both depths."""
    texts = (f"{title} by at most {frame[f'{depth}_reduction_percent'].max():.2g} %" for depth, title in DEPTHS.items())
    return f"Friction reduces the {' and the '.join(texts)}."


FIGURE = PaperFigure("friction", "Friction", table, draw, caption, seen, of_study=True)
