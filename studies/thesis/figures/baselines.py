"""Classical analyses: the modulus each finds, and closed forms against the solver on two recordings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure, legend_below
from palpate.output.figures.style import ACCEPTED, BASE, RECORDED, SMALLEST

LOOKS: dict[str, tuple[str, dict[str, Any]]] = {
    "loading and hold": ("closed form, loading and hold", {"color": "0.15", "linestyle": ":", "linewidth": 1.2}),
    "whole": ("closed form with Ting's unloading", BASE),
    "solver": ("finite elements", ACCEPTED),
}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a recording and classical method, then one a recording and time with the fitted depths."""
    series = outcome["series"]
    moduli = pd.DataFrame(series["moduli"])[["recording", "method", "modulus_GPa", "truth_GPa", "error_percent"]]
    curves = [
        pd.DataFrame({"recording": name, "time_s": part["time"], "recorded_nm": part["depth"]})
        .assign(**{f"{key}_nm": pd.Series(part[key], dtype=float) for key in LOOKS})
        for name, part in series["curves"].items()
    ]  # fmt: skip
    return pd.concat([moduli, *curves], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw errors of the modulus above; curves and residuals below."""
    figure.set_figheight(5.8)
    top, bottom = figure.subfigures(2, 1, height_ratios=[1, 1.5], squeeze=False)[:, 0]
    _moduli(top.subplots(), frame[frame["method"].notna()])
    axes = bottom.subplots(2, 2, height_ratios=[2, 1], sharex=True)
    curves = frame[frame["time_s"].notna()].groupby("recording", sort=False)
    for (upper, lower), (name, part) in zip(axes.T, curves, strict=True):
        upper.plot(
            part["time_s"], part["recorded_nm"], "o", color=RECORDED, ms=2, mfc="none", mew=0.5, label="recorded"
        )
        for key, (label, look) in LOOKS.items():
            upper.plot(part["time_s"], part[f"{key}_nm"], label=label, **look)
            lower.plot(part["time_s"], part[f"{key}_nm"] - part["recorded_nm"], **look)
        upper.set_title(name)
        lower.axhline(0, color="0.7", lw=0.6)
        lower.set_xlabel("time [s]")
    axes[0, 0].set_ylabel("depth [nm]")
    axes[1, 0].set_ylabel("residual [nm]")
    legend_below(figure, axes[0, 0])


def _moduli(axis, rows: pd.DataFrame) -> None:
    colours = [ACCEPTED["color"] if "Ngan" in method else BASE["color"] for method in rows["method"]]
    bars = axis.barh(range(len(rows)), rows["error_percent"], color=colours)
    axis.bar_label(bars, fmt="%+.1f", fontsize=SMALLEST, padding=2)
    axis.set_yticks(range(len(rows)), rows["recording"] + "; " + rows["method"])
    axis.invert_yaxis()
    axis.margins(x=0.15)
    axis.axvline(0, color="black", lw=0.6)
    axis.set_xlabel("error of Young's modulus [%]")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Above: error of Young's modulus by Oliver and Pharr, without and (dark) with Ngan's correction for creep. "
        "Below: depth over time, and fitted less recorded depth, of closed forms of the linear Burgers solid and of "
        "the finite elements, each fitted to the same recording."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the smallest and the largest error of the modulus."""
    rows = frame[frame["method"].notna()]
    ends = rows.sort_values("error_percent").iloc[[0, -1]].to_dict("records")
    texts = (f"{row['error_percent']:+.1f} % ({row['recording']}; {row['method']})" for row in ends)
    return f"Errors of the modulus range from {' to '.join(texts)}."


FIGURE = PaperFigure("baselines", "Classical analyses", table, draw, caption, seen)
