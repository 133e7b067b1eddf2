"""Identifiability: widths of intervals by set of tests, and profile likelihoods of the four tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, TRUTH, save, styled
from studies.thesis.figures.estimates import EPOXY

SYMBOLS = {**EPOXY, "poisson_ratio": r"$\nu$"}
LIMIT = 3.84


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw the map of widths above, profiles below."""
    series = outcome["series"]
    figure = Figure(figsize=(DOUBLE_COLUMN, 5.2))
    top, bottom = figure.subfigures(2, 1, height_ratios=[1.5, 1], squeeze=False)[:, 0]
    _widths(top.subplots(), series)
    profiles = series["profiles"]
    for axis, (name, part) in zip(bottom.subplots(1, len(profiles), sharey=True), profiles.items(), strict=True):
        axis.plot(part["values"], part["chi_square"], "o-", ms=2, color=RECORDED)
        axis.axhline(LIMIT, color="0.6", lw=0.7, ls=":")
        axis.axvline(part["truth"], color=TRUTH, lw=0.9, ls="--")
        axis.set_ylim(0, 10)
        axis.set_xlabel(SYMBOLS[name])
        axis.xaxis.set_major_locator(MaxNLocator(2))
        axis.tick_params(labelsize=7)
    bottom.supylabel(r"profile $\chi^2$", fontsize=8)
    save(figure, path)


def _widths(axis, series) -> None:
    values = np.array(list(series["widths"].values()))
    axis.imshow(np.log10(values), cmap="Greys", vmin=-2.5, vmax=1.5, aspect="auto")
    for i, row in enumerate(values):
        for k, value in enumerate(row):
            text = f"{value:.2g}" if value < 10 else "> 10"
            axis.text(
                k, i, text, ha="center", va="center", fontsize=7, fontweight="bold" if value < 0.25 else "normal",
                color="white" if value > 2 else "black",
            )  # fmt: skip
    axis.set_xticks(range(len(series["names"])), [SYMBOLS[name] for name in series["names"]])
    axis.set_yticks(range(len(values)), series["widths"], fontsize=7)
    axis.tick_params(length=0)
    axis.set_title("half-width of the 95 % interval over the parameter's range (bold: fixed)")
