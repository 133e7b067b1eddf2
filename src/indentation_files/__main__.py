"""``python -m indentation_files FILE -o FOLDER``: an instrument's file in, recording CSVs out."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from indentation_files.command import HELP, Parser, add_arguments, run
from indentation_files.errors import InputError, of_system

NAME = "indentation_files"


def warn(line: object) -> None:
    """Print a line of its own on what was given, beside the results."""
    print(f"{NAME}: {line}", file=sys.stderr)


def main(arguments: Sequence[str] | None = None) -> int:
    """Read a file; return 0, or 2 on bad input, which is one line."""
    parser = Parser(prog=NAME, description=HELP)
    add_arguments(parser)
    try:
        return run(parser.parse_args(arguments), warn)
    except InputError as error:
        warn(error)
    except (OSError, MemoryError) as error:
        warn(of_system(error))
    return 2


if __name__ == "__main__":
    sys.exit(main())
