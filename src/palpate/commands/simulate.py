"""``palpate simulate``: a specification in, a recording out."""

from __future__ import annotations

import argparse
from pathlib import Path

import yaml

from palpate.errors import InputError
from palpate.recording import Recording

NAME = "simulate"
HELP = "simulate one indentation and write it as a recording CSV"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("specification", type=Path, metavar="SPEC.yaml")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="CURVE.csv")


def run(arguments: argparse.Namespace) -> int:
    """Simulate; exit code 1 when the solver fails."""
    from palpate.model import simulate, specification_from

    path = arguments.specification
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
        specification = specification_from(values)
        simulation = simulate(specification)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", remedy="check the path", file=path) from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        mark = getattr(error, "problem_mark", None)
        place = f"line {mark.line + 1}" if mark else None
        raise InputError("is not valid YAML", remedy="correct the file", file=path, place=place) from error
    except InputError as error:
        raise error.located(file=path) from None
    if not arguments.output.parent.is_dir():
        raise InputError("the folder is missing", remedy="create it first", file=arguments.output.parent)
    if simulation.status != "ok":
        print(f"palpate: {path}: the simulation failed: {simulation.reason}")
        return 1
    notes = ("SYNTHETIC: simulated by palpate",)
    Recording(simulation.time, simulation.load, simulation.depth, notes=notes).write(arguments.output)
    return 0
