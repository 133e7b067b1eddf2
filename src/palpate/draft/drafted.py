"""One test of a draft: from contact on, checked, with where it comes from and what was assumed or cut off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from indentation_files.borne_load import check_borne, pull_off
from indentation_files.channel_noise import noise_of
from indentation_files.readers import VendorTest
from indentation_files.readers.vendor import provenance
from indentation_files.recording import BARELY_LOADED, Recording
from indentation_files.segments import segments
from palpate.data.recording_checks import NOISE_PEAK
from palpate.draft.solid import peak_of
from palpate.draft.yaml_text import printable
from palpate.errors import InputError

NEXT_POINT = 1.5  # sampling intervals within which the first point follows contact
BRIEF = 0.005  # of the time to the largest load, within which an assumed loading is not reported


@dataclass(frozen=True, eq=False)
class Drafted:
    """A test that can be drafted.

    Parameters
    ----------
    recording
        From contact on, named after file and test, with all that `palpate read` writes as notes.
    source
        What the reader found in the file.
    assumed
        How long the loading is that no point records [s]: the test begins under load, or 0.
    preload
        Under which load it begins [mN], or 0.
    pull
        Largest pull on the tip after the test that was cut off [mN], or 0.
    """

    recording: Recording
    source: VendorTest
    assumed: float = 0.0
    preload: float = 0.0
    pull: float = 0.0

    @property
    def facts(self) -> dict[str, Any]:
        """What the file states of tip and sample; a recording written by `palpate read` states it in its comments."""
        stated = (note.partition(": ") for note in self.recording.notes)
        return {key: value for key, _, value in stated if value} | dict(self.source.metadata)

    @classmethod
    def of(
        cls, file: Path, test: VendorTest, corrections: frozenset[str] | None, whole: VendorTest | None = None
    ) -> Drafted:
        """Begin a test of a file at contact; raises `InputError` where it is too short, never pressed or sunk in.

        Parameters
        ----------
        file, test
            Where it is, and what was read there.
        corrections
            That its depth holds; None for the vendor's own.
        whole
            The test with its approach and what follows it, where that is known.
        """
        name = printable(f"{file}, {test.name}")
        try:
            check_borne(test.recording)
            begun = replace(test.recording.from_contact(), name=name)
            segments(begun.time, begun.load)
            peak_of(begun)
        except InputError as error:
            raise error.located(file=name) from None
        assumed = _assumed(test.recording, begun)
        preload = float(test.recording.load[0]) if assumed else 0.0
        pull = pull_off(whole.recording) if whole else 0.0
        notes = tuple(note for note in provenance(test, corrections) if note != f"from {file.name}")
        if pull:
            notes += (f"a pull of {pull:.3g} mN on the tip after the test is cut off",)
        if assumed:
            notes += (f"begins under {preload:.3g} mN: the loading up to there, {assumed:.3g} s, is assumed",)
        origin = printable(f"from {file}, {test.name}")
        return cls(replace(begun, notes=(origin, *notes)), test, assumed, preload, pull)


def _assumed(recording: Recording, begun: Recording) -> float:
    """Return how long the loading is that was put before the first point [s]."""
    noise = NOISE_PEAK * noise_of(recording.load)
    if len(begun) == len(recording) or recording.load[0] <= max(BARELY_LOADED * recording.load.max(), noise):
        return 0.0
    added, loading = float(begun.time[1]), float(begun.time[np.argmax(begun.load)])
    return added if added > max(NEXT_POINT * np.median(np.diff(recording.time)), BRIEF * loading) else 0.0
