"""How good the surrogates are: leave-one-out error along the curve, and the spectrum of the snapshots."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.figures.style import DOUBLE_COLUMN, plt, save

MODES = 12


def draw(summaries: Mapping[str, Mapping[str, Any]], path: str | Path, title: str) -> None:
    """Draw one line a condition; of the spectrum the first twelve modes."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(DOUBLE_COLUMN, 2.6))
    for name, summary in summaries.items():
        left.plot(range(1, len(summary["loo_rms_nm"]) + 1), summary["loo_rms_nm"], label=name)
        spectrum = summary["spectrum"][:MODES]
        right.semilogy(range(1, len(spectrum) + 1), spectrum, ".-", ms=4, label=name)
    left.set_xlabel("point of the curve")
    left.set_ylabel("leave-one-out error, rms [nm]")
    left.set_ylim(bottom=0)
    right.legend(fontsize=7)
    right.set_xlabel("POD mode")
    right.set_ylabel("share of energy")
    figure.suptitle(title, fontsize=9)
    save(figure, path)
