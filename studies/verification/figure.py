"""Any plot of a verification: lines and points over common axes, with deviations in per cent underneath."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palpate.output.figures.style import RECORDED, SIMULATED, SURROGATE, TRUTH, save, styled, subplots

COLOURS = (RECORDED, SIMULATED, SURROGATE, TRUTH)
MARKERS = "osv^"


@styled
def draw(plot: Mapping[str, Any], path: str | Path) -> None:
    """Draw one plot of verification.json."""
    rows = 2 if plot["lower"] else 1
    ratios = {"height_ratios": [3, 1][:rows]}
    figure, axes = subplots(
        rows, 1, figsize=(4.4, 2.5 + 0.9 * (rows - 1)), sharex=True, squeeze=False, gridspec_kw=ratios
    )
    upper = axes[0, 0]
    _lines(upper, plot["series"], joined=plot["logarithmic"])
    upper.set_ylabel(plot["y_label"])
    upper.legend(fontsize=7)
    if plot["logarithmic"]:
        upper.set_xscale("log", base=2)
        upper.set_yscale("log")
    if plot["lower"]:
        lower = axes[1, 0]
        lower.axhline(0.0, color="0.7", lw=0.6)
        _lines(lower, plot["lower"], first=1)
        lower.set_ylabel("deviation\n[%]")
        if len(plot["lower"]) > 1:
            lower.legend(fontsize=6.5, ncols=len(plot["lower"]))
    axes[-1, 0].set_xlabel(plot["x_label"])
    save(figure, path)


def _lines(axis, series: Sequence[Mapping[str, Any]], first: int = 0, joined: bool = False) -> None:
    for k, line in enumerate(series, first):
        x, y = (np.array(line[key], dtype=float) for key in ("x", "y"))
        if not np.any(np.isfinite(x + y)):
            axis.plot([], [], " ", label=f"{line['label']}: failed")
            continue
        if joined:
            kept = y > 0
            axis.plot(x[kept], y[kept], marker=MARKERS[k % 4], ms=4, color=COLOURS[k % 4], label=line["label"])
        elif line["marks"]:
            axis.plot(x, y, "o", ms=3.2, mfc="none", mew=0.9, color=COLOURS[k % 4], label=line["label"])
        else:
            axis.plot(x, y, color=COLOURS[k % 4], label=line["label"])
