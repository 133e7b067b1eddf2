"""Which recordings a study is compared with: one of its own sets, or tests that a notebook holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from palpate.configuration.study_file import Study
from palpate.data.recording_checks import checked_recording
from palpate.data.study_recordings import check, check_source, check_tests, written_by_workflow
from palpate.errors import InputError
from palpate.laboratory import virtual
from palpate.notebook.measured_test import MeasuredTest, read_recording
from palpate.notebook.simulated_curve import SimulatedCurve
from palpate.recordings.recording import Recording

OneTest = str | Path | MeasuredTest | SimulatedCurve | Recording
Given = str | OneTest | Iterable[OneTest] | Mapping[str, OneTest | Iterable[OneTest]] | None


@dataclass(frozen=True, eq=False)
class StudyTests:
    """Recordings of a study's conditions.

    Parameters
    ----------
    name
        Of the set, or ``given``.
    by_condition
        Those of each condition, checked and from contact on.
    """

    name: str
    by_condition: Mapping[str, list[Recording]]

    @property
    def synthetic(self) -> bool:
        """Whether any of them was simulated, and not measured."""
        return any(recording.synthetic for found in self.by_condition.values() for recording in found)

    @classmethod
    def of(cls, study: Study, recordings: Given) -> StudyTests:
        """Return the chosen recordings, checked against the study.

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
            return cls(name, _tests_of(study, name))
        if isinstance(recordings, str) and not Path(recordings).is_file():
            known = ", ".join(study.recordings) or "none"
            raise InputError(
                f"{recordings!r} is no set of recordings of the study, which has: {known}, and no file",
                remedy="name a set, or give tests",
                place="recordings",
            )
        named = recordings if isinstance(recordings, Mapping) else {_only_condition(study): recordings}
        tests = {str(name): [recording_of(each) for each in several(found)] for name, found in named.items()}
        return cls("given", check_tests(study, tests))


def recording_of(given: OneTest) -> Recording:
    """Return the recording of a test, a simulated curve, or the only test of a file; raises `InputError`."""
    if isinstance(given, str | Path):
        return read_recording(given).recording
    if isinstance(given, Recording):
        return given
    if isinstance(given, MeasuredTest | SimulatedCurve):
        return given.recording
    raise InputError(
        f"{type(given).__name__} is no recording",
        remedy="give a file, what read_recording or simulate returns, or a Recording",
        place="recordings",
    )


def several(given: OneTest | Iterable[OneTest]) -> list[OneTest]:
    """Return one test, or several, as a list."""
    return list(given) if isinstance(given, Iterable) and not isinstance(given, OneTest) else [given]


def _only_set(study: Study) -> str:
    if len(study.recordings) != 1:
        count = "several sets of" if study.recordings else "no"
        raise InputError(
            f"the study names {count} recordings",
            remedy=f"name one of: {', '.join(study.recordings)}" if study.recordings else "give tests as recordings",
            place="recordings",
        )
    return next(iter(study.recordings))


def _only_condition(study: Study) -> str:
    names = [condition.name for condition in study.conditions]
    if len(names) != 1:
        raise InputError(
            f"the study has {len(names)} conditions",
            remedy=f"give tests by the name of their condition: {{{names[0]!r}: [...], ...}}",
            place="recordings",
        )
    return names[0]


def _tests_of(study: Study, name: str) -> dict[str, list[Recording]]:
    """Return the recordings of a set of the study.

    Those that the workflow writes are made here anew: its folder may hold what other settings gave.
    """
    if not written_by_workflow(study, name):
        return check(study, name)
    if name in study.laboratory:
        tests: dict[str, list[Recording]] = {condition.name: [] for condition in study.conditions}
        for key, recording in virtual.record(study, study.laboratory[name]).items():
            condition = study.condition(key.rpartition("_")[0])
            tests[condition.name].append(checked_recording(study, condition, recording))
        return tests
    return check_source(study)
