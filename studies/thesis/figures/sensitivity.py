"""Sensitivity of the largest and the residual depth to each Burgers parameter over its range, by loading time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from palpate.base.parameters import in_words
from palpate.output.figures.paper_figure import PaperFigure
from studies.thesis.figures.estimates import EPOXY

SHADES = ("0.8", "0.6", "0.4", "0.1")
DEPTHS = {"max_depth_percent": "largest depth", "residual_depth_percent": "residual depth"}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a loading time and parameter."""
    return pd.DataFrame(outcome["series"]["rows"])


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw signed changes as bars, one shade a loading time."""
    figure.set_figheight(2.8)
    axes = figure.subplots(1, 2, sharey=True)
    for axis, (key, title) in zip(axes, DEPTHS.items(), strict=True):
        parts = frame.groupby("condition", sort=False)
        for k, ((condition, part), shade) in enumerate(zip(parts, SHADES, strict=True)):
            values = part.set_index("parameter").loc[list(EPOXY), key]
            places = np.arange(len(EPOXY)) + 0.2 * (k - 1.5)
            axis.bar(places, values, 0.18, color=shade, label=f"{int(str(condition)[-3:])} s")
        axis.axhline(0, color="black", lw=0.6)
        axis.set_xticks(range(len(EPOXY)), EPOXY.values())
        axis.set_title(title)
    axes[0].set_ylabel("change, lowest to highest level [%]")
    axes[1].legend(title="loading time")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Change of the largest and of the residual depth when one parameter goes from its lowest to its highest level, "
        "as a share of the depth at the centre of the ranges, by loading time."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the parameter that changes each depth most."""
    most = ((title, frame.sort_values(key, key=abs).iloc[-1], key) for key, title in DEPTHS.items())
    texts = (f"the {title} by {row[key]:+.3g} % ({in_words(row['parameter'])})" for title, row, key in most)
    return f"The largest changes are {' and '.join(texts)}."


FIGURE = PaperFigure("sensitivity", "Sensitivity of the depths", table, draw, caption, seen, of_study=True)
