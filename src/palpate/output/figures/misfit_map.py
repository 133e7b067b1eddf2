"""Where the base model fails: the mean residual of each part of each test, and which parts are significant."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from palpate.diagnosis.locate import CERTAIN
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.saved_set import SavedSet

PARTS = [(segment, part) for segment in ("loading", "hold", "unloading") for part in ("early", "late")]
INK = 0.55  # share of the largest residual above which a number is written in white


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return one row a part: condition, label, segment, part, mean residual [nm], and its q-value."""
    if not saved.diagnosis or not saved.diagnosis["location"]:
        return None
    found = pd.DataFrame(saved.diagnosis["location"])
    found = found[[pair in PARTS for pair in zip(found["segment"], found["part"], strict=True)]]
    order = [condition.name for condition in saved.study.conditions]
    found = found.sort_values("condition", key=lambda names: names.map(order.index), kind="stable")
    found.insert(1, "label", found["condition"].map(saved.labels))
    return found[["condition", "label", "segment", "part", "residual_nm", "q_value"]] if len(found) else None


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a cell a part, with its number; a frame marks what is significant."""
    names = list(dict.fromkeys(frame["label"]))
    present = set(zip(frame["segment"], frame["part"], strict=True))
    parts = [pair for pair in PARTS if pair in present]
    figure.set_figheight(0.26 * len(names) + 0.95)
    axis = figure.subplots()
    values = frame.pivot_table("residual_nm", "label", ["segment", "part"], sort=False).reindex(names)[parts].to_numpy()
    largest = max(float(np.nanmax(np.abs(values))), 1e-9)
    axis.imshow(values, cmap="RdBu_r", vmin=-1.25 * largest, vmax=1.25 * largest, aspect="auto")
    certain = frame.pivot_table("q_value", "label", ["segment", "part"], sort=False).reindex(names)[parts].to_numpy()
    for (i, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            weight = "bold" if certain[i, j] < CERTAIN else "normal"
            ink = "white" if abs(value) > INK * 1.25 * largest else "black"
            axis.text(j, i, f"{value:+.1f}".replace("-", "−"), ha="center", va="center", color=ink, weight=weight)
            if weight == "bold":
                axis.plot(j - 0.4, i, "o", color=ink, ms=3)
    axis.set_xticks(range(len(parts)), [f"{part}\n{segment}" for segment, part in parts])
    axis.set_yticks(range(len(names)), names)
    axis.spines[["left", "bottom"]].set_visible(False)
    axis.tick_params(length=0)


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    certain = bool((frame["q_value"] < CERTAIN).any())
    mark = f"a dot and bold type mark q < {CERTAIN:g}" if certain else f"no part alone is significant (q < {CERTAIN:g})"
    return (
        "Mean of the recorded less the simulated depth [nm] in each part of each test. The base model is fitted as if "
        "its law were off by no more than the tolerance of the study, which the test of each part supposes; the curves "
        f"of the fit itself may lie elsewhere. {mark[0].upper()}{mark[1:]}. The q-value is the p-value, corrected for "
        "the number of parts."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the part with the largest residual."""
    row = frame.iloc[int(frame["residual_nm"].abs().to_numpy().argmax())]
    return (
        f"The largest mean residual of the base model is {row['residual_nm']:+.1f} nm, {row['part']} in the "
        f"{row['segment']} of {row['label']}."
    )


FIGURE = PaperFigure("misfit_map", "Where the base model fails", table, draw, caption, seen)
