"""``palpate read``: a vendor's file in, recording CSVs out."""

from __future__ import annotations

import argparse

from indentation_files import command
from palpate.cli import warn

NAME = "read"
HELP = command.HELP
add_arguments = command.add_arguments


def run(arguments: argparse.Namespace) -> int:
    """Write one CSV a test, with what the file states of it as comments; with ``--survey`` figures and a table too."""
    if not arguments.survey:
        return command.run(arguments, warn)
    from palpate.output.figures.recorded_test import draw

    return command.run(arguments, warn, draw)
