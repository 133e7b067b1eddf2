"""Error of surrogates against the number of snapshots, by the design that placed them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.output.figures.style import RECORDED, SIMULATED, SURROGATE, save, styled, subplots

STYLES = {"full factorial": (RECORDED, "s"), "Sobol": (SURROGATE, "o"), "Latin hypercube": (SIMULATED, "^")}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw root mean square errors filled, largest errors open."""
    figure, axis = subplots(figsize=(3.8, 2.8))
    for design, (colour, marker) in STYLES.items():
        own = [row for row in outcome["series"]["rows"] if row["design"] == design]
        sizes = [row["snapshots"] for row in own]
        axis.loglog(sizes, [row["rmse_nm"] for row in own], marker + "-", ms=4, color=colour, label=design)
        axis.loglog(sizes, [row["largest_nm"] for row in own], marker + ":", ms=4, color=colour, mfc="none")
    axis.set_xticks([72, 144, 288], ["72", "144", "288"])
    axis.minorticks_off()
    axis.set_xlabel("snapshots")
    axis.set_ylabel("error at unseen points [nm]")
    axis.set_title("filled: root mean square; open: largest")
    axis.legend(fontsize=7)
    save(figure, path)
