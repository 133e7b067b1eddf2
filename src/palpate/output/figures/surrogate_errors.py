"""How good the surrogates are: leave-one-out error along the curve, and the spectrum of the snapshots."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.output.figures.style import DOUBLE_COLUMN, save, styled, subplots

MODES = 12  # that the spectrum shows


@styled
def draw(summaries: Mapping[str, Mapping[str, Any]], path: str | Path, title: str) -> None:
    """Draw one line a condition; of the spectrum the first twelve modes."""
    figure, (left, right) = subplots(1, 2, figsize=(DOUBLE_COLUMN, 2.6))
    units = list(dict.fromkeys(summary["unit"] for summary in summaries.values()))
    scales = dict(zip(units, (left, left.twinx() if len(units) > 1 else left), strict=False))
    for k, (name, summary) in enumerate(summaries.items()):
        error = summary[f"loo_rms_{summary['unit']}"]
        scales[summary["unit"]].plot(range(1, len(error) + 1), error, color=f"C{k % 10}")
        spectrum = summary["spectrum"][:MODES]
        right.semilogy(range(1, len(spectrum) + 1), spectrum, ".-", ms=4, color=f"C{k % 10}", label=name)
    left.set_xlabel("point of the curve")
    for unit, axis in scales.items():
        axis.set_ylabel(f"leave-one-out error, rms [{unit}]")
        axis.set_ylim(bottom=0)
    right.legend(fontsize=7)
    right.set_xlabel("POD mode")
    right.set_ylabel("share of energy")
    figure.suptitle(title, fontsize=9)
    save(figure, path)
