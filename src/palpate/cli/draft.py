"""``palpate draft``: recordings in, a first study out."""

from __future__ import annotations

import argparse
import math

from indentation_files.command import reading_arguments
from palpate.cli import check, path, warn

NAME = "draft"
HELP = "write a first study from recordings or instruments' files"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "files", type=path, nargs="+", metavar="FILE|FOLDER", help="recordings, instruments' files, or folders of them"
    )
    reading_arguments(parser)
    parser.add_argument(
        "--law",
        type=_law,
        help="law of the material, such as burgers_plasticity, or auto, with which the recordings choose among those "
        "of a family (default: a law that suits the tests)",
    )
    parser.add_argument(
        "--sphere",
        type=_length,
        metavar="NM",
        help="radius of a spherical tip (default: the tip that the files state, else a Berkovich pyramid)",
    )
    parser.add_argument(
        "-o", "--output", type=path, required=True, metavar="FOLDER", help="the folder of study.yaml and its recordings"
    )


def _law(text: str) -> str:
    from palpate.configuration.chosen_law import AUTO
    from palpate.errors import InputError
    from palpate.materials import law_of

    try:
        return text if text == AUTO else law_of(text).key
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _length(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive length in nm")
    return value


def run(arguments: argparse.Namespace) -> int:
    """Write the recordings as replicates of the conditions that they are, and the study; print what it will do."""
    from indentation_files.readers import ColumnMap
    from palpate.configuration.chosen_law import AUTO
    from palpate.draft import lines, readable, study_name, write_study
    from palpate.errors import located_in

    with located_in(arguments.files[0]):
        columns = ColumnMap.stated(arguments.columns, arguments.units)
    tests = readable(arguments.files, warn, arguments.contact, arguments.corrections, columns)
    leave_open, name = arguments.law == AUTO, study_name(arguments.output)
    law = None if leave_open else arguments.law
    found = write_study(tests, arguments.output, name, warn, law, arguments.sphere, leave_open=leave_open)
    for remark in found.remarks:
        warn(remark)
    print("taken from the tests or guessed:", *lines(found.table), *check.examined(found.study), sep="\n")
    print(f"next: look through the guesses in {found.study.file}, then palpate check {found.study.file}")
    return 0
