"""From files to a first study on disk: tests are read, sorted by their load histories, and written beside a study."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from palpate.configuration.study_file import Study, load_study
from palpate.draft.drafted import Drafted, assumed
from palpate.draft.grouping import Group, grouped
from palpate.draft.metadata import not_taken
from palpate.draft.rollback_on_error import taken_back_if_unsound
from palpate.draft.solid import Solid, check_units, unlike
from palpate.draft.stated import Stated
from palpate.draft.yaml_text import study_text
from palpate.errors import InputError
from palpate.inference.study_recordings import check_given
from palpate.recordings.readers import ColumnMap, Unreadable, VendorTest, messages, read_each, zeroed_each
from palpate.recordings.recording import copies

STIFFEST_POLYMER, SOFTEST_PLASTIC = 8.0, 0.01  # GPa, chosen: beyond them a remark asks, and nothing is refused
POLYMER = "nonlinear_burgers"


def readable(
    files: Sequence[Path],
    report: Callable[[str], None],
    contact: str | float = "file",
    corrections: frozenset[str] | None = None,
    columns: ColumnMap | None = None,
) -> list[Drafted]:
    """Return all tests of files that can be read, and say of other files and tests why they are left out.

    Parameters
    ----------
    files
        Recordings, or vendors' files.
    report
        Told of what is left out, and of what the readers warn of.
    contact, corrections, columns
        As for `palpate.recordings.readers.read_vendor_file`.

    Raises
    ------
    InputError
        What is wrong with the first file or test, when none can be read.
    """
    foreign: list[InputError] = []
    found: list[tuple[Path, list[Drafted | Unreadable]]] = []
    for file in files:
        try:
            whole = read_each(file, corrections=corrections, contact="none", columns=columns)
            found.append((file, _begun(file, zeroed_each(file, whole, contact), corrections)))
        except InputError as error:
            foreign.append(error.located(file=file))
    drafted = [test for _, tests in found for test in tests if isinstance(test, Drafted)]
    if not drafted:
        raise foreign[0]
    for reason in foreign:
        report(f"{reason}; the file is left out")
    for file, tests in found:
        for line in messages(file, [test.source if isinstance(test, Drafted) else test for test in tests]):
            report(line)
    return drafted


def _begun(
    file: Path, tests: Sequence[VendorTest | Unreadable], corrections: frozenset[str] | None
) -> list[Drafted | Unreadable]:
    """Return the tests of one file as a draft takes them; raises `InputError` when it can take none."""
    found: list[Drafted | Unreadable] = []
    for test in tests:
        try:
            found.append(Drafted.of(file, test, corrections) if isinstance(test, VendorTest) else test)
        except InputError as error:
            found.append(Unreadable(test.name, error))
    unreadable = [test for test in found if isinstance(test, Unreadable)]
    if len(unreadable) == len(found):
        raise next((test for test in unreadable if test.sought), unreadable[0]).error
    return found


def write_study(
    tests: Sequence[Drafted],
    output: Path,
    name: str,
    report: Callable[[str], None],
    law: str = POLYMER,
    sphere: float | None = None,
) -> tuple[Study, list[str]]:
    """Write tests as replicates of the conditions that they are, and a study of them, and return the study.

    Parameters
    ----------
    tests
    output
        Folder of what is written: ``study.yaml`` and ``recordings``, neither of which may stand there.
    name
        Of the study.
    report
        Told of tests that are left out, as they repeat another.
    law
        Key of the constitutive law, or keys of several joined by ``+``.
    sphere
        Radius of a spherical tip [nm]; when not given, the tip is the files' own, or a Berkovich.

    Returns
    -------
    study, remarks
        The study, checked, and what people should look at in it.

    Raises
    ------
    InputError
        When the study would not be sound; nothing is left behind.
    """
    file, folder = output / "study.yaml", output / "recordings"
    for standing in (file, folder):
        if standing.exists():
            raise InputError("stands there already", remedy="name another output, or move it away", file=standing)
    tests = _without_copies(tests, report)
    recordings = [test.recording for test in tests]
    stated = Stated.by_all([test.facts for test in tests])
    check_units(recordings, sphere, stated)
    groups, solid = grouped(recordings), Solid.of(recordings, sphere, stated)
    remarks = not_taken([(test.recording.name, test.facts) for test in tests], stated, sphere)
    remarks += [*unlike(recordings, sphere, stated), *assumed(tests)]
    text = study_text(name, groups, folder, law, solid, sphere, stated, remarks)
    return _written(file, text, folder, groups), [*_doubts(law, solid), *remarks]


def _without_copies(tests: Sequence[Drafted], report: Callable[[str], None]) -> list[Drafted]:
    """Return the tests without those that repeat an earlier one, and say which are left out."""
    left_out = set()
    for copy, first in copies(test.recording for test in tests):
        report(f"{copy.name}: the same recording as {first.name}; left out")
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


def _written(file: Path, text: str, folder: Path, groups: Sequence[Group]) -> Study:
    """Write a study and its recordings, and return it.

    Raises
    ------
    InputError
        When it is not sound, with the recording as people know it; nothing is left behind.
    """
    recordings = {
        folder / f"{group.name}_{number}.csv": recording
        for group in groups
        for number, recording in enumerate(group.recordings, 1)
    }
    with taken_back_if_unsound(file, folder):
        folder.mkdir(parents=True)
        for path, recording in recordings.items():
            recording.write(path)
        file.write_text(text, encoding="utf-8")
        try:
            study = load_study(file)
            check_given(study)
            return study
        except InputError as error:
            own = recordings.get(Path(error.file or ""))
            where = own.name if own else error.file
            raise InputError(error.problem, remedy=error.remedy, file=where, place=error.place) from None
