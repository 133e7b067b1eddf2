"""Classical analyses: the modulus each finds, and closed forms against the solver on two recordings."""

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
    TRUTH,
    mark_synthetic,
    save,
    styled,
)

STYLES = {
    "loading and hold": ("closed form, loading and hold", TRUTH, "-"),
    "whole": ("closed form with Ting's unloading", SURROGATE, "-"),
    "solver": ("the solver", SIMULATED, "--"),
}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw errors of the modulus above; curves and misfits below."""
    series = outcome["series"]
    figure = Figure(figsize=(DOUBLE_COLUMN, 5.6))
    top, bottom = figure.subfigures(2, 1, height_ratios=[1, 1.5], squeeze=False)[:, 0]
    axis = top.subplots()
    rows = series["moduli"]
    colours = [SIMULATED if "Ngan" in row["method"] else "0.6" for row in rows]
    bars = axis.barh(range(len(rows)), [row["error_percent"] for row in rows], color=colours)
    axis.bar_label(bars, fmt="%+.1f", fontsize=6.5, padding=2)
    axis.set_yticks(range(len(rows)), [f"{row['recording']}; {row['method']}" for row in rows], fontsize=7)
    axis.invert_yaxis()
    axis.margins(x=0.15)
    axis.axvline(0, color="black", lw=0.6)
    axis.set_xlabel("error of Young's modulus [%]")
    axes = bottom.subplots(2, 2, gridspec_kw={"height_ratios": [2, 1]}, sharex=True)
    for (upper, lower), (name, part) in zip(axes.T, series["curves"].items(), strict=True):
        recorded = np.array(part["depth"])
        upper.plot(part["time"], recorded, "o", color=RECORDED, ms=2, mfc="none", mew=0.5, label="recorded")
        for key, (label, colour, style) in STYLES.items():
            curve = np.array(part[key], dtype=float)
            upper.plot(part["time"], curve, style, color=colour, lw=1, label=label)
            lower.plot(part["time"], curve - recorded, style, color=colour, lw=0.8)
        upper.set_title(name)
        lower.axhline(0, color="0.7", lw=0.6)
        lower.set_xlabel("time [s]")
    axes[0, 0].set_ylabel("depth [nm]")
    axes[1, 0].set_ylabel("fit - rec. [nm]")
    axes[0, 0].legend(fontsize=6.5)
    mark_synthetic(figure, True)
    save(figure, path)
