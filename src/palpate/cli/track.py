"""``palpate track``: which runs have not reached MLflow yet, and sending them."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError

NAME = "track"
HELP = "list the runs that have not reached MLflow yet, or send them"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--send", action="store_true", help="send them; without it they are listed")
    parser.add_argument("--results", type=Path, metavar="FOLDER", help="the folder of results (default: results)")


def run(arguments: argparse.Namespace) -> int:
    """List or send what every study of a results folder has not sent; exit code 1 where something stays behind.

    Raises
    ------
    InputError
        When the given folder is missing.
    """
    from palpate.workflow_support.tracking import pending, send

    if arguments.results is not None and not arguments.results.is_dir():
        raise InputError("the folder is missing", remedy="give a folder of results", file=arguments.results)
    left, results = 0, arguments.results or Path("results")
    folders = sorted(results.glob("*/tracking"))
    if not folders:
        print(f"no runs in {results}")
    for folder in folders:
        if arguments.send:
            send(folder)
        waiting = pending(folder)
        left += len(waiting)
        print(
            f"{folder.parent.name}: {len(waiting)} records are on disk only"
            if waiting
            else f"{folder.parent.name}: sent"
        )
    return 1 if left else 0
