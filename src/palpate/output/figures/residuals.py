"""Recorded less simulated response in time, of the base model and of the accepted one, beside the noise."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from palpate.observables import UNITS
from palpate.output.figures.curve_panels import (
    MODELS,
    conditions,
    draw_models,
    models_in,
    of_diagnosis,
    of_fit,
    panels,
    response,
    unit_of,
)
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.saved_set import ALL, SavedSet

COVERED = 1.96  # standard deviations on either side, which hold 95 % of a normal distribution


def table(saved: SavedSet) -> pd.DataFrame:
    """Return for every condition time, residuals of base and accepted model, and half the width of the noise."""
    models = list(MODELS) if saved.accepted else ["base"]
    if saved.explained is not None:
        found = of_diagnosis(saved.explained, saved.labels)
        noise = {"nm": found["noise_nm"]}
    else:
        fit = saved.fits[ALL].reset_index(drop=True)
        found = of_fit(fit, saved.labels)
        noise = {unit: fit[f"spread_{unit}"] for unit in UNITS if f"spread_{unit}" in fit}
    columns = {key: found[key] for key in ("condition", "label", "role", "time_s")}
    for unit in UNITS:
        for name in models:
            if f"{name}_{unit}" in found:
                columns[f"{name}_{unit}"] = found[f"recorded_{unit}"] - found[f"{name}_{unit}"]
        if f"recorded_{unit}" in found:
            columns[f"recorded_{unit}"] = found[f"recorded_{unit}"]
        if unit in noise:
            columns[f"band_{unit}"] = COVERED * noise[unit]
    return pd.DataFrame(columns)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel a condition, those in nm on one scale."""
    axes = []
    for curve, axis in panels(figure, frame, (1.6, 1.3)):
        time = curve["time_s"]
        axis.axhline(0, color="0.7", lw=0.6)
        if (band := response(curve, "band")) is not None:
            axis.fill_between(time, -band, band, color="0.88", lw=0, label="noise and scatter, 95 %")
        draw_models(axis, curve, partial(_over, time))
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"rec. − sim. [{unit_of(curve)}]")
        axes.append(axis)
    spans = [axis.get_ylim() for axis in axes]
    if {unit_of(part) for part in conditions(frame)} == {"nm"}:
        for axis in axes:
            axis.set_ylim(min(low for low, _ in spans), max(high for _, high in spans))


def _over(time: pd.Series, values: pd.Series) -> tuple[pd.Series, pd.Series]:
    return time, values


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        f"Recorded less simulated response in time for {models_in(frame)}. The grey band holds 95 % of the noise and "
        "scatter of a mean curve, without the error of the model."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the root mean square residual of each model, over all tests."""
    texts = [
        f"that of the {words} is {float(np.sqrt(np.mean(values**2))):.3g} {unit}"
        for name, words in MODELS.items()
        for unit in UNITS
        if f"{name}_{unit}" in frame and len(values := frame[f"{name}_{unit}"].dropna())
    ]
    return f"Residuals; in the root mean square {', '.join(texts)}."


FIGURE = PaperFigure("residuals", "Recorded less simulated response", table, draw, caption, seen)
