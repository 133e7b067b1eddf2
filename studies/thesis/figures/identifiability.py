"""Identifiability: widths of intervals by set of tests, and profile likelihoods of the four tests."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from palpate.base.parameters import in_words
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import RECORDED, SMALLEST, TRUTH
from studies.thesis.figures.estimates import EPOXY

SYMBOLS = {**EPOXY, "poisson_ratio": r"$\nu$"}
LIMIT = 3.84  # of chi-square with one degree of freedom, at 95 %
FIXED, WIDEST = 0.25, 10.0  # half-widths below which a parameter is fixed, and above which no number is written


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a set of tests and parameter with the half-width, then one a point of each profile."""
    series = outcome["series"]
    widths = [
        pd.DataFrame({"tests": label, "parameter": series["names"], "half_width": row})
        for label, row in series["widths"].items()
    ]
    profiles = [
        pd.DataFrame({"parameter": name, "value": part["values"], "chi_square": part["chi_square"]})
        .assign(truth=part["truth"])
        for name, part in series["profiles"].items()
    ]  # fmt: skip
    return pd.concat([*widths, *profiles], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw the map of widths above, profiles below."""
    figure.set_figheight(5.2)
    top, bottom = figure.subfigures(2, 1, height_ratios=[1.5, 1], squeeze=False)[:, 0]
    _widths(top.subplots(), frame[frame["tests"].notna()])
    profiles = list(frame[frame["value"].notna()].groupby("parameter", sort=False))
    for axis, (name, part) in zip(bottom.subplots(1, len(profiles), sharey=True), profiles, strict=True):
        axis.plot(part["value"], part["chi_square"], "o-", ms=2, color=RECORDED)
        axis.axhline(LIMIT, color="0.6", lw=0.7, ls=":")
        axis.axvline(part["truth"].iloc[0], color=TRUTH, lw=0.9, ls="--")
        axis.set_ylim(0, 10)
        axis.set_xlabel(SYMBOLS[str(name)])
        axis.xaxis.set_major_locator(MaxNLocator(2))
    bottom.supylabel(r"profile $\chi^2$")


def _widths(axis: Axes, rows: pd.DataFrame) -> None:
    values = rows.pivot_table("half_width", "tests", "parameter", sort=False)
    axis.imshow(np.log10(values), cmap="Greys", vmin=-2.5, vmax=1.5, aspect="auto")
    for (i, k), value in np.ndenumerate(values.to_numpy()):
        text = f"{value:.2g}" if value < WIDEST else f"> {WIDEST:g}"
        weight, colour = "bold" if value < FIXED else "normal", "white" if value > 2 else "black"
        axis.text(k, i, text, ha="center", va="center", fontsize=SMALLEST, fontweight=weight, color=colour)
    axis.set_xticks(range(values.shape[1]), [SYMBOLS[str(name)] for name in values.columns])
    axis.set_yticks(range(values.shape[0]), values.index)
    axis.tick_params(length=0)


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Above: half-width of the 95 % interval of each parameter as a share of its range, by the set of tests; bold: "
        f"below {FIXED:g}. Below: profile likelihoods of the four tests; dotted: the limit {LIMIT:g} of a 95 % "
        "interval; dashed: true value."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return which parameters the first set of tests fixes."""
    first = frame[frame["tests"] == frame["tests"].iloc[0]]
    fixed = map(in_words, first[first["half_width"] < FIXED]["parameter"])
    return f"{first['tests'].iloc[0]}: narrow intervals for {', '.join(fixed) or 'no parameter'}."


FIGURE = PaperFigure(
    "identifiability", "Which parameters the tests determine", table, draw, caption, seen, of_study=True
)
