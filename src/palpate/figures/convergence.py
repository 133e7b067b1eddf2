"""Convergence of the genetic algorithm."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.figures.style import mark_synthetic, plt, save


def draw(calibrations: Mapping[str, Mapping[str, Any]], path: str | Path, title: str, synthetic: bool) -> None:
    """Draw the best sum of objectives over generations for every condition set."""
    figure, axis = plt.subplots(figsize=(3.5, 2.6))
    for name, calibration in calibrations.items():
        history = calibration["history"]
        axis.semilogy([row["generation"] for row in history], [row["best_sum"] for row in history], label=name)
    axis.set_xlabel("generation")
    axis.set_ylabel("best sum of objectives")
    axis.set_title(title)
    axis.legend()
    mark_synthetic(figure, synthetic)
    save(figure, path)
