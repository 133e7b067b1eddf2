"""``palpate simulate``: a specification in, a recording out."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError, PalpateError, located_in

NAME = "simulate"
HELP = "simulate one indentation and write it as a recording CSV"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("specification", type=Path, metavar="SPEC.yaml", help="the specification of a test")
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="CURVE.csv", help="the recording that is written"
    )


def run(arguments: argparse.Namespace) -> int:
    """Simulate; exit code 1 when the solver fails."""
    from indentation_files.overwrite import checked_output
    from indentation_files.recording import SYNTHETIC, Recording
    from palpate.base.yaml_file import read_yaml
    from palpate.solver.simulation import simulate, specification_from

    path = arguments.specification
    values = read_yaml(path)
    if not arguments.output.parent.is_dir():
        raise InputError("the folder is missing", remedy="create it first", file=arguments.output.parent)
    if arguments.output.is_dir():
        raise InputError("is a folder", remedy="name a file in it, such as curve.csv", file=arguments.output)
    output = checked_output(path, arguments.output)
    with located_in(path):
        specification = specification_from(values)
        simulation = simulate(specification)
    if simulation.status != "ok":
        raise PalpateError(f"{path}: the simulation failed: {simulation.reason}")
    notes = (f"{SYNTHETIC}: simulated by palpate", f"kinematics: {specification.kinematics}")
    Recording(simulation.time, simulation.load, simulation.depth, notes=notes).write(output)
    return 0
