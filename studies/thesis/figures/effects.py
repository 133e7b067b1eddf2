"""The figure that both analyses of variance share: contributions beside the thesis', and main effects."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.base.parameters import in_words
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import ACCEPTED, BASE, RECORDED, SMALLEST

SHARES = {"thesis": "thesis, error", "contributions": "error", "depth_contributions": "largest depth"}
FACES: tuple[dict[str, Any], ...] = (
    {"color": "white", "edgecolor": "0.3", "hatch": "////"},
    {"color": ACCEPTED["color"]},
    {"color": BASE["color"]},
)
EFFECTS = {"main_effects": "mean_error", "depth_effects": "mean_depth"}


def analysis_of_variance(name: str, title: str, symbols: Mapping[str, str], unit: str) -> PaperFigure:
    """Return the figure of an analysis of variance; `unit` is that of the error, and symbols are those of factors."""
    drawn, captioned = partial(draw, symbols=symbols, unit=unit), partial(caption, title=title)
    return PaperFigure(name, title, table, drawn, captioned, seen)


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a factor with its contributions, then one a factor and level with the mean responses."""
    series = outcome["series"]
    shares = pd.DataFrame({f"{key}_percent": series[key] for key in SHARES}).rename_axis("factor").reset_index()
    levels = [
        pd.DataFrame({"factor": name, "level": effects["levels"]})
        .assign(**{column: series[key][name]["means"] for key, column in EFFECTS.items()})
        for name, effects in series["main_effects"].items()
    ]  # fmt: skip
    return pd.concat([shares, *levels], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame, symbols: Mapping[str, str], unit: str) -> None:
    """Draw contributions on the left, main effects on both responses on the right."""
    figure.set_figheight(3.8)
    left, right = figure.subfigures(1, 2, width_ratios=[1, 1 + 0.25 * len(symbols)], squeeze=False)[0]
    _contributions(left.subplots(), frame[frame["level"].isna()].set_index("factor"), symbols)
    labels = (f"mean error [{unit}]", "mean largest depth [nm]")
    for row, column, label in zip(right.subplots(2, len(symbols), sharey="row"), EFFECTS.values(), labels, strict=True):
        row[0].set_ylabel(label)
        for axis, (name, symbol) in zip(row, symbols.items(), strict=True):
            own = frame[(frame["factor"] == name) & frame["level"].notna()]
            axis.plot(own["level"], own[column], "o-", color=RECORDED, ms=3.5)
            axis.set_xlabel(symbol)
            axis.set_xticks(own["level"].iloc[[0, -1]])
            axis.margins(x=0.2)


def _contributions(axis: Axes, shares: pd.DataFrame, symbols: Mapping[str, str]) -> None:
    places = np.arange(len(symbols))
    for k, ((key, label), face) in enumerate(zip(SHARES.items(), FACES, strict=True)):
        values = shares.loc[list(symbols), f"{key}_percent"]
        bars = axis.barh(places + 0.27 * (k - 1), values, 0.25, label=label, **face)
        axis.bar_label(bars, fmt="%.3g", fontsize=SMALLEST, padding=2)
    axis.set_yticks(places, symbols.values())
    axis.invert_yaxis()
    axis.set_xlabel("contribution [%]")
    axis.set_xlim(0, 118)
    axis.legend(loc="lower right")


def caption(frame: pd.DataFrame, title: str) -> str:
    """Return what is drawn."""
    return (
        f"{title}. Left: contribution of each parameter to the variance of the error, in the thesis and here, and of "
        "the largest depth. Right: mean error and mean largest depth at each level. Errors are against synthetic "
        "recordings."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the parameter of the largest contribution to each response."""
    shares = frame[frame["level"].isna()].set_index("factor")
    largest = ((label, shares[f"{key}_percent"]) for key, label in SHARES.items())
    texts = (f"{label}: {in_words(str(share.idxmax()))}, {share.max():.3g} %" for label, share in largest)
    return f"Largest contribution: {'; '.join(texts)}."
