"""The command line: finds the subcommands, and turns bad input into one line and exit code 2."""

from __future__ import annotations

import importlib
import io
import os
import pkgutil
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from indentation_files.command import Parser
from palpate import __version__, cli
from palpate.base.threads import one_thread_each
from palpate.errors import InputError, PalpateError, of_system


def discovered() -> Iterator[Any]:
    """Yield the modules of the subcommands."""
    for found in pkgutil.iter_modules(cli.__path__):
        if found.name != "main":
            yield importlib.import_module(f"palpate.cli.{found.name}")


def command_line() -> Parser:
    """Return the parser of ``palpate`` with all of its subcommands."""
    parser = Parser(
        prog="palpate",
        description="The law of a material from instrumented indentation.",
        epilog="From your own files: draft, check, run. COMMAND --help lists the arguments of each.",
    )
    parser.add_argument("--version", action="version", version=f"palpate {__version__}")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in sorted(discovered(), key=lambda command: command.NAME):
        subparser = subparsers.add_parser(command.NAME, help=command.HELP, description=command.HELP)
        command.add_arguments(subparser)
        subparser.set_defaults(run=command.run)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``palpate``; return its exit code.

    It is 0 on success, 2 on bad input, 1 on failure or when the output is closed, and 130 after Ctrl-C.
    Letters that the output's encoding lacks are printed as numbers.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    one_thread_each()
    os.environ["MPLBACKEND"] = "Agg"  # figures are files, whatever a notebook's kernel asks for
    chosen = command_line().parse_args(arguments)
    try:
        code = chosen.run(chosen)
        if sys.stdout:  # which is none where it was closed from the beginning
            sys.stdout.flush()
        return code
    except PalpateError as error:
        cli.warn(error)
        return 2 if isinstance(error, InputError) else 1
    except KeyboardInterrupt:
        cli.warn("interrupted")
        return 130
    except BrokenPipeError:
        _discard_output()
        return 1
    except (OSError, MemoryError) as error:
        cli.warn(of_system(error))
        try:
            print(end="", flush=True)
        except OSError:
            _discard_output()
        return 2


def _discard_output() -> None:
    """Write what is left of the output nowhere, so that the end of the process does not try it again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
