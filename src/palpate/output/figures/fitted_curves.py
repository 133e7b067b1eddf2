"""Curves of every condition, recorded against simulated, with the misfit in time underneath.

Under load control the load is drawn over the depth; under displacement control over the time.
"""

from __future__ import annotations

import textwrap
from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, SERIES, SIMULATED, SURROGATE, mark_synthetic


def compose(figure: Figure, curves: pd.DataFrame, title: str, synthetic: bool) -> None:
    """Draw one column a condition on an empty figure, which takes the size that this needs.

    Parameters
    ----------
    figure, title, synthetic
        See `palpate.output.figures.explained_curves.compose`.
    curves
        Table of `palpate.workflow_support.steps.curves_beside`.
    """
    names = list(dict.fromkeys(curves["condition"]))
    columns = min(4, len(names))
    rows = -(-len(names) // columns)
    figure.set_size_inches(DOUBLE_COLUMN if columns > 1 else 4.2, 3.3 * rows + 0.4)
    parts = figure.subfigures(rows, 1, squeeze=False)[:, 0]
    for row, part in enumerate(parts):
        members = names[row * columns : (row + 1) * columns]
        axes = part.subplots(2, columns, gridspec_kw={"height_ratios": [3, 1]}, squeeze=False)
        for blank in axes[:, len(members) :].ravel():
            blank.set_axis_off()
        for k, (name, upper, lower) in enumerate(zip(members, axes[0], axes[1], strict=False)):
            _condition(curves[curves["condition"] == name], upper, lower)
            if k == 0:
                upper.set_ylabel("load [mN]")
            if k == 0 and row == 0:
                upper.legend(loc="best", fontsize=6.5, handlelength=1.4, borderaxespad=0.0)
    handles, labels = axes[1, 0].get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower right", fontsize=6.5)
    figure.suptitle(textwrap.fill(title, 100 if columns > 1 else 52), fontsize=9)
    mark_synthetic(figure, synthetic)


def together(axis: Axes, curves: pd.DataFrame) -> None:
    """Draw the recorded and the simulated curves of all conditions on the same axes, one colour a condition."""
    units = {unit_of(curve) for _, curve in curves.groupby("condition", sort=False)}
    for (name, curve), colour in zip(curves.groupby("condition", sort=False), cycle(SERIES)):
        unit = unit_of(curve)
        for values, style in ((curve[f"recorded_{unit}"], "o"), (curve[f"simulated_{unit}"], "-")):
            label = str(name) if style == "-" else None
            axis.plot(*_drawn(curve, values), style, color=colour, ms=2.5, mfc="none", mew=0.6, label=label)
    axis.set_xlabel(" or ".join("depth [nm]" if unit == "nm" else "time [s]" for unit in sorted(units)))
    axis.set_ylabel("load [mN]")
    axis.set_title("points: recorded; lines: finite elements")
    axis.legend()


def _condition(curve, upper, lower) -> None:
    unit = unit_of(curve)
    recorded, simulated, surrogate, spread = (
        curve[f"{name}_{unit}"] for name in ("recorded", "simulated", "surrogate", "spread")
    )
    upper.plot(*_drawn(curve, recorded), "o", color=RECORDED, ms=2.2, mfc="none", mew=0.5, label="recorded")
    upper.plot(*_drawn(curve, simulated), "-", color=SIMULATED, label="finite elements")
    if surrogate.notna().any():
        upper.plot(*_drawn(curve, surrogate), color=SURROGATE, lw=3.0, alpha=0.35, zorder=0, label="surrogates")
    error = recorded - simulated
    rmse = np.sqrt(np.mean(error**2))
    shown = f"{rmse:.1f} nm" if unit == "nm" else f"{rmse:.2g} mN"
    upper.set_title(f"{curve['condition'].iloc[0]}\n{curve['role'].iloc[0]}\nRMSE {shown}")
    upper.set_xlabel("depth [nm]" if unit == "nm" else "time [s]")
    upper.set_xlim(left=0)
    upper.set_ylim(bottom=0)
    lower.axhline(0, color="0.7", lw=0.6)
    if spread.notna().any():
        band = lower.fill_between(curve["time_s"], -spread, spread, color="0.88", lw=0)
        band.set_label("standard deviation of the replicates")
    lower.plot(curve["time_s"], error, color=SIMULATED, lw=0.9)
    lower.set_xlabel("time [s]")
    lower.set_ylabel(f"rec. - sim.\n[{unit}]")


def _drawn(curve: pd.DataFrame, response: pd.Series) -> tuple[pd.Series, pd.Series]:
    """Return what is drawn of a response: the load over a depth, a load over the time."""
    return (response, curve["load_mN"]) if unit_of(curve) == "nm" else (curve["time_s"], response)


def unit_of(curve: pd.DataFrame) -> str:
    """Return the unit of the response in a condition's part of a table of curves."""
    return "mN" if "recorded_mN" in curve and curve["recorded_mN"].notna().any() else "nm"
