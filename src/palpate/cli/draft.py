"""``palpate draft``: recordings in, a first study out."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli import check, read

if TYPE_CHECKING:
    from collections.abc import Sequence

    from palpate.draft import Drafted, Solid
    from palpate.draft.grouping import Group
    from palpate.recordings.readers import Unreadable

NAME = "draft"
HELP = "write a first study from recordings or vendors' files"
STIFFEST_POLYMER, SOFTEST_PLASTIC = 8.0, 0.01  # GPa
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
    from palpate.errors import InputError
    from palpate.materials import law_of

    try:
        return law_of(text).key
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


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
    from palpate.draft import Solid, Stated, assumed, check_units, not_taken, study_name, study_text, unlike
    from palpate.draft.grouping import grouped
    from palpate.errors import InputError

    study, folder = arguments.output / "study.yaml", arguments.output / "recordings"
    for standing in (study, folder):
        if standing.exists():
            raise InputError("stands there already", remedy="name another output, or move it away", file=standing)
    tests = _without_copies(_readable(arguments))
    recordings = [test.recording for test in tests]
    stated, sphere = Stated.by_all([test.facts for test in tests]), arguments.sphere
    check_units(recordings, sphere, stated)
    groups, solid = grouped(recordings), Solid.of(recordings, sphere, stated)
    remarks = not_taken([(test.recording.name, test.facts) for test in tests], stated, sphere)
    remarks += [*unlike(recordings, sphere, stated), *assumed(tests)]
    name = study_name(arguments.output)
    text = study_text(name, groups, folder, arguments.law, solid, sphere, stated, remarks)
    described = _written(study, text, folder, groups)
    for remark in (*_doubts(arguments.law, solid), *remarks):
        print(f"palpate: {remark}", file=sys.stderr)
    print(*described, sep="\n")
    return 0


def _readable(arguments: argparse.Namespace) -> list[Drafted]:
    """Return all tests that can be read, and say of other files and tests why they are left out.

    Raises
    ------
    InputError
        What is wrong with the first file or test, when none can be read.
    """
    from palpate.draft import Drafted
    from palpate.errors import InputError

    foreign: list[InputError] = []
    found: list[tuple[Path, list[Drafted | Unreadable]]] = []
    for file in arguments.files:
        try:
            found.append((file, _tests_of(file, arguments)))
        except InputError as error:
            foreign.append(error.located(file=file))
    drafted = [test for _, tests in found for test in tests if isinstance(test, Drafted)]
    if not drafted:
        raise foreign[0]
    for reason in foreign:
        print(f"palpate: {reason}; the file is left out", file=sys.stderr)
    for file, tests in found:
        read.say_what_is_wrong(file, [test.source if isinstance(test, Drafted) else test for test in tests])
    return drafted


def _tests_of(file: Path, arguments: argparse.Namespace) -> list[Drafted | Unreadable]:
    """Return the tests of one file; raises `InputError` when none can be read."""
    from palpate.draft import Drafted
    from palpate.errors import InputError
    from palpate.recordings.readers import Unreadable, VendorTest, zeroed_each

    tests: list[Drafted | Unreadable] = []
    for test in zeroed_each(file, read.whole_tests(file, arguments), arguments.contact):
        try:
            tests.append(Drafted.of(file, test, arguments.corrections) if isinstance(test, VendorTest) else test)
        except InputError as error:
            tests.append(Unreadable(test.name, error))
    unreadable = [test for test in tests if isinstance(test, Unreadable)]
    if len(unreadable) == len(tests):
        raise next((test for test in unreadable if test.sought), unreadable[0]).error
    return tests


def _without_copies(tests: Sequence[Drafted]) -> list[Drafted]:
    """Return the tests without those that repeat an earlier one, and say which are left out."""
    from palpate.recordings.recording import copies

    left_out = set()
    for copy, first in copies(test.recording for test in tests):
        print(f"palpate: {copy.name}: the same recording as {first.name}; left out", file=sys.stderr)
        left_out.add(copy)
    return [test for test in tests if test.recording not in left_out]


def _doubts(law: str, solid: Solid) -> list[str]:
    """Return a remark on a solid that is as stiff as no polymer is, or as soft as no plastic."""
    told = f"an elastic body as deep has a modulus of {solid.secant:.3g} GPa, which is"
    if law == POLYMER and solid.secant > STIFFEST_POLYMER:
        return [f"{told} no polymer's; --law bilinear_plasticity is for metals and ceramics; or are loads in uN?"]
    if solid.secant < SOFTEST_PLASTIC:
        return [f"{told} a gel's or a rubber's; where it is neither: are depths in pm, or loads in N?"]
    return []


def _written(study: Path, text: str, folder: Path, groups: Sequence[Group]) -> list[str]:
    """Write a study and its recordings, and return what it does.

    Raises
    ------
    InputError
        When it is not sound, with the recording as people know it; nothing is left behind.
    """
    from palpate.configuration.study_file import load_study
    from palpate.draft import taken_back_if_unsound
    from palpate.errors import InputError
    from palpate.workflow_support.check_study import checked

    recordings = {
        folder / f"{group.name}_{number}.csv": recording
        for group in groups
        for number, recording in enumerate(group.recordings, 1)
    }
    with taken_back_if_unsound(study, folder):
        folder.mkdir(parents=True)
        for path, recording in recordings.items():
            recording.write(path)
        study.write_text(text, encoding="utf-8")
        try:
            return list(check.described(checked(load_study(study))))
        except InputError as error:
            own = recordings.get(Path(error.file or ""))
            where = own.name if own else error.file
            raise InputError(error.problem, remedy=error.remedy, file=where, place=error.place) from None
