"""Data quality: anomalies of valid recordings, reported before anything is simulated and left to the user."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from palpate.configuration.study_file import Study
from palpate.inference.study_recordings import find, written_by_workflow
from palpate.recordings.readers.in_air import air_at_start
from palpate.recordings.readers.zero import begins_off_contact
from palpate.recordings.recording import Recording
from palpate.recordings.recording_file import read_recording, recording_files

APART = 1.5  # ratio of a test's depth to its condition's median beyond which it is reported
LONGER = 1.05  # ratio of durations beyond which the end of a test is reported as ignored


def data_quality(study: Study, name: str) -> Iterator[str]:
    """Report the anomalies of set `name`.

    Files that are not read; tests much deeper or shallower than the others of their condition, that begin elsewhere
    than at contact, or in air, or last longer than the load that is followed.
    """
    if written_by_workflow(study, name):
        return
    yield from _passed_over(study.recordings[name])
    for condition, files in find(study, name).items():
        tests = [read_recording(file) for file in files]
        yield from _apart(tests)
        for test in tests:
            yield from (f"{test.name}.csv: {said}" for said in air_at_start(test))
        for test in filter(begins_off_contact, tests):
            yield (
                f"{test.name}.csv begins at a depth of {test.depth[0]:.4g} nm, not at contact: all of this depth is "
                "counted (`palpate read --contact auto` finds the contact point)"
            )
        if study.condition(condition).follows:
            yield from _cut(tests, float(study.condition(condition).protocol.sample_time[-1]))


def _apart(tests: Sequence[Recording]) -> Iterator[str]:
    """Report tests that are much deeper or shallower than the others of their condition."""
    depths = np.array([test.depth.max() for test in tests])
    usual = float(np.median(depths))
    for test, depth in zip(tests, depths, strict=True):
        if not usual / APART < depth < usual * APART:
            yield (
                f"{test.name}.csv is {depth:.4g} nm deep, the median of its condition's tests {usual:.4g} nm: another "
                "unit, zero point or material?"
            )


def _passed_over(folder: Path) -> Iterator[str]:
    """Report files of a folder of recordings that are not read."""
    visible = {file for file in folder.iterdir() if file.is_file() and not file.name.startswith(".")}
    for file in sorted(visible.difference(recording_files(folder))):
        yield f"{file.name} is not read: recordings are .csv files (`palpate read` converts vendors' files)"


def _cut(tests: Sequence[Recording], duration: float) -> Iterator[str]:
    """Report tests that last longer than the load history of their condition, of a `duration` [s]."""
    for test in tests:
        lasts = float(test.from_contact().time[-1])
        if lasts > LONGER * duration:
            yield (
                f"{test.name}.csv lasts {lasts:.4g} s, the recorded load that its condition follows ends after "
                f"{duration:.4g} s: what comes later does not count (the first file by name is followed)"
            )
