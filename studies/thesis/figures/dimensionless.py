"""Error of one dimensionless surrogate against its number of snapshots, beside that of four separate ones."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.output.figures.style import RECORDED, SIMULATED, SURROGATE, save, styled, subplots


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw root mean square and largest errors at points that no surrogate saw."""
    curve, separate = outcome["series"]["curve"], outcome["series"]["separate"]
    figure, axis = subplots(figsize=(3.8, 2.8))
    sizes = [row["snapshots"] for row in curve]
    for key, label, style in (("rmse_nm", "root mean square", "o-"), ("largest_nm", "largest", "s--")):
        axis.loglog(
            sizes, [row[key] for row in curve], style, ms=3.5, color=SIMULATED, label=f"one over groups, {label}"
        )
        axis.plot(1152, separate[key], style[0], ms=5, color=SURROGATE, label=f"four separate, {label}")
        axis.axhline(separate[key], color=SURROGATE, lw=0.6, ls=":")
    axis.set_xticks([32, 64, 128, 256, 1152], ["32", "64", "128", "256", "1152"])
    axis.minorticks_off()
    axis.set_xlabel("snapshots, all four loading times")
    axis.set_ylabel("error at test points [nm]", color=RECORDED)
    axis.legend(fontsize=6.5)
    save(figure, path)
