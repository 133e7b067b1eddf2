"""``palpate fields``: a specification in, stress and displacement in the body out, for ParaView and as a figure."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError, PalpateError

NAME = "fields"
HELP = "simulate one indentation, and write stress and displacement for ParaView and as a figure"


def times(text: str) -> list[float]:
    """Return the numbers of a list with commas."""
    return [float(word) for word in text.split(",")]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("specification", type=Path, metavar="SPEC.yaml", help="the specification of a test")
    parser.add_argument("--time", type=times, required=True, metavar="T1,T2", help="the times that are written [s]")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="the folder that is written")


def run(arguments: argparse.Namespace) -> int:
    """Simulate and write; exit code 1 when the solver fails."""
    from palpate.base.yaml_file import read_yaml
    from palpate.output import vtu
    from palpate.output.figures import stress_fields as figure
    from palpate.solver.simulation import fields_at, specification_from

    path = arguments.specification
    values = read_yaml(path)
    if arguments.output.is_file():
        raise InputError("is a file", remedy="name a folder", file=arguments.output)
    try:
        moments = fields_at(specification_from(values), arguments.time)
    except InputError as error:
        raise error.located(file=path) from None
    except PalpateError as error:
        raise PalpateError(f"{path}: {error}") from None
    vtu.write(moments, arguments.output)
    figure.draw(arguments.output, arguments.output / "fields.png")
    return 0
