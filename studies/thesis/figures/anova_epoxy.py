"""Analysis of variance of chapter 5: contributions beside the thesis', and main effects."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from palpate.output.figures.style import DOUBLE_COLUMN, save, styled
from studies.thesis.figures.effects import contributions, main_effects
from studies.thesis.figures.estimates import EPOXY


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw contributions on the left, main effects on both responses on the right."""
    figure = Figure(figsize=(DOUBLE_COLUMN, 3.8))
    left, right = figure.subfigures(1, 2, width_ratios=[1, 2], squeeze=False)[0]
    contributions(left.subplots(), outcome["series"], EPOXY)
    labels = ("error [nm²]", "largest depth [nm]")
    main_effects(right.subplots(2, 6, sharey="row"), outcome["series"], EPOXY, labels)
    figure.suptitle("Epoxy, L27, 1 mN in 30 s (error against synthetic recordings)", fontsize=9)
    save(figure, path)
