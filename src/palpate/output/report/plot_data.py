"""The numbers behind the interactive curves: those of the figures and the tests, thinned to what a screen shows."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from palpate.output.figures import curve_panels, curves, residuals
from palpate.output.saved_set import SavedSet
from palpate.study.protocol import LOAD

POINTS = 300  # of one curve, at most
TOTAL = 120_000  # numbers of all tests on a page, about 1 MB
DIGITS = 5
ESCAPED = r"\u003c"  # so that no name ends the element


def plot_data(sets: Sequence[SavedSet]) -> str:
    """Return a script element (JSON) with the curves of all conditions of all sets."""
    count = sum(len(tests) for saved in sets for tests in saved.tests.values())
    most = max(20, min(POINTS, TOTAL // (3 * max(count, 1))))
    content = json.dumps({saved.name: _set(saved, most) for saved in sets}, separators=(",", ":")).replace(
        "<", r"\u003c"
    )
    return f'<script type="application/json" id="curves">{content.replace("<", ESCAPED)}</script>'


def _set(saved: SavedSet, most: int) -> list[dict[str, Any]]:
    """Return the conditions of a set, each with its curves."""
    table, differences = curves.table(saved), residuals.table(saved)
    conditions = []
    for condition in saved.study.conditions:
        curve, left = (frame[frame["condition"] == condition.name] for frame in (table, differences))
        if not len(curve):
            continue
        unit, drive = curve_panels.unit_of(curve), condition.protocol
        rows = _rows(len(curve), POINTS)
        found: dict[str, Any] = {
            "label": saved.labels[condition.name],
            "name": condition.name,
            "role": "held out" if condition.role == "validate" else "fitted",
            "unit": unit,
            "drive": drive.control,
            "time": _numbers(curve["time_s"], rows),
            "driven": _numbers(drive.sample_drive, rows) if len(drive.sample_drive) == len(curve) else [],
        }
        for key, frame in (("curve", curve), ("left", left)):
            names = ("recorded", "base", "accepted") if key == "curve" else ("base", "accepted", "band")
            found[key] = {
                name: _numbers(each, rows) for name in names if (each := curve_panels.response(frame, name)) is not None
            }
        found["tests"] = [_test(test, most) for test in saved.tests.get(condition.name, ())]
        conditions.append(found)
    return conditions


def _test(test: Any, most: int) -> dict[str, Any]:
    rows = _rows(len(test.time), most)
    return {"name": test.name} | {key: _numbers(getattr(test, key), rows) for key in ("time", LOAD, "depth")}


def _rows(count: int, most: int) -> np.ndarray:
    """Return at most so many of `count` rows, evenly, first and last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def _numbers(values: pd.Series | np.ndarray, rows: np.ndarray) -> list[float | None]:
    chosen = np.asarray(values, dtype=float)[rows]
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in chosen]
