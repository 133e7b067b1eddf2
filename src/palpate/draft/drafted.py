"""One test of a draft: from contact on, checked, with where it comes from and what was assumed of its beginning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.draft.solid import peak_of
from palpate.draft.yaml_text import printable
from palpate.errors import InputError
from palpate.recordings.readers import VendorTest
from palpate.recordings.readers.vendor import in_words
from palpate.recordings.recording import BARELY_LOADED, Recording
from palpate.recordings.segments import segments

CORRECTED = "corrections in depth: "
NEXT_POINT = 1.5  # sampling intervals within which the first point follows contact
BRIEF = 0.005  # of the time to the largest load, within which nobody minds what is assumed


@dataclass(frozen=True, eq=False)
class Drafted:
    """A test that can be drafted.

    Parameters
    ----------
    recording
        From contact on, named after file and test as people find them, with all that `palpate read` writes as notes.
    source
        What the reader found in the file.
    assumed
        How long the loading is that no point tells [s]: the test begins under load, or 0.
    preload
        Under which load it begins [mN].
    """

    recording: Recording
    source: VendorTest
    assumed: float = 0.0
    preload: float = 0.0

    @property
    def facts(self) -> dict[str, Any]:
        """What the file says of tip and sample; a recording that `palpate read` has written says it in its comments."""
        said = (note.partition(": ") for note in self.recording.notes)
        return {key: value for key, _, value in said if value} | dict(self.source.metadata)

    @classmethod
    def of(cls, file: Path, test: VendorTest, corrections: frozenset[str] | None) -> Drafted:
        """Begin a test of a file at contact; raises `InputError` where it is too short, never pressed or sunk in."""
        name = printable(f"{file}, {test.name}")
        try:
            begun = replace(test.recording.from_contact(), name=name)
            segments(begun.time, begun.load)
            peak_of(begun)
        except InputError as error:
            raise error.located(file=name) from None
        assumed = _assumed(test.recording, begun)
        notes = _provenance(file, test, corrections)
        if not assumed:
            return cls(replace(begun, notes=notes), test)
        preload = float(test.recording.load[0])
        told = f"begins under {preload:.3g} mN: the loading up to there, {assumed:.3g} s, is assumed"
        return cls(replace(begun, notes=(*notes, told)), test, assumed, preload)


def assumed(tests: Sequence[Drafted]) -> list[str]:
    """Return a remark on tests that begin under load, none where there is no such test."""
    found = [test for test in tests if test.assumed]
    if not found:
        return []
    first, others = found[0], f" and {len(found) - 1} more" if len(found) > 1 else ""
    longest = max(test.assumed for test in found)
    return [
        f"{first.recording.name}{others} begin{'' if others else 's'} under load ({first.preload:.3g} mN): the loading "
        f"up to there{', up to' if others else ','} {longest:.3g} s, was not recorded and is assumed to be as fast as "
        "what follows; export from contact on if you can"
    ]


def _assumed(recording: Recording, begun: Recording) -> float:
    """Return how long the loading is that was put before the first point [s]."""
    if len(begun) == len(recording) or recording.load[0] <= BARELY_LOADED * recording.load.max():
        return 0.0
    added, loading = float(begun.time[1]), float(begun.time[np.argmax(begun.load)])
    return added if added > max(NEXT_POINT * np.median(np.diff(recording.time)), BRIEF * loading) else 0.0


def _provenance(file: Path, test: VendorTest, corrections: frozenset[str] | None) -> tuple[str, ...]:
    """Return the comments of `palpate read`, with the file as it was given."""
    said = [note for note in test.recording.notes if note != f"from {file.name}"]
    if not any(note.startswith(CORRECTED) for note in said):
        said.append(CORRECTED + in_words(corrections))
    facts = (f"{key}: {value}" for key, value in test.metadata.items())
    return (printable(f"from {file}, {test.name}"), *said, *test.warnings, *facts)
