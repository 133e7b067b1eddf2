"""Writing the figures of saved results as files, each with its numbers and its caption beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from palpate.errors import InputError
from palpate.output.figures.catalogue import FIGURES
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import DOUBLE_COLUMN, LOOK, drawn, headed, save
from palpate.output.saved_set import SavedSet


def write_figures(
    sets: Sequence[SavedSet],
    folder: Path,
    formats: Sequence[str] = ("svg",),
    width: float = DOUBLE_COLUMN,
    style: Path | None = None,
    titles: bool = True,
) -> list[Path]:
    """Write every figure of the results, and return the files of the figures themselves.

    Beside each are its numbers (CSV) and its caption (TXT).

    Parameters
    ----------
    sets
        Results of the sets of recordings of one study.
    folder
        Where they are written.
    formats
        Endings of files: some of pdf, svg and png.
    width
        Of the figures [inch].
    style
        A style sheet of Matplotlib on top of the look of palpate's figures.
    titles
        Whether each figure has its title above it.

    Raises
    ------
    InputError
        When Matplotlib cannot read the style.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with matplotlib.rc_context(LOOK):
        if style is not None:
            _use(style)
        for stem, figure, saved in figures_of(sets):
            numbers = figure.table(saved)
            if numbers is None:
                continue
            canvas: Figure = drawn(figure.draw, numbers, width=width)
            headed(canvas, figure.title if titles else "", saved.synthetic and not figure.of_study)
            for kind in formats:
                written.append(folder / f"{stem}.{kind}")
                save(canvas, written[-1])
            numbers.to_csv(folder / f"{stem}.csv", index=False)
            (folder / f"{stem}.txt").write_text(figure.caption(numbers) + "\n", encoding="utf-8")
    return written


def figures_of(sets: Sequence[SavedSet]) -> Iterator[tuple[str, PaperFigure, SavedSet]]:
    """Yield name of the file, figure and results of each figure of a study."""
    for figure in FIGURES.values():
        for saved in sets[:1] if figure.of_study else sets:
            yield stem_of(figure, saved), figure, saved


def stem_of(figure: PaperFigure, saved: SavedSet) -> str:
    """Return the name of a figure's files without ending."""
    return figure.name if figure.of_study else f"{saved.name}_{figure.name}"


def _use(style: Path) -> None:
    try:
        matplotlib.rcParams.update(matplotlib.rc_params_from_file(style, use_default_template=False))
    except (OSError, ValueError, UnicodeDecodeError) as error:
        remedy = "give a style sheet of Matplotlib (lines of KEY: VALUE)"
        raise InputError(
            f"is no style sheet: {' '.join(str(error).split())[:120]}", remedy=remedy, file=style
        ) from None
