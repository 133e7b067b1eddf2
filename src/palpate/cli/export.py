"""``palpate export``: a specification in, the input of another finite element program out."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError, located_in

NAME = "export"
HELP = "write a test as the input of another finite element program"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("specification", type=Path, metavar="SPEC.yaml", help="the specification of a test")
    parser.add_argument("--format", required=True, choices=("abaqus", "calculix"), help="the other program")
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="PATH", help="a folder for Abaqus, a file for CalculiX"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the deck; nothing is left behind when the program cannot represent the specification."""
    from indentation_files.overwrite import checked_output
    from palpate.base.yaml_file import read_yaml
    from palpate.output.export import FORMATS
    from palpate.solver.simulation import specification_from

    if not arguments.output.absolute().parent.is_dir():
        raise InputError("the folder is missing", remedy="create it first", file=arguments.output.parent)
    values = read_yaml(arguments.specification)
    output = checked_output(arguments.specification, arguments.output)
    with located_in(arguments.specification):
        FORMATS[arguments.format].write(specification_from(values), output)
    return 0
