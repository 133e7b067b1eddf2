"""``palpate figures``: the figures of a study for a paper, from its saved results alone."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError

NAME = "figures"
HELP = "draw the figures of a study for a paper, from its saved results"
FORMATS = ("pdf", "svg", "png")
UNITS = {"mm": 1 / 25.4, "cm": 1 / 2.54, "in": 1.0, "": 1.0}  # inches
NARROWEST, WIDEST = 1.5, 20.0  # inches


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", metavar="STUDY", help="the study's file, or its name below results")
    formats = f"of the files, several joined by commas: {', '.join(FORMATS)} (default: pdf)"
    parser.add_argument("--format", type=_formats, default=["pdf"], metavar="FORMATS", help=formats)
    parser.add_argument(
        "--width", type=_width, default=3.5, help="of the figures, in inches, or as 90mm (default: 3.5)"
    )
    parser.add_argument("--style", type=Path, metavar="FILE.mplstyle", help="a style sheet of Matplotlib")
    parser.add_argument("--no-title", action="store_true", help="leave the titles above the figures off")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FOLDER", help="where they are written (default: results/STUDY/paper)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Draw every figure, and print where it is.

    Raises
    ------
    InputError
        When there is no such study, its results are not complete, or the style cannot be read.
    """
    from palpate.configuration.study_file import study_from
    from palpate.output.written_figures import write_figures
    from palpate.workflow_support.named_study import named_study
    from palpate.workflow_support.saved_results import saved_sets

    if arguments.style is not None and not arguments.style.is_file():
        raise InputError("is no file", remedy="give a style sheet of Matplotlib", file=arguments.style, place="--style")
    study = study_from(*named_study(arguments.study))
    results = Path("results") / study.name
    sets = saved_sets(study, results)
    folder = arguments.output or results / "paper"
    style, titled = arguments.style, not arguments.no_title
    print(*write_figures(sets, folder, arguments.format, arguments.width, style, titled), sep="\n")
    return 0


def _formats(text: str) -> list[str]:
    names = [name.strip().lower() for name in text.split(",")]
    for name in names:
        if name not in FORMATS:
            raise argparse.ArgumentTypeError(f"{name!r} is no format; use some of: {', '.join(FORMATS)}")
    return list(dict.fromkeys(names))


def _width(text: str) -> float:
    unit = next(unit for unit in UNITS if text.strip().endswith(unit))
    try:
        width = float(text.strip().removesuffix(unit)) * UNITS[unit]
    except ValueError:
        width = 0.0
    if not NARROWEST <= width <= WIDEST:
        wanted = f"a width from {NARROWEST} to {WIDEST:g} inches, such as 3.5 or 90mm"
        raise argparse.ArgumentTypeError(f"{text!r} is not {wanted}")
    return width
