"""Calibrated parameters with 95 % intervals, condition sets side by side, over the range that was searched."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import pandas as pd

from palpate.base.parameters import Parameter, in_words
from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, TRUTH, mark_synthetic, save, styled, subplots


@styled
def draw(
    table: pd.DataFrame,
    ranges: Mapping[str, Sequence[float]],
    declared: Iterable[Parameter],
    path: str | Path,
    title: str,
    synthetic: bool,
) -> None:
    """Draw one panel a parameter.

    Parameters
    ----------
    path
        File that is written.
    title
        Title of the figure.
    synthetic
        Whether the figure is marked as one of synthetic recordings.
    table
        From `palpate.workflow_support.steps.parameter_table`.
    ranges
        Levels of each parameter; those with one level are left out.
    declared
        What the law declares, for symbols and units.
    """
    labels = {parameter.name: label(parameter) for parameter in declared}
    names = [name for name, levels in ranges.items() if len(levels) > 1]
    figure, axes = subplots(1, len(names), figsize=(DOUBLE_COLUMN, 2.1), squeeze=False, sharey=True)
    for name, axis in zip(names, axes[0], strict=True):
        rows = table[table["parameter"] == name].reset_index(drop=True)
        for k, row in rows.iterrows():
            known = bool(row["identified"])
            axis.plot([row["lower"], row["upper"]], [k, k], color=RECORDED if known else "0.65", lw=1.6)
            axis.plot(row["estimate"], k, "o", color=RECORDED, mfc=RECORDED if known else "white", ms=4.5)
        if "truth" in rows and rows["truth"].notna().any():
            axis.axvline(rows["truth"].iloc[0], color=TRUTH, lw=1.2, ls="--")
        axis.axvspan(min(ranges[name]), max(ranges[name]), color="0.94", lw=0, zorder=0)
        low, high = min(*ranges[name], *rows["lower"]), max(*ranges[name], *rows["upper"])
        axis.set_xlim(low - 0.05 * (high - low), high + 0.05 * (high - low))
        axis.set_title(in_words(name))
        axis.set_xlabel(labels[name])
        axis.set_yticks(range(len(rows)), rows["condition_set"])
        axis.set_ylim(len(rows) - 0.5, -0.5)
    legend = "bars: 95 % intervals; open: not identified; shaded: range" + (
        "; dashed: truth" if "truth" in table else ""
    )
    figure.suptitle(f"{title}\n{legend}", fontsize=8)
    mark_synthetic(figure, synthetic)
    save(figure, path)


def label(parameter: Parameter) -> str:
    """Return symbol and unit in mathtext, such as ``$C_s$ [GPa$^{-(2m_s+1)}$/s]``; pure numbers have no unit."""
    unit = re.sub(r"\^(-\(.*?\))", r"$^{\1}$", parameter.unit)
    return f"${parameter.symbol}$" + ("" if unit == "-" else f" [{unit}]")
