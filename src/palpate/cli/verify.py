"""``palpate verify``: the solver against exact solutions, exact laws, its own convergence and another program."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path
from typing import Any

from palpate.cli.run import CLONE
from palpate.errors import InputError

NAME = "verify"
HELP = "check the solver against exact solutions and CalculiX, and write a report"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("verification"),
        metavar="FOLDER",
        help="the folder that is written (default: verification)",
    )
    parser.add_argument("--quick", action="store_true", help="about a minute: fewer cases, without CalculiX")
    parser.add_argument("--reference", type=Path, metavar="FOLDER", help="folder of reference curves to compare with")


def run(arguments: argparse.Namespace) -> int:
    """Write the report; exit code 1 when a check failed."""
    runner = _runner()
    if arguments.reference is not None and not arguments.reference.is_dir():
        raise InputError("the folder is missing", remedy="give a folder of curves", file=arguments.reference)
    arguments.output.mkdir(parents=True, exist_ok=True)
    settings = runner.Settings.found(arguments.quick, arguments.reference)
    result = runner.run(settings, lambda line: print(line, flush=True))
    runner.write(result, arguments.output)
    print(arguments.output / "report.html")
    runner.refuse_failed(result, arguments.output / "report.html")
    return 0


def _runner() -> Any:
    """Return the module that runs the cases, which only the repository holds.

    Raises
    ------
    InputError
        Where palpate is installed without it.
    """
    if not (CLONE / "studies/verification").is_dir():
        remedy = "run it in a clone, after `pip install -e .` there"
        raise InputError("palpate verify compares the solver with cases that only its repository holds", remedy=remedy)
    sys.path[:0] = [str(CLONE)]
    return importlib.import_module("studies.verification.runner")
