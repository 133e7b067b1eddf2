"""Epoxy from end to end: misfit of all tests in time, and parameters with intervals over their ranges."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from palpate.output.figures.style import DOUBLE_COLUMN, SIMULATED, SURROGATE, mark_synthetic, save, styled
from studies.thesis.figures.estimates import EPOXY, interval

SYMBOLS = {**EPOXY, "youngs_modulus": "E [GPa]"}
COLOURS = {"calibrate": SIMULATED, "validate": SURROGATE}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw one panel a test above, one a parameter below."""
    series, rows = outcome["series"], outcome["tables"]["parameters"]
    errors = {row["condition"]: row for row in outcome["tables"]["errors of every test"]}
    figure = Figure(figsize=(DOUBLE_COLUMN, 4.6))
    top, bottom = figure.subfigures(2, 1, height_ratios=[3, 1], squeeze=False)[:, 0]
    for axis, (name, part) in zip(top.subplots(2, 4, sharey=True).ravel(), series["misfit"].items(), strict=True):
        axis.plot(part["time"], part["misfit"], color=COLOURS[part["role"]], lw=0.9)
        axis.axhline(0, color="0.7", lw=0.6)
        own = errors[name]
        axis.set_title(
            f"{name}, {part['role']}\n{own['rmse_nm']:.1f} nm (thesis {own['thesis_rmse_nm']:.1f})", fontsize=7
        )
        axis.set_xlabel("time [s]")
    top.suptitle("misfit at the estimate", fontsize=8)
    top.supylabel("finite elements - recorded [nm]", fontsize=8)
    for axis, row in zip(bottom.subplots(1, len(rows)), rows, strict=True):
        interval(axis, row, 0, SIMULATED)
        axis.set_xlim(*series["levels"][row["parameter"]])
        axis.set_yticks([])
        axis.set_xlabel(SYMBOLS[row["parameter"]])
    bottom.suptitle("bars: 95 % intervals; open: not identified; dashed: truth; axes: range searched", fontsize=7)
    mark_synthetic(figure, True)
    save(figure, path)
