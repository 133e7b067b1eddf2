"""What figures of curves share: their tables, which models are drawn and how, and a panel for each condition."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.observables import OBSERVABLES, UNITS, Observable
from palpate.observables.depth import DEPTH
from palpate.output.figures.paper_figure import bottom_row, first_column, grid, legend_below
from palpate.output.figures.style import ACCEPTED, BASE, SMALLEST

ROLES = {"calibrate": "", "validate": " (held out)"}
MODELS = {"base": "base model", "accepted": "accepted model"}
LOOKS = {"base": BASE, "accepted": ACCEPTED}


def of_fit(curves: pd.DataFrame, labels: dict[str, str] | None = None) -> pd.DataFrame:
    """Return the curves of a calibration: condition, label, role, time, drive, recorded and base model's response."""
    found = curves.rename(columns={f"simulated_{unit}": f"base_{unit}" for unit in UNITS})
    found = found.drop(columns=[name for name in found if str(name).startswith(("spread_", "surrogate_"))])
    return _labelled(found, labels or {})


def of_diagnosis(explained: pd.DataFrame, labels: dict[str, str]) -> pd.DataFrame:
    """Return the curves of a diagnosis, as `of_fit`, with those of the accepted model and with noise_nm."""
    return _labelled(explained.rename(columns={"before_nm": "base_nm", "after_nm": "accepted_nm"}), labels)


def _labelled(curves: pd.DataFrame, labels: dict[str, str]) -> pd.DataFrame:
    curves.insert(1, "label", [labels.get(name, name) for name in curves["condition"]])
    return curves


def conditions(frame: pd.DataFrame) -> list[pd.DataFrame]:
    """Return the part of each condition of a table of curves."""
    return [part for _, part in frame.groupby("condition", sort=False)]


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


def panels(figure: Figure, frame: pd.DataFrame, size: tuple[float, float]) -> Iterator[tuple[pd.DataFrame, Axes]]:
    """Yield the part of each condition and a panel of least width and height `size` [inch] to draw it on.

    Each panel has its title; labels of axes stay at the left and below, and the legend of the first lies below all.
    """
    parts = conditions(frame)
    axes = grid(figure, len(parts), size)
    for k, (curve, axis) in enumerate(zip(parts, axes, strict=True)):
        axis.set_title(f"{curve['label'].iloc[0]}{ROLES[curve['role'].iloc[0]]}", fontsize=SMALLEST)
        yield curve, axis
        if not bottom_row(axes, k):
            axis.set_xlabel("")
        if not first_column(axes, k):
            axis.set_ylabel("")
    legend_below(figure, axes[0])


def draw_models(axis: Axes, curve: pd.DataFrame, drawn_as: Callable[[pd.Series], tuple[pd.Series, pd.Series]]) -> None:
    """Draw what `drawn_as` makes of the response of each model that a condition has, as x and y."""
    for name, words in MODELS.items():
        if (values := response(curve, name)) is not None:
            axis.plot(*drawn_as(values), label=words, **LOOKS[name])


def models_in(frame: pd.DataFrame, dashed: str = "dashed", solid: str = "solid") -> str:
    """Return which models a table of curves holds, with the style of their lines."""
    accepted = any(str(name).startswith("accepted_") for name in frame)
    return f"the base model ({dashed})" + (f" and the accepted model ({solid})" if accepted else "")
