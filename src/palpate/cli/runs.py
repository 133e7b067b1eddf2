"""``palpate runs``: the comparison of runs in the terminal, from the store of MLflow."""

from __future__ import annotations

import argparse
from pathlib import Path

NAME = "runs"
HELP = "compare the runs of studies in the terminal"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--results", type=Path, metavar="FOLDER", help="the folder of results (default: results)")


def run(arguments: argparse.Namespace) -> int:
    """Print one row a set of recordings and execution, the latest first."""
    from palpate.workflow_support.comparison import table

    print(table(arguments.results or Path("results")).to_string(index=False))
    return 0
