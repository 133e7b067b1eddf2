"""Convergence of the genetic algorithm."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.ticker import ScalarFormatter

from palpate.output.figures.style import mark_synthetic, save, styled, subplots

UNITS = {"mean_square": "nm$^2$", "relative": "-"}


@styled
def draw(calibrations: Mapping[str, Mapping[str, Any]], path: str | Path, title: str, synthetic: bool) -> None:
    """Draw the smallest sum of objectives in each generation, for every condition set.

    Of several objectives a whole front survives, so that the smallest sum in it may rise again.

    Parameters
    ----------
    calibrations
        Content of each condition set's calibration JSON.
    path, title, synthetic
        See `palpate.output.figures.estimates_figure.draw`.
    """
    figure, axis = subplots(figsize=(4.4, 2.8))
    for name, calibration in calibrations.items():
        history = calibration["history"]
        axis.semilogy([row["generation"] for row in history], [row["best_sum"] for row in history], label=name, lw=0.8)
    axis.yaxis.set_major_formatter(ScalarFormatter())
    axis.yaxis.set_minor_formatter(ScalarFormatter())
    axis.set_xlabel("generation")
    objective = next(iter(calibrations.values()))["settings"]["objective"]
    axis.set_ylabel(f"sum of the conditions' objectives [{UNITS[objective]}]")
    figure.suptitle(title, x=0.02, ha="left", fontsize=8)
    axis.set_title("smallest in each generation's front, which may rise", fontsize=7, loc="left")
    axis.legend(title="calibrated on", loc="center left", bbox_to_anchor=(1.0, 0.5))
    mark_synthetic(figure, synthetic)
    save(figure, path)
