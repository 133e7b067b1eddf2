"""From files to a first study on disk: tests are read, sorted by what was prescribed, and written beside a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from indentation_files.overwrite import rolled_back_on_error
from indentation_files.recording import Recording, copies
from palpate.configuration.chosen_law import AUTO
from palpate.configuration.study_file import Study, load_study
from palpate.data.study_recordings import check_given
from palpate.draft.drafted import Drafted
from palpate.draft.grouping import Group, grouped, with_held_out_cycles
from palpate.draft.guess_table import Guess, evaluated, guess_table
from palpate.draft.guesses import ranges
from palpate.draft.known_tip import KnownTip
from palpate.draft.law_choice import chosen_law, family_of
from palpate.draft.prescribed_drive import Drive, cut_off
from palpate.draft.remarks import on_held_out, on_stiffness, remarks_on
from palpate.draft.solid import OF_GELS, POISSON_RATIO, Solid, check_unit
from palpate.draft.stated import Stated
from palpate.draft.yaml_text import study_text
from palpate.errors import InputError

LOOK = "look at it (palpate read FILE --survey), and export it again or leave it out"  # there is no study to correct
Report = Callable[[str], None]


@dataclass(frozen=True)
class FirstStudy:
    """A study that was drafted.

    Parameters
    ----------
    study
        Checked.
    remarks
        What the user should look at in it.
    table
        What was taken or guessed, and why; modulus and hardness by unloading at its end.
    """

    study: Study
    remarks: list[str]
    table: list[Guess]


def write_study(
    tests: Sequence[Drafted],
    output: Path,
    name: str,
    report: Report,
    law: str | None,
    sphere: float | None,
    *,
    leave_open: bool = False,
) -> FirstStudy:
    """Write tests as replicates of the conditions that they are, and a study of them, and return it.

    A test that would make it unsound is left out; the others are drafted.

    Parameters
    ----------
    tests
    output
        Folder of what is written: ``study.yaml`` and ``recordings``, neither of which may exist.
    name
        Of the study.
    report
        Called with one line for each test that is left out, with the reason.
    law
        Key of the constitutive law, or keys of several joined by ``+``; None to choose it from the tests.
    sphere
        Radius of a spherical tip [nm]; None for the files' own tip, or a Berkovich.
    leave_open
        Whether, where no law is given and the tests can tell laws from each other, the study leaves the choice among
        those of a family to the recordings (`palpate.choice.choose`).

    Raises
    ------
    InputError
        When no test is left, or the study would not be sound; nothing is left behind.
    """
    for existing in (output / "study.yaml", output / "recordings"):
        if existing.exists():
            raise InputError("exists already", remedy="name another output, or move it away", file=existing)
    tests = _without_copies(tests, report)
    stated = Stated.by_all([test.facts for test in tests])
    tip = KnownTip.of(stated, sphere, float(np.median([test.recording.depth.max() for test in tests])))
    tests = _sound(tests, lambda test: check_unit(test.recording, tip), report)
    drive = Drive.by_all([test.recording for test in tests], stated)
    tests = _sound(tests, lambda test: drive.followed(test.recording), report)
    tests = _without_cut_off(tests, drive, report)
    while True:
        try:
            return _drafted(tests, output, name, law, tip, drive, leave_open)
        except Unsound as unsound:
            report(_left_out(unsound.test, unsound.error))
            tests = [test for test in tests if test is not unsound.test]


class Unsound(Exception):
    """One test, among others, that a study cannot be drafted with.

    Parameters
    ----------
    test
    error
        What is wrong with it.
    """

    def __init__(self, test: Drafted, error: InputError):
        self.test, self.error = test, error
        super().__init__(str(error))


def _left_out(test: Drafted, error: InputError) -> str:
    """Return the line that says why a test is left out."""
    place = f", {error.place}" if error.place else ""
    return f"{test.recording.name}{place}: {error.problem}; the test is left out"


def _sound(tests: Sequence[Drafted], check: Callable[[Drafted], object], report: Report) -> list[Drafted]:
    """Return the tests that pass a check, and say which do not; raises the first error where none does."""
    kept, wrong = [], list[tuple[Drafted, InputError]]()
    for test in tests:
        try:
            check(test)
            kept.append(test)
        except InputError as error:
            wrong.append((test, error))
    if not kept:
        first, problem = wrong[0]
        raise problem.located(file=first.recording.name)
    for test, problem in wrong:
        report(_left_out(test, problem))
    return kept


def _drafted(
    tests: Sequence[Drafted], output: Path, name: str, law: str | None, tip: KnownTip, drive: Drive, leave_open: bool
) -> FirstStudy:
    """Write a study of tests; raises `Unsound` with the test that keeps it from being sound."""
    recordings, facts = [test.recording for test in tests], [test.facts for test in tests]
    stated = Stated.by_all(facts)
    solid = Solid.of(recordings, tip, stated.poisson_ratio or POISSON_RATIO)
    ratio = stated.poisson_ratio or (OF_GELS if solid.soft else POISSON_RATIO)
    solid = Solid.of(recordings, tip, ratio)
    chosen = (law, "as given") if law else chosen_law(solid)
    used = tip.of_diamond if solid.stiff else tip
    groups = with_held_out_cycles(grouped(recordings, drive), drive)
    shortest = min(float(group.recordings[0].time[np.argmax(group.recordings[0].load)]) for group in groups)
    family = family_of(solid) if leave_open and not law else ""
    guessed = {} if family else ranges(chosen[0], solid, shortest)
    if family:
        chosen = f"{AUTO}, family: {family}", f"the recordings will choose among laws; {chosen[1]}"
    table = guess_table(chosen, used, drive, (ratio, stated.poisson_ratio is not None), guessed)
    remarks = [*remarks_on(tests, stated, tip, ratio), *on_held_out(groups)]
    folder = output / "recordings"
    text = study_text(name, groups, folder, used, guessed, table, remarks)
    study = _written(output / "study.yaml", text, folder, groups, tests)
    return FirstStudy(study, [*on_stiffness(chosen[0], solid), *remarks], [*table, *evaluated(solid, facts, ratio)])


def _without_copies(tests: Sequence[Drafted], report: Report) -> list[Drafted]:
    """Return the tests without those that repeat an earlier one, and say which are left out."""
    left_out = set()
    for copy, first in copies(test.recording for test in tests):
        report(f"{copy.name}: the same recording as {first.name}; left out")
        left_out.add(copy)
    return [test for test in tests if test.recording not in left_out]


def _without_cut_off(tests: Sequence[Drafted], drive: Drive, report: Report) -> list[Drafted]:
    """Return the tests without those that were cut off, and say which are left out."""
    found = cut_off([test.recording for test in tests], drive)
    for cut, whole in found.items():
        report(
            f"{cut.name}: ends after {cut.time[-1]:.4g} s under {cut.load[-1]:.4g} mN, where {whole.name} goes on and "
            "is unloaded: it was cut off; the test is left out"
        )
    return [test for test in tests if test.recording not in found]


def _written(file: Path, text: str, folder: Path, groups: Sequence[Group], tests: Sequence[Drafted]) -> Study:
    """Write a study and its recordings, and return it.

    Raises
    ------
    Unsound
        When it is not sound for one of several tests; nothing is left behind.
    InputError
        When it is not for another reason.
    """
    recordings = {
        folder / f"{group.name}_{number}.csv": recording
        for group in groups
        for number, recording in enumerate(group.recordings, 1)
    }
    with rolled_back_on_error(file, folder):
        folder.mkdir(parents=True)
        for path, recording in recordings.items():
            recording.write_apart(path)
        file.write_text(text, encoding="utf-8")
        try:
            study = load_study(file)
            check_given(study)
            return study
        except InputError as error:
            error = _in_names_of_tests(error, recordings)
            own = recordings.get(Path(error.file or ""))
            if own and len(tests) > 1:
                raise Unsound(next(test for test in tests if test.recording is own), error) from None
            where = own.name if own else "the draft of these tests"
            remedy = LOOK if own and error.place != "depth_nm" else error.remedy
            raise InputError(error.problem, remedy=remedy, file=where, place=error.place) from None


def _in_names_of_tests(error: InputError, recordings: Mapping[Path, Recording]) -> InputError:
    """Return an error that names tests as they were given, not files that a draft would have written."""
    problem = error.problem
    for path, recording in recordings.items():
        problem = problem.replace(path.name, recording.name)
    return InputError(problem, remedy=error.remedy, file=error.file, place=error.place)
