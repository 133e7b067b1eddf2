"""The command line: finds the subcommands, and turns bad input into one line and exit code 2."""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
from collections.abc import Sequence
from typing import NoReturn

from palpate import __version__, commands
from palpate.errors import InputError, PalpateError


class Parser(argparse.ArgumentParser):
    """A parser whose complaints fit on one line."""

    def error(self, message: str) -> NoReturn:
        """Print `message` and leave with exit code 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``palpate``; return its exit code: 0 on success, 1 on failure, 2 on bad input."""
    parser = Parser(prog="palpate", description="The law of a material from instrumented indentation.")
    parser.add_argument("--version", action="version", version=f"palpate {__version__}")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for found in pkgutil.iter_modules(commands.__path__):
        command = importlib.import_module(f"palpate.commands.{found.name}")
        subparser = subparsers.add_parser(command.NAME, help=command.HELP, description=command.HELP)
        command.add_arguments(subparser)
        subparser.set_defaults(run=command.run)
    chosen = parser.parse_args(arguments)
    try:
        return chosen.run(chosen)
    except InputError as error:
        print(f"palpate: {error}", file=sys.stderr)
        return 2
    except PalpateError as error:
        print(f"palpate: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        problem = InputError(str(error.strerror), remedy="check the path and its permissions", file=error.filename)
        print(f"palpate: {problem}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
