"""The blind trial: answers against the strength of the concealed effect, and how reliable stated probabilities are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from palpate.mechanisms import MECHANISMS
from palpate.output.figures.style import (
    DOUBLE_COLUMN,
    RECORDED,
    SIMULATED,
    SURROGATE,
    TRUTH,
    headed,
    save,
    styled,
    subplots,
)

ANSWERS = {
    "named": (TRUTH, "o"),
    "among several": (SURROGATE, "s"),
    "not noticed": ("0.7", "."),
    "unexplained": ("#d9a520", "^"),
    "without the truth": (SIMULATED, "+"),
    "wrong name": (SIMULATED, "x"),
}
LINES = [(RECORDED, "o-", (-2, -10)), (SURROGATE, "s--", (-2, 6))]


def answer(row: pd.Series) -> str:
    """Say what the answer to a single effect was worth."""
    if row["exact"]:
        return "named"
    if row["covered"]:
        return "among several"
    others = {"adequate": "not noticed", "unexplained": "unexplained", "ambiguous": "without the truth"}
    return others.get(row["verdict"], "wrong name")


@styled
def draw(table: pd.DataFrame, reliability: Mapping[str, pd.DataFrame], path: str | Path) -> None:
    """Draw the answers to single effects by their strength, and the reliability of two named kinds of cases."""
    figure, (left, right) = subplots(1, 2, figsize=(DOUBLE_COLUMN, 3.2), gridspec_kw={"width_ratios": [2, 1]})
    one = table[table["kind"] == "one"].copy()
    keys = sorted(one["truth"].unique())
    one["answer"] = one.apply(answer, axis=1) if len(one) else []
    for name, (colour, marker) in ANSWERS.items():
        part = one[one["answer"] == name]
        places = [keys.index(key) for key in part["truth"]]
        if places:
            left.plot(part["strength"].clip(0.05), places, marker, color=colour, ls="none", ms=4, label=name)
    left.axvline(1.0, color="0.8", lw=0.8)
    left.axvline(3.0, color="0.6", lw=0.8, ls="--")
    left.set_xscale("log")
    left.set_yticks(range(len(keys)), [MECHANISMS[key].title for key in keys])
    left.set_xlabel("strength of the effect")
    left.set_title("single concealed effects: the answer")
    left.legend(
        fontsize=6.5, loc="upper left", bbox_to_anchor=(-0.35, -0.16), ncols=6, columnspacing=0.8, handletextpad=0.1
    )
    right.plot([0, 1], [0, 1], color="0.8", lw=0.8)
    for (kind, found), (colour, line, beside) in zip(reliability.items(), LINES, strict=True):
        right.plot(found["stated"], found["right"], line, color=colour, ms=4, label=kind)
        for stated, share, count in found[["stated", "right", "cases"]].itertuples(index=False):
            if np.isfinite(stated):
                right.annotate(
                    f"{count}", (stated, share), textcoords="offset points", xytext=beside, fontsize=6.5, color=colour
                )
    right.set_xlim(-0.05, 1.12)
    right.set_ylim(-0.12, 1.12)
    right.legend(fontsize=6.5, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, columnspacing=0.8)
    right.set_xlabel("stated probability")
    right.set_ylabel("share that is right")
    right.set_title("reliability", loc="left")
    headed(figure, "", True)
    save(figure, path)
