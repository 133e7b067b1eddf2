"""``palpate draft``: recordings in, a first study out."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from palpate.commands import check, read

NAME = "draft"
HELP = "write a first study from recordings or vendors' files"
STIFFEST_POLYMER = 8.0  # GPa
POLYMER = "nonlinear_burgers"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE")
    read.reading_arguments(parser)
    parser.add_argument("--law", type=_law, default=POLYMER, help=f"material model (default: {POLYMER}, a polymer's)")
    parser.add_argument(
        "--sphere", type=_length, metavar="NM", help="radius of a spherical tip (default: as files state, or Berkovich)"
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")


def _law(text: str) -> str:
    from palpate.materials import LAWS

    if text not in LAWS:
        raise argparse.ArgumentTypeError(f"{text!r} is none of {', '.join(LAWS)}")
    return text


def _length(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not value > 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive length in nm")
    return value


def run(arguments: argparse.Namespace) -> int:
    """Write the recordings as replicates of the conditions that they are, and the study; check it, say what it does."""
    from palpate.checking import checked_study
    from palpate.draft import Solid, study_name, study_text
    from palpate.errors import InputError
    from palpate.grouping import grouped
    from palpate.readers import VendorTest, zeroed_each
    from palpate.recording import copies
    from palpate.stated import Stated

    study, folder = arguments.output / "study.yaml", arguments.output / "recordings"
    for standing in (study, folder):
        if standing.exists():
            raise InputError("stands there already", remedy="name another output, or move it away", file=standing)
    recordings, metadata = [], []
    for file in arguments.files:
        try:
            tests = zeroed_each(file, read.whole_tests(file, arguments), arguments.contact)
            read.say_what_is_wrong(file, tests)
            for test in tests:
                if isinstance(test, VendorTest):
                    notes = (*test.recording.notes, f"from {file.name}, {test.name}")
                    begun = test.recording.from_contact()
                    recordings.append(replace(begun, name=f"{file}, {test.name}", notes=notes))
                    metadata.append(test.metadata)
        except InputError as error:
            raise error.located(file=file) from None
    for copy, first in copies(recordings):
        print(f"palpate: {copy.notes[-1]}: the same recording {first.notes[-1]}; left out", file=sys.stderr)
        recordings.remove(copy)
    groups = grouped(recordings)
    stated = Stated.by_all(metadata)
    solid = Solid.of(recordings, arguments.sphere, stated)
    if arguments.law == POLYMER and solid.secant > STIFFEST_POLYMER:
        stiffness = f"an elastic body as deep has a modulus of {solid.secant:.3g} GPa, which is no polymer's"
        print(f"palpate: {stiffness}; --law bilinear_plasticity is for metals and ceramics", file=sys.stderr)
    text = study_text(study_name(arguments.output), groups, folder, arguments.law, solid, arguments.sphere, stated)
    folder.mkdir(parents=True)
    for group in groups:
        for number, recording in enumerate(group.recordings, 1):
            recording.write(folder / f"{group.name}_{number}.csv")
    study.write_text(text, encoding="utf-8")
    for line in check.described(checked_study(study, None)):
        print(line)
    return 0
