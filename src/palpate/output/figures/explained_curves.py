"""What a diagnosis found: where the misfit lies, the misfit in time before and after, and the explanations."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.diagnosis.locate import CERTAIN
from palpate.mechanisms import MECHANISMS
from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, SIMULATED, SURROGATE, mark_synthetic

MOST = 9  # explanations that are drawn
PARTS = [(segment, part) for segment in ("loading", "hold", "unloading") for part in ("early", "late")]


def compose(figure: Figure, content: Mapping[str, Any], curves: pd.DataFrame, title: str, synthetic: bool) -> None:
    """Draw the map, the misfits and the candidates on an empty figure, which takes the size that this needs.

    Parameters
    ----------
    figure
        An empty figure.
    title
        Title of the figure.
    synthetic
        Whether the figure is marked as one of synthetic recordings.
    content
        Of `diagnosis.json`.
    curves
        Of `palpate.diagnosis.diagnosis_result.curves`.
    """
    names = list(dict.fromkeys(curves["condition"]))
    columns = min(4, len(names))
    rows = -(-len(names) // columns)
    figure.set_size_inches(DOUBLE_COLUMN, 2.6 + 1.5 * rows)
    top, bottom = figure.subfigures(2, 1, height_ratios=[2.3, 1.5 * rows], squeeze=False)[:, 0]
    left, right = top.subplots(1, 2, gridspec_kw={"width_ratios": [1.5, 1]})
    _map(content, names, left)
    evidence(right, content)
    axes = bottom.subplots(rows, columns, squeeze=False).ravel()
    for blank in axes[len(names) :]:
        blank.set_axis_off()
    for k, (name, axis) in enumerate(zip(names, axes, strict=False)):
        _misfit(
            curves[curves["condition"] == name], axis, content["verdict"] in ("identified", "suspected", "ambiguous")
        )
        if k % columns == 0:
            axis.set_ylabel("rec. - sim. [nm]")
        if k >= len(names) - columns:
            axis.set_xlabel("time [s]")
    handles, labels = axes[0].get_legend_handles_labels()
    bottom.legend(handles, labels, loc="outside lower right", ncols=3, fontsize=6.5)
    figure.suptitle(textwrap.fill(f"{title}: {content['verdict']}", 100), fontsize=9)
    mark_synthetic(figure, synthetic)


def _map(content: Mapping[str, Any], names: Sequence[str], axis) -> None:
    """Colour each part of each test by its mean misfit, in the order of the study; a dot marks what is significant."""
    located = {row["condition"] for row in content["location"]}
    conditions = [name for name in names if name in located]
    found = {(row["segment"], row["part"]) for row in content["location"]}
    parts = [part for part in PARTS if part in found]
    values = np.full((len(conditions), len(parts)), np.nan)
    shown = [row for row in content["location"] if (row["segment"], row["part"]) in parts]
    for row in shown:
        i, j = conditions.index(row["condition"]), parts.index((row["segment"], row["part"]))
        values[i, j] = row["residual_nm"]
        if row["q_value"] < CERTAIN:
            axis.plot(j, i, "o", color=RECORDED, ms=4, mec="white", mew=0.7)
    largest = max(float(np.nanmax(np.abs(values))), 1e-9)
    image = axis.imshow(values, cmap="RdBu_r", vmin=-largest, vmax=largest, aspect="auto")
    axis.set_xticks(range(len(parts)), [f"{part}\n{segment}" for segment, part in parts], fontsize=5.5)
    axis.set_yticks(range(len(conditions)), conditions, fontsize=6.5)
    axis.spines[["left", "bottom"]].set_visible(False)
    axis.tick_params(length=0)
    certain = any(row["q_value"] < CERTAIN for row in shown)
    meaning = "dot: q" if certain else "no part shown has q"
    axis.set_title(f"base model, recorded - simulated [nm]; {meaning} < {CERTAIN:g}")
    axis.figure.colorbar(image, ax=axis, shrink=0.85)


def evidence(axis: Axes, content: Mapping[str, Any]) -> None:
    """Draw the log evidence of what was tried, relative to the base model, accepted ones in colour.

    The number beside each bar is relative to the best one. Of many explanations the best are drawn, and the base model.
    """
    every = content["tried"]
    tried, later = every[:MOST], [entry for entry in every[MOST:] if not entry["mechanisms"]]
    tried = [*tried[:-1], *later] if later else tried
    accepted = [candidate["mechanisms"] for candidate in content["candidates"]]
    base = next((entry["log_evidence"] for entry in every if not entry["mechanisms"]), 0.0)
    names = []
    for k, entry in enumerate(tried):
        titles = [MECHANISMS[key].title for key in entry["mechanisms"]]
        lines = [" + ".join(titles[:2]) or "base model", *(f"+ {title}" for title in titles[2:])]
        names.append("\n".join(lines))
        is_accepted = entry["mechanisms"] in accepted
        axis.barh(k, entry["log_evidence"] - base, color=SIMULATED if is_accepted else "0.8")
        behind = entry["log_evidence"] - tried[0]["log_evidence"]
        axis.text(1.02, k, f"{behind:.1f}", transform=axis.get_yaxis_transform(), va="center", fontsize=6)
    axis.set_ylim(len(tried) - 0.4, -0.6)
    axis.set_yticks(range(len(tried)), names, fontsize=5.5, linespacing=0.9)
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)
    axis.set_xlabel("log evidence relative to the base model\n(numbers: relative to the best)")
    found = "accepted ones in red" if accepted else "none accepted"
    adequate = content["verdict"] == "adequate"
    count = f"{len(every)} explanations tried" if len(every) <= MOST else f"best {MOST} of {len(every)} tried"
    axis.set_title("base model adequate, no other tried" if adequate else f"{count}; {found}")


def _misfit(curve: pd.DataFrame, axis, improved: bool) -> None:
    axis.axhline(0, color="0.7", lw=0.6)
    noise = 2 * curve["noise_nm"]
    axis.fill_between(
        curve["time_s"],
        -noise,
        noise,
        color="0.9",
        lw=0,
        label="noise and scatter of the mean, 95 %, without the error of the model",
    )
    before = curve["recorded_nm"] - curve["before_nm"]
    axis.plot(curve["time_s"], before, color=SURROGATE, lw=0.9, label="base model")
    if improved:
        after = curve["recorded_nm"] - curve["after_nm"]
        axis.plot(curve["time_s"], after, color=SIMULATED, lw=0.9, label="best explanation")
    axis.set_title(f"{curve['condition'].iloc[0]}, {curve['role'].iloc[0]}", fontsize=7)
