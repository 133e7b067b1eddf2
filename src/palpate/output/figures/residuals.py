"""Recorded less simulated response in time, of the base model and of the accepted one, beside the noise."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from palpate.observables import UNITS
from palpate.output.figures.curves import ROLES, of_fit, response, unit_of
from palpate.output.figures.paper_figure import PaperFigure, bottom_row, first_column, grid, legend_below
from palpate.output.figures.style import ACCEPTED, BASE
from palpate.output.saved_set import ALL, SavedSet

COVERED = 1.96  # standard deviations on either side, which hold 95 % of a normal distribution


def table(saved: SavedSet) -> pd.DataFrame:
    """Return for every condition time, residuals of base and accepted model, and half the width of the noise."""
    labels = saved.labels
    if saved.explained is not None:
        found = saved.explained.rename(columns={"before_nm": "base_nm", "after_nm": "accepted_nm"})
        found.insert(1, "label", found["condition"].map(labels))
        found["band_nm"] = COVERED * found.pop("noise_nm")
        models = ["base", *(["accepted"] if saved.accepted else [])]
    else:
        found, models = of_fit(saved.fits[ALL], labels), ["base"]
        for unit in UNITS:
            if f"spread_{unit}" in saved.fits[ALL]:
                found[f"band_{unit}"] = COVERED * saved.fits[ALL][f"spread_{unit}"].to_numpy()
    columns = {key: found[key] for key in ("condition", "label", "role", "time_s")}
    for unit in UNITS:
        for name in models:
            if f"{name}_{unit}" in found:
                columns[f"{name}_{unit}"] = found[f"recorded_{unit}"] - found[f"{name}_{unit}"]
        if f"recorded_{unit}" in found:
            columns[f"recorded_{unit}"] = found[f"recorded_{unit}"]
        if f"band_{unit}" in found:
            columns[f"band_{unit}"] = found[f"band_{unit}"]
    return pd.DataFrame(columns)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel a condition, those in nm on one scale."""
    parts = [part for _, part in frame.groupby("condition", sort=False)]
    axes = grid(figure, len(parts), (1.6, 1.3))
    for k, (curve, axis) in enumerate(zip(parts, axes, strict=True)):
        axis.axhline(0, color="0.7", lw=0.6)
        if (band := response(curve, "band")) is not None:
            axis.fill_between(curve["time_s"], -band, band, color="0.88", lw=0, label="noise and scatter, 95 %")
        for name, look, words in (("base", BASE, "base model"), ("accepted", ACCEPTED, "accepted model")):
            if (values := response(curve, name)) is not None:
                axis.plot(curve["time_s"], values, label=words, **look)
        axis.set_title(f"{curve['label'].iloc[0]}{ROLES[curve['role'].iloc[0]]}")
        if bottom_row(axes, k):
            axis.set_xlabel("time [s]")
        if first_column(axes, k):
            axis.set_ylabel(f"rec. − sim. [{unit_of(curve)}]")
    spans = [axis.get_ylim() for axis in axes]
    if {unit_of(part) for part in parts} == {"nm"}:
        for axis in axes:
            axis.set_ylim(min(low for low, _ in spans), max(high for _, high in spans))
    legend_below(figure, axes[0])


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    accepted = any(str(name).startswith("accepted_") for name in frame)
    lines = "the base model (dashed)" + (" and the accepted model (solid)" if accepted else "")
    return (
        f"Recorded less simulated response in time for {lines}. The grey band holds 95 % of the noise and scatter of a "
        "mean curve, without the error of the model."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the root mean square residual of each model, over all tests."""
    texts = []
    for name, words in (("base", "the base model"), ("accepted", "the accepted model")):
        columns = [frame[f"{name}_{unit}"].dropna() for unit in UNITS if f"{name}_{unit}" in frame]
        units = [unit for unit in UNITS if f"{name}_{unit}" in frame]
        texts += [
            f"that of {words} is {float(np.sqrt(np.mean(values**2))):.3g} {unit}"
            for values, unit in zip(columns, units, strict=True)
            if len(values)
        ]
    return f"Residuals; in the root mean square {', '.join(texts)}."


FIGURE = PaperFigure("residuals", "Recorded less simulated response", table, draw, caption, seen)
