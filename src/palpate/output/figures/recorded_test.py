"""One recording: load and depth in time and against each other, segments coloured, contact marked with its interval."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from indentation_files.readers.zero import FOUND
from indentation_files.segments import Segment
from indentation_files.survey import Survey
from palpate.output.figures.style import DOUBLE_COLUMN, save, styled, subplots

COLOURS = {
    "approach": "#9a9a9a",
    "loading": "#c1432e",
    "hold": "#d9a13b",
    "unloading": "#2f6fa7",
    "reloading": "#8a5aa3",
    "drift_hold": "#3f8f4f",
}
NEAR = 0.03  # of the largest load, up to which the panel of the contact shows it


@styled
def draw(found: Survey, path: str | Path, taken: tuple[str, float]) -> None:
    """Draw four panels: load and depth against time, load against depth, and the surroundings of contact.

    Parameters
    ----------
    taken
        Whose decision the contact is that the recording was given, and its depth [nm].
    """
    r, contact = found.recording, found.contact
    figure, axes = subplots(2, 2, figsize=(DOUBLE_COLUMN, 4.6))
    (in_load, curve), (in_depth, near) = axes
    by_segment(in_load, r.time, r.load, found.parts)
    by_segment(in_depth, r.time, r.depth, found.parts)
    by_segment(curve, r.depth, r.load, found.parts)
    by_segment(near, r.depth, r.load, found.parts, marker=".", linestyle="", ms=2.5)
    _around_contact(near, found)
    if len(contact.baseline_time):
        style = {"color": "0.15", "linewidth": "0.8", "linestyle": "--", "label": "baseline"}
        in_load.plot(contact.baseline_time, contact.baseline_load, **style)
        for axis in (curve, near):
            axis.plot(np.interp(contact.baseline_time, r.time, r.depth), contact.baseline_load, **style)
    for axis in (curve, near):
        axis.axvspan(contact.lower, contact.upper, color="0.85", lw=0)
        axis.axvline(contact.depth, color="0.15", lw=0.8, label="contact found, 95 %")
        if taken[0] != FOUND:
            axis.axvline(taken[1], color="0.15", lw=0.8, ls=":", label=f"contact taken: {taken[0]}")
        axis.set_xlabel("depth [nm]")
        axis.set_ylabel("load [mN]")
    for axis, name in ((in_load, "load [mN]"), (in_depth, "depth [nm]")):
        axis.set_xlabel("time [s]")
        axis.set_ylabel(name)
    hold = next((part for part in found.parts if part.kind == "drift_hold"), None)
    if hold:
        in_depth.axvspan(hold.start, hold.end, color="#3f8f4f", alpha=0.15, lw=0)
    if found.drift:
        drift = found.drift
        in_depth.set_title(f"drift hold: {drift.rate:.4f} nm/s ({drift.lower:.4f} to {drift.upper:.4f})")
    near.set_title(f"contact at {contact.depth:.1f} nm ({contact.lower:.1f} to {contact.upper:.1f})")
    labelled = {
        label: handle
        for axis in (in_load, near)
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    figure.legend(labelled.values(), labelled.keys(), loc="outside lower center", ncols=4, fontsize=6.5)
    figure.suptitle(r.name, fontsize=9, x=0.01, ha="left")
    save(figure, path)


def by_segment(axis: Axes, x: np.ndarray, y: np.ndarray, parts: Iterable[Segment], **look: Any) -> None:
    """Draw `y` over `x` on `axis`, one colour a segment of `parts`, each kind once in the legend; whole without any."""
    labels: set[str] = set()
    for part in parts:
        inside, label = slice(part.first, part.last + 1), part.kind.replace("_", " ")
        shown = None if label in labels else label
        axis.plot(x[inside], y[inside], color=COLOURS[part.kind], label=shown, **look)
        labels.add(label)
    if not labels:
        axis.plot(x, y, label="recorded", **look)


def _around_contact(axis, found: Survey) -> None:
    """Limit a panel to the loads up to 3 % of the largest, on the way in; where contact is vague, wider."""
    r, contact = found.recording, found.contact
    span = NEAR * (r.load.max() - contact.load)
    beyond = np.flatnonzero(r.load[contact.index :] > contact.load + span)
    end = contact.index + (int(beyond[0]) if len(beyond) else len(r) - contact.index - 1)
    reach = max(r.depth[end] - contact.depth, contact.upper - contact.lower)
    axis.set_xlim(contact.depth - reach, contact.depth + 1.1 * reach)
    along = np.interp(contact.baseline_time, r.time, r.depth)
    seen = contact.baseline_load[np.abs(along - contact.depth) <= reach]
    axis.set_ylim(seen.min(initial=contact.load) - 0.3 * span, contact.load + 1.1 * span)
