"""Aluminium from end to end: recorded and simulated curves, residuals, and parameters with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import ACCEPTED, BASE, RECORDED
from studies.thesis.figures.estimates import ALUMINIUM, interval, ranged

LOOKS = {"64": ACCEPTED, "36": BASE}  # by the number of snapshots


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a point of the curves, then one a parameter and grid with interval, truth and range."""
    series = outcome["series"]
    curves = {"time_s": series["time"], "load_mN": series["load"], "recorded_nm": series["recorded"]}
    curves |= {f"{source}_{grid}_nm": series[f"{source}_{grid}"] for grid in LOOKS for source in ("surrogate", "fe")}
    parameters = ranged(outcome["tables"]["parameters"], series["bounds"])
    return pd.concat([pd.DataFrame(curves), parameters], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw both fits on the left; on the right the parameters over the ranges searched."""
    figure.set_figheight(3.4)
    curves, parameters = frame[frame["time_s"].notna()], frame[frame["parameter"].notna()]
    left, right = figure.subfigures(1, 2, squeeze=False)[0]
    upper, lower = left.subplots(2, 1, height_ratios=[2, 1])
    recorded = curves["recorded_nm"]
    upper.plot(recorded, curves["load_mN"], "o", color=RECORDED, ms=3, mfc="none", mew=0.6, label="recorded")
    for grid, look in LOOKS.items():
        upper.plot(curves[f"surrogate_{grid}_nm"], curves["load_mN"], label=f"surrogate, {grid} points", **look)
        lower.plot(curves["time_s"], curves[f"surrogate_{grid}_nm"] - recorded, **look)
        solver = look | {"linestyle": ":"}
        lower.plot(curves["time_s"], curves[f"fe_{grid}_nm"] - recorded, label=f"finite elements, {grid}", **solver)
    upper.set(xlabel="depth [nm]", ylabel="load [mN]", xlim=(0, None))
    lower.set(xlabel="time [s]", ylabel="residual [nm]")
    upper.legend()
    lower.legend()
    for axis, (name, symbol) in zip(right.subplots(len(ALUMINIUM), 1), ALUMINIUM.items(), strict=True):
        for _, row in parameters[parameters["parameter"] == name].iterrows():
            interval(axis, row, list(LOOKS).index(row["snapshots"]), LOOKS[row["snapshots"]]["color"])
        axis.set_yticks(range(len(LOOKS)), [f"{grid} points" for grid in LOOKS])
        axis.set_ylim(len(LOOKS) - 0.4, -0.6)
        axis.set_xlabel(f"{symbol} [GPa]")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Aluminium, calibrated on surrogates of 64 and of 36 snapshots. Left: load over depth, and simulated less "
        "recorded depth; dotted: the finite elements at the same parameters. Right: estimates with 95 % intervals over "
        "the ranges searched; open symbols: not identified; dashed: true value."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return how far the surrogates' curves lie from the recorded one."""
    off = {grid: (frame[f"surrogate_{grid}_nm"] - frame["recorded_nm"]).abs().max() for grid in LOOKS}
    texts = (f"{largest:.3g} nm on {grid} snapshots" for grid, largest in off.items())
    return f"The fitted surrogates differ from the recorded curve by at most {' and '.join(texts)}."


FIGURE = PaperFigure("aluminium", "Aluminium: calibration", table, draw, caption, seen)
