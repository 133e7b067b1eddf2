"""Figures of saved results as files, each with its numbers and its caption beside it, and on a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import matplotlib

from palpate.errors import InputError
from palpate.output.figures.catalogue import FIGURES
from palpate.output.figures.paper_figure import PaperFigure, Results
from palpate.output.figures.style import DOUBLE_COLUMN, LOOK, drawn, headed, save
from palpate.output.html_report import image
from palpate.output.saved_set import SavedSet


def write_figures(
    sets: Sequence[SavedSet],
    folder: Path,
    formats: Sequence[str] = ("svg",),
    width: float = DOUBLE_COLUMN,
    style: Path | None = None,
    titles: bool = True,
) -> list[Path]:
    """Write every figure of the results, and return the files of the figures themselves; none leaves the folder empty.

    Parameters
    ----------
    sets
        Results of the sets of recordings of one study.
    folder
        Where they are written.
    formats, width, style, titles
        See `write_figure`.

    Raises
    ------
    InputError
        When Matplotlib cannot read the style.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for stem, figure, saved in figures_of(sets):
        written += write_figure(figure, saved, folder / stem, saved.synthetic, formats, width, style, titles)
    return written


def write_figure(
    figure: PaperFigure[Results],
    results: Results,
    stem: Path,
    synthetic: bool,
    formats: Sequence[str] = ("svg",),
    width: float = DOUBLE_COLUMN,
    style: Path | None = None,
    titles: bool = True,
) -> list[Path]:
    """Write a figure, its numbers (CSV) and its caption (TXT), and return the files of the figure itself.

    None is written where the results hold nothing to draw.

    Parameters
    ----------
    figure, results
        The figure, and what its table is made of.
    stem
        The files without their endings.
    synthetic
        Whether any of the recordings are simulated; a figure that shows recordings says so.
    formats
        Endings of files: some of pdf, svg and png.
    width
        Of the figure [inch].
    style
        A style sheet of Matplotlib on top of the look of palpate's figures.
    titles
        Whether the figure has its title above it.

    Raises
    ------
    InputError
        When Matplotlib cannot read the style.
    """
    numbers = figure.table(results)
    if numbers is None:
        return []
    files = [stem.with_name(f"{stem.name}.{ending}") for ending in (*formats, "csv", "txt")]
    with matplotlib.rc_context(LOOK):
        if style is not None:
            _use(style)
        canvas = drawn(figure.draw, numbers, width=width)
        headed(canvas, figure.title if titles else "", synthetic and not figure.of_study)
        for file in files[:-2]:
            save(canvas, file)
    numbers.to_csv(files[-2], index=False)
    files[-1].write_text(figure.caption(numbers) + "\n", encoding="utf-8")
    return files[:-2]


def figures_of(sets: Sequence[SavedSet]) -> Iterator[tuple[str, PaperFigure[SavedSet], SavedSet]]:
    """Yield name of the file, figure and results of each figure of a study."""
    for figure in FIGURES.values():
        for saved in sets[:1] if figure.of_study else sets:
            yield stem_of(figure, saved), figure, saved


def stem_of(figure: PaperFigure[SavedSet], saved: SavedSet) -> str:
    """Return the name of a figure's files without ending."""
    return figure.name if figure.of_study else f"{saved.name}_{figure.name}"


def shown(figure: PaperFigure[Results], results: Results, file: Path) -> str:
    """Return a figure's file with its caption and what is seen on it as HTML; nothing where there is no file."""
    numbers = figure.table(results) if file.is_file() else None
    return "" if numbers is None else image(file, figure.seen(numbers), figure.caption(numbers))


def _use(style: Path) -> None:
    try:
        matplotlib.rcParams.update(matplotlib.rc_params_from_file(style, use_default_template=False))
    except (OSError, ValueError, UnicodeDecodeError) as error:
        remedy = "give a style sheet of Matplotlib (lines of KEY: VALUE)"
        raise InputError(
            f"is no style sheet: {' '.join(str(error).split())[:120]}", remedy=remedy, file=style
        ) from None
