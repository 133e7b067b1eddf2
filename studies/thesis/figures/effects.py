"""Panels that both analyses of variance share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from palpate.output.figures.style import RECORDED, SIMULATED, SURROGATE


def contributions(axis, series: Mapping[str, Any], symbols: Mapping[str, str]) -> None:
    """Draw per cent contributions of every factor: thesis, error, largest depth."""
    places = np.arange(len(symbols))
    for k, (key, label, colour) in enumerate(
        (
            ("thesis", "thesis, error", "0.75"),
            ("contributions", "error", SIMULATED),
            ("depth_contributions", "largest depth", SURROGATE),
        )
    ):
        values = [series[key][name] for name in symbols]
        bars = axis.barh(places + 0.27 * (k - 1), values, 0.25, color=colour, label=label)
        axis.bar_label(bars, fmt="%.3g", fontsize=6, padding=2)
    axis.set_yticks(places, symbols.values())
    axis.invert_yaxis()
    axis.set_xlabel("contribution [%]")
    axis.set_xlim(0, 112)
    axis.legend(loc="lower right", fontsize=7)


def main_effects(axes, series: Mapping[str, Any], symbols: Mapping[str, str], labels: tuple[str, str]) -> None:
    """Draw the mean of both responses at each level of every factor."""
    for row, key, label in zip(axes, ("main_effects", "depth_effects"), labels, strict=True):
        row[0].set_ylabel(f"mean {label}")
        for axis, (name, symbol) in zip(row, symbols.items(), strict=True):
            axis.plot(series[key][name]["levels"], series[key][name]["means"], "o-", color=RECORDED, ms=3.5)
            axis.set_xlabel(symbol)
            levels = series[key][name]["levels"]
            axis.set_xticks([levels[0], levels[-1]])
            axis.margins(x=0.2)
            axis.tick_params(labelsize=6.5)
