"""Subcommands of ``palpate``, one a file: each defines NAME, HELP, ``add_arguments(parser)`` and ``run(arguments)``."""

import sys

from indentation_files.command import path

__all__ = ["path", "warn"]


def warn(line: object) -> None:
    """Print a line of its own on what was given, beside the results."""
    print(f"palpate: {line}", file=sys.stderr)
