"""Subcommands of ``palpate``, one a file: each defines NAME, HELP, ``add_arguments(parser)`` and ``run(arguments)``."""

import sys
from pathlib import Path


def warn(line: object) -> None:
    """Print a line of its own on what was given, beside the results."""
    print(f"palpate: {line}", file=sys.stderr)


def path(text: str) -> Path:
    """Return the path that an argument names; ``~`` in quotes is the home folder, too."""
    return Path(text).expanduser()
