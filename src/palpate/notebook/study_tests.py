"""Which recordings a study is compared with: one of its own sets, or tests that a notebook holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from indentation_files.recording import Recording
from palpate.configuration.study_file import Study
from palpate.data.recording_checks import checked_recording
from palpate.data.study_recordings import check, check_source, check_tests, written_by_workflow
from palpate.errors import InputError
from palpate.laboratory import virtual
from palpate.notebook.measured_test import MeasuredTest, read_recording
from palpate.notebook.simulated_curve import SimulatedCurve

OneTest = str | Path | MeasuredTest | SimulatedCurve | Recording
Given = str | OneTest | Iterable[OneTest] | Mapping[str, OneTest | Iterable[OneTest]] | None


def given_tests(study: Study, recordings: Given) -> tuple[str, dict[str, list[Recording]]]:
    """Return the name of the chosen set, or ``given``, and the tests of each condition, checked and from contact on.

    Parameters
    ----------
    recordings
        The name of a set of the study; None for the only one it has; tests by the name of their condition; or,
        where the study has a single condition, its tests.

    Raises
    ------
    InputError
        When there is no such set, several could be meant, or a recording is not one of its condition.
    """
    if recordings is None or (isinstance(recordings, str) and recordings in study.recordings):
        name = recordings if recordings is not None else _only_set(study)
        return name, _tests_of_set(study, name)
    if isinstance(recordings, str) and not Path(recordings).is_file():
        known = ", ".join(study.recordings) or "none"
        problem = f"{recordings!r} is no set of recordings of the study, which has: {known}, and no file"
        raise InputError(problem, remedy="name a set, or give tests", place="recordings")
    named = recordings if isinstance(recordings, Mapping) else {_only_condition(study): recordings}
    tests = {str(name): [recording_of(each) for each in several(found)] for name, found in named.items()}
    return "given", check_tests(study, tests)


def recording_of(given: OneTest) -> Recording:
    """Return the recording of a test, a simulated curve, or the only test of a file; raises `InputError`."""
    if isinstance(given, str | Path):
        return read_recording(given).recording
    if isinstance(given, Recording):
        return given
    if isinstance(given, MeasuredTest | SimulatedCurve):
        return given.recording
    remedy = "give a file, what read_recording or simulate returns, or a Recording"
    raise InputError(f"{type(given).__name__} is no recording", remedy=remedy, place="recordings")


def several(given: OneTest | Iterable[OneTest]) -> list[OneTest]:
    """Return one test, or several, as a list."""
    return list(given) if isinstance(given, Iterable) and not isinstance(given, OneTest) else [given]


def _only_set(study: Study) -> str:
    if len(study.recordings) == 1:
        return next(iter(study.recordings))
    count = "several sets of" if study.recordings else "no"
    remedy = f"name one of: {', '.join(study.recordings)}" if study.recordings else "give tests as recordings"
    raise InputError(f"the study names {count} recordings", remedy=remedy, place="recordings")


def _only_condition(study: Study) -> str:
    names = list(study.tested)
    if len(names) == 1:
        return names[0]
    remedy = f"give tests by the name of their condition: {{{names[0]!r}: [...], ...}}"
    raise InputError(f"the study has {len(names)} conditions", remedy=remedy, place="recordings")


def _tests_of_set(study: Study, name: str) -> dict[str, list[Recording]]:
    """Return the recordings of a set of the study.

    Those that the workflow writes are made here anew: its folder may hold what other settings gave.
    """
    if not written_by_workflow(study, name):
        return check(study, name)
    if name in study.laboratory:
        made = virtual.record(study, study.laboratory[name]).items()
        return {
            each.name: [
                checked_recording(study, each, test) for key, test in made if key.rpartition("_")[0] == each.name
            ]
            for each in study.tested.values()
        }
    return check_source(study)
