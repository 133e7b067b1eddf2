"""Friction: by how much it makes the largest and the residual depth shallower, over loading times."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, SIMULATED, SURROGATE, save, styled, subplots

STYLES = {0.125: ("0.6", "o-", 3.5), 0.25: (SURROGATE, "o-", 3.5), 0.5: (SIMULATED, "s--", 6)}
TITLES = {"max_depth": "largest depth", "residual_depth": "residual depth"}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw both depths, for both kinematics; panels without curves say so."""
    rows = outcome["series"]["rows"]
    figure, axes = subplots(2, 2, figsize=(DOUBLE_COLUMN, 4.4), sharex=True)
    for line, kinematics in zip(axes, ("small", "large"), strict=True):
        for axis, depth in zip(line, ("max_depth", "residual_depth"), strict=True):
            key = f"{depth}_reduction_percent"
            drawn = False
            for coefficient, (colour, style, size) in STYLES.items():
                own = [
                    row
                    for row in rows
                    if (row["kinematics"], row["friction"], row["max_load"]) == (kinematics, coefficient, 1.0)
                    and row[key] is not None
                ]
                own.sort(key=lambda row: row["loading_time"])
                times = [row["loading_time"] for row in own]
                axis.semilogx(
                    times,
                    [row[key] for row in own],
                    style,
                    ms=size,
                    mfc="none",
                    color=colour,
                    label=f"f = {coefficient:g}",
                )
                drawn = drawn or bool(own)
            if drawn:
                axis.axhline(0, color=RECORDED, lw=0.5)
                axis.legend(fontsize=7)
            else:
                axis.set_axis_off()
                axis.text(0.5, 0.5, "not run: see the verdict", ha="center", va="center", transform=axis.transAxes)
            axis.set_xticks([30, 45, 60, 240], ["30", "45", "60", "240"], minor=False)
            axis.minorticks_off()
            axis.set_xlim(25, 300)
            axis.set_title(f"{TITLES[depth]}, {kinematics} strains")
        line[0].set_ylabel("shallower than without friction [%]")
    for axis in axes[-1]:
        axis.set_xlabel("loading time [s]")
    save(figure, path)
