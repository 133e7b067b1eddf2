"""How many evaluations each optimiser needs to come within 10, 1 and 0.1 per cent of the least value known."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, SIMULATED, SURROGATE, save, styled, subplots

LEVELS = {"10": "0.65", "1": SURROGATE, "0.1": SIMULATED}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw every run as a dot: evaluations on the left, time on the right; a cross at the budget where it failed."""
    runs, budget = outcome["series"]["runs"], outcome["series"]["budget"]
    names = list(dict.fromkeys(run["optimiser"] for run in runs))
    figure, axes = subplots(1, 2, figsize=(DOUBLE_COLUMN, 2.8), sharey=True)
    for k, name in enumerate(names):
        own = [run for run in runs if run["optimiser"] == name]
        for j, (level, colour) in enumerate(LEVELS.items()):
            place = k + 0.25 * (j - 1)
            hits = [run["reached"][level] for run in own if level in run["reached"]]
            axes[0].plot([hit[0] for hit in hits], [place] * len(hits), "o", color=colour, ms=3, alpha=0.7)
            axes[1].plot([hit[1] for hit in hits], [place] * len(hits), "o", color=colour, ms=3, alpha=0.7)
            missed = len(own) - len(hits)
            if missed:
                axes[0].plot(budget * 1.3, place, "x", color=colour, ms=4)
                axes[0].annotate(
                    f"{missed} runs", (budget * 1.3, place), xytext=(5, -2), textcoords="offset points", fontsize=6
                )
    axes[0].axvline(budget, color=RECORDED, lw=0.6, ls=":")
    axes[0].set_yticks(range(len(names)), names)
    axes[0].invert_yaxis()
    axes[0].set_xlabel("evaluations (cross: budget spent)")
    axes[1].set_xlabel("time [s]")
    for axis in axes:
        axis.set_xscale("log")
    for level, colour in LEVELS.items():
        axes[1].plot([], [], "o", color=colour, ms=3, label=f"within {level} %")
    axes[1].legend(fontsize=7)
    save(figure, path)
