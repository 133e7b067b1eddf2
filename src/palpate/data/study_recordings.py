"""The recordings of a study: found, checked against the study before anything is simulated, and resampled."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from indentation_files.recording import Recording, copies, stiffness_file
from indentation_files.recording_file import condition_of, read_recording, recording_files
from palpate.configuration.checked_file import suggestion
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.data.recording_checks import checked_recording
from palpate.errors import InputError, located_in
from palpate.observables.observable import Quantity
from palpate.study.alignment import own_protocol, stretched
from palpate.study.protocol import Protocol

Look = Callable[[str, str, list[Recording]], None]


def find(study: Study, name: str) -> dict[str, list[Path]]:
    """Return the files of each condition in set `name`.

    Raises
    ------
    InputError
        When the folder or a condition's recordings are missing, or a file belongs to no condition.
    """
    folder = study.recordings[name]
    if not folder.is_dir():
        missing = "the folder is missing" + ("" if folder.is_absolute() else f" below {Path.cwd()}")
        problem = "is a file, no folder" if folder.exists() else missing
        raise InputError(problem, remedy=f"correct recordings.{name} in {study.file}", file=folder)
    names = list(study.tested)
    found: dict[str, list[Path]] = {name: [] for name in names}
    for file in recording_files(folder):
        if file.stem in names:
            raise InputError(
                "the file's name is that of a condition, without a replicate",
                remedy=f"name it {file.stem}_1.csv, or by its condition and another replicate",
                file=file,
            )
        condition = condition_of(file)
        if condition not in found:
            raise InputError(
                "the file's name is not CONDITION_REPLICATE.csv with a condition of the study",
                remedy=f"rename or remove it, or add its condition to {study.file}, which has {', '.join(names)}",
                file=file,
            )
        found[condition].append(file)
    for condition, files in found.items():
        if not files:
            raise InputError(
                f"no recording of condition {condition!r}",
                remedy=f"add {condition}_1.csv or remove the condition",
                file=folder,
            )
    return found


def check(study: Study, name: str, look: Look | None = None) -> dict[str, list[Recording]]:
    """Read every recording of set `name`, check it against the study, and return them from contact on.

    Parameters
    ----------
    study, name
    look
        See `check_given`.

    Raises
    ------
    InputError
        As `find`, when a recording is not one of its condition, or when one repeats another of the set, be it of
        another condition. A virtual laboratory without noise and scatter may repeat itself.
    """
    checked: dict[str, list[Recording]] = {}
    read: list[Recording] = []
    tested = study.tested
    for condition, files in find(study, name).items():
        checked[condition], written = [], []
        for file in files:
            written.append(read_recording(file))
            with located_in(file):
                checked[condition].append(checked_recording(study, tested[condition], written[-1]))
            read.append(replace(written[-1], name=file.name))
        if look:
            look(name, condition, written)
    for copy, first in copies(read) if name not in study.laboratory else ():
        raise _repeated(first, file=study.recordings[name] / copy.name)
    return checked


def _repeated(first: Recording, file: str | Path | None = None, place: str | None = None) -> InputError:
    """Return the error of a recording that repeats the `first`: as if sites never differed, and noise did not exist."""
    problem, remedy = f"is the same recording as {first.name}", "remove one of them: each is a test of its own"
    return InputError(problem, remedy=remedy, file=file, place=place)


def check_tests(study: Study, tests: Mapping[str, Sequence[Recording]]) -> dict[str, list[Recording]]:
    """Check recordings in memory, by the names of their conditions, and return them from contact on.

    Raises
    ------
    InputError
        When a condition is none of the study's or has no recording, a recording is given twice, be it under two
        conditions, or is not one of its condition.
    """
    names = list(study.tested)
    for name in tests:
        if name not in names:
            problem = f"{name!r} is no condition of the study{suggestion(name, names)}"
            raise InputError(problem, remedy=f"use {', '.join(names)}", place="recordings")
    for name in names:
        if not tests.get(name):
            remedy = "add one, or remove the condition"
            raise InputError(f"no recording of condition {name!r}", remedy=remedy, place="recordings")
    return _checked_tests(study, {name: tests[name] for name in names})


def _checked_tests(
    study: Study, tests: Mapping[str, Sequence[Recording]], file: str | None = None
) -> dict[str, list[Recording]]:
    """Return tests in memory, or of one file, from contact on; an error names the test and its condition."""
    checked: dict[str, list[Recording]] = {name: [] for name in tests}
    tested = study.tested
    named: list[Recording] = []
    for condition, recordings in tests.items():
        for recording in recordings:
            named.append(replace(recording, name=f"{recording.name} of {condition}"))
            try:
                checked[condition].append(checked_recording(study, tested[condition], recording))
            except InputError as error:
                place = ", ".join(filter(None, (named[-1].name, error.place)))
                raise InputError(error.problem, remedy=error.remedy, file=file, place=place) from None
    for copy, first in copies(named):
        raise _repeated(first, file=file, place=copy.name)
    return checked


def check_given(study: Study, look: Look | None = None) -> list[dict[str, list[Recording]]]:
    """Check and return every set of recordings that exists before the workflow runs, and the vendor's file's tests.

    Parameters
    ----------
    look
        Is shown each set, condition and its recordings as they were written, so that nobody need read them again.
    """
    there = [name for name in study.recordings if not written_by_workflow(study, name)]
    return [check(study, name, look) for name in there] + ([check_source(study)] if study.source else [])


def check_source(study: Study) -> dict[str, list[Recording]]:
    """Check the tests of the study's vendor file, and return them from contact on; raises `InputError`."""
    tests = {condition: [test.recording for test in of_it] for condition, of_it in study.source_tests().items()}
    return _checked_tests(study, tests, study.source["file"])


