"""Sensitivity of the largest and the residual depth to each Burgers parameter over its range, by loading time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from palpate.output.figures.style import DOUBLE_COLUMN, save, styled, subplots
from studies.thesis.figures.estimates import EPOXY

SHADES = ("0.8", "0.6", "0.4", "0.1")


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw signed changes as bars, one shade a loading time."""
    rows = outcome["series"]["rows"]
    conditions = list(dict.fromkeys(row["condition"] for row in rows))
    figure, axes = subplots(1, 2, figsize=(DOUBLE_COLUMN, 2.8), sharey=True)
    for axis, key, title in zip(
        axes, ("max_depth_percent", "residual_depth_percent"), ("largest depth", "residual depth"), strict=True
    ):
        for k, (condition, shade) in enumerate(zip(conditions, SHADES, strict=True)):
            values = [
                next(row[key] for row in rows if (row["condition"], row["parameter"]) == (condition, name))
                for name in EPOXY
            ]
            places = np.arange(len(EPOXY)) + 0.2 * (k - 1.5)
            axis.bar(places, values, 0.18, color=shade, label=f"{int(condition[-3:])} s")
        axis.axhline(0, color="black", lw=0.6)
        axis.set_xticks(range(len(EPOXY)), EPOXY.values())
        axis.set_title(title)
    axes[0].set_ylabel("change, lowest to highest level [%]")
    axes[1].legend(fontsize=7, title="loading time", title_fontsize=7)
    save(figure, path)
