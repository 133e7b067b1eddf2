"""Parameters with 95 % intervals: accepted model, base model, and each condition set by itself, over their ranges."""

from __future__ import annotations

import re

import pandas as pd
from matplotlib.figure import Figure

from palpate.base.parameters import Parameter, in_words
from palpate.output.figures.paper_figure import PaperFigure, first_column, grid
from palpate.output.figures.style import RECORDED, SIMULATED, TRUTH
from palpate.output.saved_set import SavedSet

ACCEPTED = "accepted"


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return one row a parameter and fit: estimate, interval, identified, and the range of the study."""
    rows = []
    for name in saved.study.free_parameters:
        low, high = min(saved.study.levels[name]), max(saved.study.levels[name])
        several = len(saved.calibrations) > 1
        fits = {
            f"base, {key}" if several else "base": calibration["parameters"].get(name)
            for key, calibration in saved.calibrations.items()
        }
        if saved.accepted and saved.diagnosis:
            fits = {ACCEPTED: saved.diagnosis["parameters"]["after"].get(name)} | fits
        rows += [
            {"parameter": name, "label": label(saved.study.declared[name]), "fit": fit}
            | {key: entry[key] for key in ("estimate", "lower", "upper", "identified")}
            | {"range_from": low, "range_to": high, "truth": saved.truth.get(name)}
            for fit, entry in fits.items()
            if entry
        ]
    return pd.DataFrame(rows).astype({"truth": float}) if rows else None


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw one panel a parameter."""
    parts = [part.reset_index(drop=True) for _, part in frame.groupby("parameter", sort=False)]
    fits = list(dict.fromkeys(frame["fit"]))
    axes = grid(figure, len(parts), (1.3, 0.75 + 0.2 * len(fits)), most=6)
    for k, (rows, axis) in enumerate(zip(parts, axes, strict=True)):
        for row in rows.to_dict("records"):
            place, accepted = fits.index(row["fit"]), row["fit"] == ACCEPTED
            colour, mark = (SIMULATED, "s") if accepted else (RECORDED, "o")
            axis.plot([row["lower"], row["upper"]], [place, place], color=colour, lw=2.2 if accepted else 1.2)
            axis.plot(row["estimate"], place, mark, color=colour, mfc=colour if row["identified"] else "white", ms=4.5)
        if rows["truth"].notna().all():
            axis.axvline(rows["truth"].iloc[0], color=TRUTH, lw=1.2, ls="--")
        first, last = rows["range_from"].iloc[0], rows["range_to"].iloc[0]
        axis.axvspan(first, last, color="0.93", lw=0, zorder=0)
        low, high = min(first, rows["lower"].min()), max(last, rows["upper"].max())
        axis.set_xlim(low - 0.05 * (high - low), high + 0.05 * (high - low))
        axis.locator_params(axis="x", nbins=4)
        axis.set_title(in_words(rows["parameter"].iloc[0]).replace(" ", "\n", 1))
        axis.set_xlabel(rows["label"].iloc[0])
        axis.set_yticks(range(len(fits)), fits if first_column(axes, k) else [""] * len(fits))
        axis.set_ylim(len(fits) - 0.5, -0.5)


def label(parameter: Parameter) -> str:
    """Return symbol and unit in mathtext, such as ``$C_s$ [GPa$^{-(2m_s+1)}$/s]``; pure numbers have no unit."""
    unit = re.sub(r"\^(-\(.*?\))", r"$^{\1}$", parameter.unit)
    return f"${parameter.symbol}$" + ("" if unit == "-" else f" [{unit}]")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    truth = "; the dashed line is the true value" if frame["truth"].notna().any() else ""
    accepted = "the accepted model (squares) and " if ACCEPTED in set(frame["fit"]) else ""
    return (
        f"Estimates and 95 % intervals of {accepted}the base model (circles), calibrated on each condition set. Open "
        f"symbols: not identified. Shaded: range of the study{truth}. Sets that disagree are a sign that an effect is "
        "missing in the base model."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the first parameter's estimates."""
    first = frame[frame["parameter"] == frame["parameter"].iloc[0]]
    texts = (f"{row.fit}: {row.estimate:.3g} ({row.lower:.3g} to {row.upper:.3g})" for row in first.itertuples())
    return f"{in_words(str(first['parameter'].iloc[0]))}: {'; '.join(texts)}."


FIGURE = PaperFigure("parameters", "Parameters", table, draw, caption, seen)
