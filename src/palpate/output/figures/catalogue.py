"""The figures of a study's results: every file of this folder that defines ``FIGURE`` is found by itself."""

from pathlib import Path

from indentation_files.discovery import discover
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.saved_set import SavedSet

FIGURES: dict[str, PaperFigure[SavedSet]] = {
    found.name: found for found in discover(__name__.rpartition(".")[0], [str(Path(__file__).parent)], "FIGURE")
}
