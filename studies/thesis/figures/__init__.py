"""Figures of the thesis' studies, one a file; every file of this folder that defines ``FIGURE`` is found by itself.

They are made as those of any study (`palpate.output.written_figures`), from the saved outcome of the study that they
are named after.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from indentation_files.discovery import discover
from palpate.output.figures.paper_figure import PaperFigure

FIGURES: dict[str, PaperFigure[Mapping[str, Any]]] = {
    found.name: found for found in discover(__name__, __path__, "FIGURE")
}
