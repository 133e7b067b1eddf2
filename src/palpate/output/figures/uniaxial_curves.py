"""Uniaxial tests of the bulk, recorded and as the calibrated law has them with a 95 % band, a panel a test."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.output.figures.curve_panels import ROLES
from palpate.output.figures.paper_figure import PaperFigure, grid, legend_below
from palpate.output.figures.style import BASE, RECORDED, SMALLEST
from palpate.output.saved_set import ALL, SavedSet

MARKS = 40  # recorded points that are drawn of a test
STRAIN, STRESS = "strain", "stress_GPa"
LABELS = {STRAIN: "logarithmic strain", STRESS: "true stress [GPa]", "time_s": "time [s]"}
HELD = 0.01  # of its largest value, within which what was prescribed is held


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return the curves of all tests; None where there are none."""
    tests = saved.calibrations[ALL].get("uniaxial")
    return curves_of(tests) if tests else None


def curves_of(tests: Mapping[str, Mapping[str, Any]]) -> pd.DataFrame:
    """Return the curves of the entry ``uniaxial`` of ``calibration.json``.

    Returns
    -------
    DataFrame
        test, role, control, time_s, strain, stress_GPa, and predicted, lower and upper: of the stress where the strain
        was prescribed, or of the strain.
    """
    parts = []
    for name, entry in tests.items():
        about = {"test": name, "role": entry["role"], "control": entry["control"]}
        parts.append(pd.DataFrame(about | {key: np.array(x, dtype=float) for key, x in entry["curve"].items()}))
    return pd.concat(parts, ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a panel a test."""
    parts = [part for _, part in frame.groupby("test", sort=False)]
    axes = grid(figure, len(parts), (2.0, 1.9))
    for axis, part in zip(axes, parts, strict=True):
        panel(axis, part)
    legend_below(figure, axes[0])


def panel(axis: Axes, part: pd.DataFrame) -> None:
    """Draw one test: stress over strain, or over time what relaxed or crept while the other was held."""
    drive, response = (STRAIN, STRESS) if part["control"].iloc[0] == "strain" else (STRESS, STRAIN)
    x, y = ("time_s", response) if _is_held(part[drive]) else (STRAIN, STRESS)
    shade = {"color": BASE["color"], "alpha": 0.3, "lw": 0, "label": "95 % band"}
    if response == y:
        axis.fill_between(part[x], part["lower"], part["upper"], **shade)
    else:
        axis.fill_betweenx(part[y], part["lower"], part["upper"], **shade)
    law = part.assign(**{response: part["predicted"]})
    axis.plot(law[x], law[y], label="law", **BASE)
    some = part.iloc[:: max(1, len(part) // MARKS)]
    axis.plot(some[x], some[y], "o", color=RECORDED, ms=2.4, mfc="none", mew=0.6, zorder=3, label="recorded")
    axis.set(xlabel=LABELS[x], ylabel=LABELS[y])
    axis.set_title(f"{part['test'].iloc[0]}{ROLES[part['role'].iloc[0]]}", fontsize=SMALLEST)


def _is_held(drive: pd.Series) -> bool:
    """Return whether what was prescribed kept its last value for more than half of the samples."""
    return bool(np.mean(np.abs(drive - drive.iloc[-1]) < HELD * np.abs(drive).max()) > 0.5)


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    fitted = set(frame.loc[frame["role"] == "calibrate", "test"])
    took = f" Of these {', '.join(sorted(fitted))} took part in the calibration." if fitted else ""
    return (
        "Uniaxial tests of the bulk (circles) and the base model's law at a material point under what their machine "
        f"prescribed (dashed), with the 95 % band of the parameters of the calibration (shaded).{took}"
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the error of each test."""
    texts = []
    for name, part in frame.groupby("test", sort=False):
        observed = "stress_GPa" if part["control"].iloc[0] == "strain" else "strain"
        error = float(np.sqrt(np.nanmean((part["predicted"] - part[observed]) ** 2)) / part[observed].abs().max())
        texts.append(f"{name}: root mean square error {100.0 * error:.2g} % of the largest {observed.split('_')[0]}")
    return "; ".join(texts) + "."


FIGURE = PaperFigure("uniaxial", "Uniaxial tests of the bulk", table, draw, caption, seen)
