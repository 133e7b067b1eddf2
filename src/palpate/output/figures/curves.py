"""Recorded and simulated curves of every condition: load over depth, or over time under displacement control."""

from __future__ import annotations

from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.observables import OBSERVABLES, UNITS, Observable
from palpate.observables.depth import DEPTH
from palpate.output.figures.paper_figure import PaperFigure, bottom_row, first_column, grid, legend_below
from palpate.output.figures.style import ACCEPTED, BASE, RECORDED, SERIES
from palpate.output.saved_set import ALL, SavedSet

ROLES = {"calibrate": "", "validate": " (held out)"}
MARKS = 26  # recorded points that are drawn of a curve


def table(saved: SavedSet) -> pd.DataFrame:
    """Return the curves with and without the accepted effects, see `of_fit`."""
    if ALL in saved.fits and not saved.accepted:
        return of_fit(saved.fits[ALL], saved.labels)
    assert saved.explained is not None
    found = saved.explained.rename(columns={"before_nm": "base_nm", "after_nm": "accepted_nm"})
    found.insert(1, "label", found["condition"].map(saved.labels))
    return found.drop(columns=["noise_nm", *(() if saved.accepted else ["accepted_nm"])])


def of_fit(curves: pd.DataFrame, labels: dict[str, str] | None = None) -> pd.DataFrame:
    """Return the curves of a calibration: condition, label, role, time, drive, recorded and base model's response."""
    found = curves.rename(columns={f"simulated_{unit}": f"base_{unit}" for unit in UNITS})
    found = found.drop(columns=[name for name in found if str(name).startswith(("spread_", "surrogate_"))])
    known = labels or {}
    found.insert(1, "label", [known.get(name, name) for name in found["condition"]])
    return found


def observed_in(curve: pd.DataFrame) -> Observable:
    """Return the observable of a condition's part of a table of curves; depth where nothing was recorded."""
    columns = {each.column("recorded"): each for each in OBSERVABLES.values()}
    found = (each for name, each in columns.items() if name in curve and curve[name].notna().any())
    return next(found, DEPTH.observable)


def unit_of(curve: pd.DataFrame) -> str:
    """Return the unit of the response in a condition's part of a table of curves."""
    return observed_in(curve).unit


def response(curve: pd.DataFrame, name: str) -> pd.Series | None:
    """Return the ``recorded``, ``base`` or ``accepted`` response of a condition, where there is one."""
    column = f"{name}_{unit_of(curve)}"
    return curve[column] if column in curve and curve[column].notna().any() else None


def drawn_as(curve: pd.DataFrame, values: pd.Series) -> tuple[pd.Series, pd.Series]:
    """Return what is drawn of a response: the load over it, or it over the time."""
    if observed_in(curve).drawn_over == "load" and "load_mN" in curve and curve["load_mN"].notna().any():
        return values, curve["load_mN"]
    return curve["time_s"], values


def under_load(curve: pd.DataFrame, values: pd.Series) -> bool:
    """Return whether a response is drawn across, and the load upwards."""
    return drawn_as(curve, values)[0] is values


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel a condition."""
    parts = [part for _, part in frame.groupby("condition", sort=False)]
    axes = grid(figure, len(parts), (1.6, 1.75))
    for k, (curve, axis) in enumerate(zip(parts, axes, strict=True)):
        for name, look in (("base", BASE), ("accepted", ACCEPTED)):
            if (values := response(curve, name)) is not None:
                label = "base model" if name == "base" else "accepted model"
                axis.plot(*drawn_as(curve, values), label=label, **look)
        recorded = response(curve, "recorded")
        assert recorded is not None
        step = max(1, len(curve) // MARKS)
        points = [column.iloc[::step] for column in drawn_as(curve, recorded)]
        axis.plot(*points, "o", color=RECORDED, ms=2.4, mfc="none", mew=0.6, zorder=3, label="recorded")
        axis.set_title(f"{curve['label'].iloc[0]}{ROLES[curve['role'].iloc[0]]}")
        if bottom_row(axes, k):
            axis.set_xlabel(observed_in(curve).label if under_load(curve, recorded) else "time [s]")
        if first_column(axes, k):
            axis.set_ylabel("load [mN]" if under_load(curve, recorded) else observed_in(curve).label)
        axis.set_xlim(left=0)
        axis.set_ylim(bottom=0)
    legend_below(figure, axes[0])


def together(axis: Axes, frame: pd.DataFrame) -> None:
    """Draw the recorded and the base model's curves of all conditions on the same axes, one colour a condition."""
    kinds = {observed_in(curve) for _, curve in frame.groupby("condition", sort=False)}
    for (name, curve), colour in zip(frame.groupby("condition", sort=False), cycle(SERIES)):
        for key, style in (("recorded", "o"), ("base", "-")):
            if (values := response(curve, key)) is not None:
                label = str(name) if key == "base" else None
                axis.plot(*drawn_as(curve, values), style, color=colour, ms=2.5, mfc="none", mew=0.6, label=label)
    across = {"time [s]" if each.drawn_over == "time" else each.label for each in kinds}
    axis.set_xlabel(" or ".join(sorted(across, reverse=True)))
    axis.set_ylabel("load [mN]")
    axis.set_title("points: recorded; lines: finite elements")
    axis.legend()


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    accepted = any(str(name).startswith("accepted_") for name in frame)
    lines = "base model (dashed)" + (" and accepted model, with the effects (solid)" if accepted else "")
    return (
        f"Recorded curves (circles, mean of the replicates) and simulated ones: {lines}. Held-out tests take "
        "no part in any fit."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the largest difference of the simulated from the recorded curves."""
    texts = []
    for name, words in (("base", "the base model"), ("accepted", "the accepted model")):
        off = {
            part["label"].iloc[0]: float(np.nanmax(np.abs(values - recorded)))
            for _, part in frame.groupby("condition", sort=False)
            if (values := response(part, name)) is not None and (recorded := response(part, "recorded")) is not None
        }
        if off:
            worst = max(off, key=off.__getitem__)
            unit = unit_of(frame[frame["label"] == worst])
            texts.append(f"{words} differs from the recordings by at most {off[worst]:.3g} {unit}, at {worst}")
    return f"Curves of {frame['condition'].nunique()} conditions; {'; '.join(texts)}."


FIGURE = PaperFigure("curves", "Recorded and simulated curves", table, draw, caption, seen)
