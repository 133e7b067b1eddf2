"""Parameters on the axes of figures: their symbols, and an estimate with its interval beside the truth."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes

from palpate.output.figures.style import TRUTH

ALUMINIUM = {"youngs_modulus": "E", "yield_stress": r"$\sigma_Y$", "hardening": "H"}
EPOXY = {
    "youngs_modulus": "E",
    "steady_coefficient": "$C_s$",
    "steady_exponent": "$m_s$",
    "transient_coefficient": "$C_t$",
    "transient_exponent": "$m_t$",
    "retardation_time": r"$t_\epsilon$",
}


def ranged(rows: Iterable[Mapping[str, Any]], ranges: Mapping[str, Sequence[float]]) -> pd.DataFrame:
    """Return a row a parameter and fit with the range of the parameter beside it."""
    return pd.DataFrame(
        {**row, "range_from": ranges[row["parameter"]][0], "range_to": ranges[row["parameter"]][1]} for row in rows
    )


def interval(axis: Axes, row: pd.Series, place: float, colour: str) -> None:
    """Draw an estimate, open where the data do not determine it, with its interval at a `place` of the other axis.

    The axis shows the range of the parameter, and a dashed line the truth.
    """
    axis.plot([row["lower"], row["upper"]], [place, place], color=colour, lw=1.6)
    axis.plot(row["estimate"], place, "o", color=colour, mfc=colour if row["identified"] else "white", ms=4.5)
    axis.axvline(row["truth"], color=TRUTH, ls="--", lw=1)
    axis.set_xlim(row["range_from"], row["range_to"])
