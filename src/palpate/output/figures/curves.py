"""Recorded and simulated curves of every condition: load over depth, or over time under displacement control."""

from __future__ import annotations

from functools import partial
from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.output.figures.curve_panels import (
    MODELS,
    conditions,
    draw_models,
    models_in,
    observed_in,
    of_diagnosis,
    of_fit,
    panels,
    response,
    unit_of,
)
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import RECORDED, SERIES
from palpate.output.saved_set import ALL, SavedSet

MARKS = 26  # recorded points that are drawn of a curve


def table(saved: SavedSet) -> pd.DataFrame:
    """Return the curves with and without the accepted effects, see `palpate.output.figures.curve_panels.of_fit`."""
    if ALL in saved.fits and not saved.accepted:
        return of_fit(saved.fits[ALL], saved.labels)
    assert saved.explained is not None
    found = of_diagnosis(saved.explained, saved.labels)
    return found.drop(columns=["noise_nm", *(() if saved.accepted else ["accepted_nm"])])


def drawn_as(curve: pd.DataFrame, values: pd.Series) -> tuple[pd.Series, pd.Series]:
    """Return what is drawn of a response: the load over a depth, or a load over the time."""
    if _over_depth(curve):
        return values, curve["load_mN"]
    return curve["time_s"], values


def _over_depth(curve: pd.DataFrame) -> bool:
    recorded = "load_mN" in curve and bool(curve["load_mN"].notna().any())
    return observed_in(curve).drawn_over == "load" and recorded


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel a condition."""
    for curve, axis in panels(figure, frame, (1.6, 1.75)):
        draw_models(axis, curve, partial(drawn_as, curve))
        recorded = response(curve, "recorded")
        assert recorded is not None
        points = [column.iloc[:: max(1, len(curve) // MARKS)] for column in drawn_as(curve, recorded)]
        axis.plot(*points, "o", color=RECORDED, ms=2.4, mfc="none", mew=0.6, zorder=3, label="recorded")
        axis.set_xlabel(observed_in(curve).label if _over_depth(curve) else "time [s]")
        axis.set_ylabel("load [mN]" if _over_depth(curve) else observed_in(curve).label)
        axis.set_xlim(left=0)
        axis.set_ylim(bottom=0)


def together(axis: Axes, frame: pd.DataFrame) -> None:
    """Draw the recorded and the base model's curves of all conditions on the same axes, one colour a condition."""
    parts = conditions(frame)
    for curve, colour in zip(parts, cycle(SERIES)):
        for key, style in (("recorded", "o"), ("base", "-")):
            if (values := response(curve, key)) is not None:
                label = str(curve["condition"].iloc[0]) if key == "base" else None
                axis.plot(*drawn_as(curve, values), style, color=colour, ms=2.5, mfc="none", mew=0.6, label=label)
    kinds = map(observed_in, parts)
    across = {each.label if each.drawn_over == "load" else "time [s]" for each in kinds}
    axis.set_xlabel(" or ".join(sorted(across)))
    axis.set_ylabel("load [mN]")
    axis.set_title("points: recorded; lines: finite elements")
    axis.legend()


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        f"Recorded curves (circles, mean of the replicates) and those of {models_in(frame)}. Held-out tests take no "
        "part in any fit."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the largest difference of the simulated from the recorded curves."""
    texts = []
    for name, words in MODELS.items():
        off = {
            part["label"].iloc[0]: float(np.nanmax(np.abs(values - recorded)))
            for part in conditions(frame)
            if (values := response(part, name)) is not None and (recorded := response(part, "recorded")) is not None
        }
        if off:
            worst = max(off, key=off.__getitem__)
            unit = unit_of(frame[frame["label"] == worst])
            texts.append(f"the {words} differs from the recordings by at most {off[worst]:.3g} {unit}, at {worst}")
    return f"Curves of {frame['condition'].nunique()} conditions; {'; '.join(texts)}."


FIGURE = PaperFigure("curves", "Recorded and simulated curves", table, draw, caption, seen)
