"""Residual profiles of imprints, recorded and as the finite elements leave them with the calibrated law."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure, grid, legend_below
from palpate.output.figures.style import BASE, RECORDED, SMALLEST
from palpate.output.saved_set import ALL, SavedSet

MARKS = 40  # recorded points that are drawn of a profile


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return the profiles of all imprints: imprint, of, radius_nm, height_nm, predicted_nm; None without any."""
    found = saved.calibrations[ALL].get("imprint") or {}
    parts = [pd.DataFrame({"imprint": name, "of": each["of"]} | each["curve"]) for name, each in found.items()]
    return pd.concat(parts, ignore_index=True) if parts else None


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel an imprint."""
    parts = [part for _, part in frame.groupby("imprint", sort=False)]
    axes = grid(figure, len(parts), (2.0, 1.9))
    for axis, part in zip(axes, parts, strict=True):
        axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
        axis.plot(part["radius_nm"], part["predicted_nm"], label="finite elements", **BASE)
        some = part.iloc[:: max(1, len(part) // MARKS)]
        axis.plot(
            some["radius_nm"], some["height_nm"], "o", color=RECORDED, ms=2.4, mfc="none", mew=0.6, label="recorded"
        )
        axis.set(xlabel="distance from the middle [nm]", ylabel="height [nm]")
        axis.set_title(f"{part['imprint'].iloc[0]}, {part['of'].iloc[0]}", fontsize=SMALLEST)
    legend_below(figure, axes[0])


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Residual profiles of imprints (circles) and the surface of the finite elements at the end of the test with "
        "the base model's law (dashed). Imprints take no part in any fit."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the pile-up of each imprint."""
    texts = (
        f"{name}: highest {part['height_nm'].max():.3g} nm recorded, {part['predicted_nm'].max():.3g} nm predicted"
        for name, part in frame.groupby("imprint", sort=False)
    )
    return "; ".join(texts) + "."


FIGURE = PaperFigure("imprint", "Imprints", table, draw, caption, seen)
