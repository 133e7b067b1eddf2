"""Error of surrogates against the number of snapshots, by the design that placed them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import RECORDED, SERIES, SIMULATED

LOOKS = {"full factorial": (RECORDED, "s"), "Sobol": (SERIES[5], "o"), "Latin hypercube": (SIMULATED, "^")}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a design and number of snapshots."""
    return pd.DataFrame(outcome["series"]["rows"])


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw root mean square errors filled, largest errors open."""
    figure.set_figheight(2.8)
    axis = figure.subplots()
    for design, (colour, marker) in LOOKS.items():
        own = frame[frame["design"] == design]
        axis.loglog(own["snapshots"], own["rmse_nm"], f"{marker}-", ms=4, color=colour, label=design)
        axis.loglog(own["snapshots"], own["largest_nm"], f"{marker}:", ms=4, color=colour, mfc="none")
    sizes = sorted(set(frame["snapshots"]))
    axis.set_xticks(sizes, map(str, sizes))
    axis.minorticks_off()
    axis.set(xlabel="snapshots", ylabel="error at unseen points [nm]")
    axis.legend()


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Error of the surrogate of one condition at points that no design contains, over the number of snapshots. "
        "Filled, solid: root mean square; open, dotted: largest."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the design of the smallest error."""
    best = frame.sort_values("rmse_nm").iloc[0]
    return f"The smallest error, {best['rmse_nm']:.2g} nm, has {best['design']} with {best['snapshots']} snapshots."


FIGURE = PaperFigure("designs", "Designs of snapshots", table, draw, caption, seen, of_study=True)
