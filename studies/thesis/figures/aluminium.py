"""Aluminium from end to end: recorded and simulated curves, misfit, and parameters with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from palpate.output.figures.style import (
    DOUBLE_COLUMN,
    RECORDED,
    SIMULATED,
    SURROGATE,
    mark_synthetic,
    save,
    styled,
)
from studies.thesis.figures.estimates import ALUMINIUM, interval

COLOURS = {"64": SIMULATED, "36": SURROGATE}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw the fit of both surrogates on the left, parameters on the right, over the ranges searched."""
    series, rows = outcome["series"], outcome["tables"]["parameters"]
    figure = Figure(figsize=(DOUBLE_COLUMN, 3.2))
    left, right = figure.subfigures(1, 2, squeeze=False)[0]
    upper, lower = left.subplots(2, 1, gridspec_kw={"height_ratios": [2, 1]})
    recorded = np.array(series["recorded"])
    upper.plot(recorded, series["load"], "o", color=RECORDED, ms=3, mfc="none", mew=0.6, label="recorded")
    for grid, colour in COLOURS.items():
        fit, solver = (np.array(series[f"{source}_{grid}"]) for source in ("surrogate", "fe"))
        upper.plot(fit, series["load"], color=colour, lw=1, label=f"surrogate, {grid} points")
        lower.plot(series["time"], fit - recorded, color=colour, lw=1)
        lower.plot(series["time"], solver - recorded, ":", color=colour, lw=1)
    lower.plot([], [], ":", color="0.3", label="finite elements, one mesh")
    lower.legend(fontsize=6, loc="upper left", borderaxespad=0)
    upper.set_xlabel("depth [nm]")
    upper.set_ylabel("load [mN]")
    upper.set_xlim(left=0)
    upper.legend(fontsize=7)
    lower.axhline(0, color="0.7", lw=0.6)
    lower.set_xlabel("time [s]")
    lower.set_ylabel("sim. - rec.\n[nm]")
    for axis, (name, symbol) in zip(right.subplots(3, 1), ALUMINIUM.items(), strict=True):
        for k, (grid, colour) in enumerate(COLOURS.items()):
            row = next(r for r in rows if (r["snapshots"], r["parameter"]) == (grid, name))
            interval(axis, row, k, colour)
        axis.set_yticks([0, 1], [f"{grid} points" for grid in COLOURS])
        axis.set_ylim(1.6, -0.6)
        axis.set_xlim(*series["bounds"][name])
        axis.set_xlabel(f"{symbol} [GPa]")
    figure.suptitle("bars: 95 % intervals; open: not identified; dashed: truth", fontsize=8)
    mark_synthetic(figure, True)
    save(figure, path)