def written_by_workflow(study: Study, name: str) -> bool:
    """Return whether set `name` comes from a virtual laboratory or is converted from a vendor's file."""
    return name in study.laboratory or name == study.source.get("recordings")


def tests_to_come(study: Study, name: str) -> dict[str, int]:
    """Return how many recordings of each condition of set `name` the workflow will write itself."""
    if name in study.laboratory:
        return dict.fromkeys(study.tested, study.laboratory[name].replicates)
    if name == study.source.get("recordings"):
        return {condition: len(tests) for condition, tests in study.source_tests().items()}
    return {}


def files_of(study: Study, name: str) -> list[Path]:
    """Return the files of set `name`: those that are there, or those that the workflow itself will write.

    Recordings come first, then the files of stiffness that lie in a folder beside them (`Recording.write_apart`).
    """
    if not written_by_workflow(study, name):
        recordings = [file for files in find(study, name).values() for file in files]
        return recordings + [file for file in map(stiffness_file, recordings) if file.is_file()]
    folder, counts = study.recordings[name], tests_to_come(study, name)
    recordings = [folder / f"{key}_{number + 1}.csv" for key, count in counts.items() for number in range(count)]
    if name in study.laboratory:
        return recordings
    tests = [test.recording for of_condition in study.source_tests().values() for test in of_condition]
    measured = [file for file, test in zip(recordings, tests, strict=True) if test.stiffness is not None]
    return recordings + list(map(stiffness_file, measured))


def with_stiffness(recording: Path) -> list[Path]:
    """Return the file of a recording and, where there is one, the file of its stiffness in a folder beside."""
    beside = stiffness_file(recording)
    return [recording, beside] if beside.is_file() else [recording]


def observations(study: Study, name: str) -> dict[str, Observation]:
    """Return all conditions of set `name`, resampled to the sampling times of their protocols."""
    return resampled(study, check(study, name))


def resampled(study: Study, checked: Mapping[str, list[Recording]]) -> dict[str, Observation]:
    """Return checked recordings under each condition, resampled to the sampling times of its protocol."""
    found = {}
    for condition in study.conditions:
        recordings, protocol = checked[condition.test], condition.protocol
        own: tuple[Protocol, ...] = ()
        if condition.own_loads:
            own = tuple(own_protocol(protocol, recording) for recording in recordings)
            recordings = [stretched(protocol, recording) for recording in recordings]
        item = Observation.from_recordings(protocol, recordings, condition.role, condition.observable)
        quantity = Quantity.of(condition.observable, protocol, study.tip_of(condition), item.mean)
        found[condition.name] = replace(item, quantity=quantity, own=own)
    return found


def convert_source(study: Study, folder: Path) -> None:
    """Write the tests of the study's vendor file as replicates of their conditions; stiffness in a folder beside."""
    source = study.source
    notes = tuple(f"{key}: {source[key]}" for key in ("repository", "commit", "path", "licence") if key in source)
    folder.mkdir(parents=True, exist_ok=True)
    for old in recording_files(folder):
        old.unlink()
    for condition, tests in study.source_tests().items():
        for number, test in enumerate(tests, 1):
            notes_of_test = (*test.recording.notes, *test.warnings, *notes)
            replace(test.recording, notes=notes_of_test).write_apart(folder / f"{condition}_{number}.csv")
