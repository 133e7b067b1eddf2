"""Error of one dimensionless surrogate against its number of snapshots, beside that of four separate ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import ACCEPTED, BASE

SEPARATE, GROUPS = "four separate", "one over groups"
MEASURES = {"rmse_nm": ("root mean square", "o"), "largest_nm": ("largest", "s")}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a surrogate over groups and its number of snapshots, and one for the four separate surrogates."""
    separate = {"surrogates": SEPARATE, "snapshots": 1152, **outcome["series"]["separate"]}
    return pd.DataFrame([*({"surrogates": GROUPS, **row} for row in outcome["series"]["curve"]), separate])


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw root mean square and largest errors at points that no surrogate saw."""
    figure.set_figheight(2.8)
    axis = figure.subplots()
    groups, separate = (frame[frame["surrogates"] == name] for name in (GROUPS, SEPARATE))
    for key, (label, marker) in MEASURES.items():
        axis.loglog(groups["snapshots"], groups[key], marker=marker, ms=3.5, label=f"{GROUPS}, {label}", **ACCEPTED)
        one = {"color": BASE["color"], "marker": marker, "ls": "none", "label": f"{SEPARATE}, {label}"}
        axis.plot(separate["snapshots"], separate[key], ms=5, **one)
        axis.axhline(separate[key].iloc[0], color=BASE["color"], lw=0.8, ls=":")
    sizes = sorted(set(frame["snapshots"]))
    axis.set_xticks(sizes, map(str, sizes))
    axis.minorticks_off()
    axis.set(xlabel="snapshots, all four loading times", ylabel="error at test points [nm]")
    axis.legend()


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Error of one surrogate over dimensionless groups for all loading times (line), and of four surrogates, one a "
        "loading time, of 288 snapshots each (single symbols), at points that no surrogate was fitted to."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the error of the largest surrogate over groups, and of the four."""
    last, four = (frame[frame["surrogates"] == name].iloc[-1] for name in (GROUPS, SEPARATE))
    texts = (f"{row['rmse_nm']:.2g} nm with {row['snapshots']} snapshots ({row['surrogates']})" for row in (last, four))
    return f"Root mean square errors: {', '.join(texts)}."


FIGURE = PaperFigure("dimensionless", "One surrogate for all loading times", table, draw, caption, seen, of_study=True)
