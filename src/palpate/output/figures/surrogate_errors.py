"""How good the surrogates are: leave-one-out error along the curve, and the spectrum of the snapshots."""

from __future__ import annotations

from itertools import cycle

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.saved_set import SavedSet

MODES = 12  # that the spectrum shows
STYLES = ("-", "--", "-.", ":")


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return, of each condition, the root mean square error at each point, and the share of energy of each mode."""
    rows = []
    for name, summary in saved.surrogates.items():
        unit = summary["unit"]
        of = {"condition": name, "label": saved.labels[name], "unit": unit}
        rows += [of | {"point": k, "loo_rms": error} for k, error in enumerate(summary[f"loo_rms_{unit}"], 1)]
        rows += [of | {"mode": k, "energy": share} for k, share in enumerate(summary["spectrum"][:MODES], 1)]
    return pd.DataFrame(rows) if rows else None


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw one line a condition; of the spectrum the first twelve modes."""
    wide = figure.get_figwidth() > 5.0
    figure.set_figheight(2.6 if wide else 4.6)
    left, right = figure.subplots(*((1, 2) if wide else (2, 1)))
    units = list(dict.fromkeys(frame["unit"]))
    scales = dict(zip(units, (left, left.twinx() if len(units) > 1 else left), strict=False))
    for k, ((_, part), style) in enumerate(zip(frame.groupby("condition", sort=False), cycle(STYLES))):
        look = {"color": f"C{k % 7}", "linestyle": style, "lw": 1.0}
        errors, modes = part[part["loo_rms"].notna()], part[part["energy"].notna()]
        scales[part["unit"].iloc[0]].plot(errors["point"], errors["loo_rms"], **look)
        right.semilogy(modes["mode"], modes["energy"], marker=".", ms=4, label=part["label"].iloc[0], **look)
    left.set_xlabel("point of the curve")
    for unit, axis in scales.items():
        axis.set_ylabel(f"leave-one-out error, rms [{unit}]")
        axis.set_ylim(bottom=0)
    right.legend()
    right.set_xlabel("POD mode")
    right.set_ylabel("share of energy")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Leave-one-out error of the surrogates along the curve, and the share of each mode of the proper orthogonal "
        "decomposition in the energy of the snapshots."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the largest error of each condition."""
    parts = frame[frame["loo_rms"].notna()].groupby("label", sort=False)
    return "; ".join(f"{name}: at most {p['loo_rms'].max():.2g} {p['unit'].iloc[0]}" for name, p in parts) + "."


FIGURE = PaperFigure("surrogates", "Error of the surrogates", table, draw, caption, seen, of_study=True)
