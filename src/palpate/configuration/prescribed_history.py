"""What the instrument prescribes under a condition of a study: from the numbers of its entry, or from a recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from indentation_files.readers import VendorTest
from indentation_files.recording import Recording
from indentation_files.recording_file import condition_of, read_history, read_recording, recording_files
from palpate.configuration.source_section import conditions_of
from palpate.errors import InputError
from palpate.study.load_history import KEYS, SHAPES, control_from, protocol_from
from palpate.study.protocol import LOAD, Protocol, drive_of
from palpate.study.recorded_history import recorded

RECORDED = "recorded"  # a load history: that of the condition's first recording


@dataclass(frozen=True)
class Histories:
    """Where the histories of a study's conditions come from.

    Parameters
    ----------
    points
        Samples of a simulated curve.
    recordings
        Folder of each set of recordings that no laboratory of the study writes: its recordings follow the history.
    source
        The section ``source`` of the study.
    tests
        Reads the tests of each condition from the vendor's file.
    """

    points: int
    recordings: Mapping[str, Path]
    source: Mapping[str, Any]
    tests: Callable[[], Mapping[str, list[VendorTest]]]

    def protocol(self, entry: Mapping[str, Any]) -> Protocol:
        """Return what the `entry` of a condition prescribes; raises `InputError` with the place within the entry."""
        given = {key: entry[key] for key in KEYS if key in entry}
        if "load_history" not in entry:
            return protocol_from({**given, "points": self.points})
        if shapes := [key for key in SHAPES if key in given]:
            raise InputError(f"load_history and {shapes[0]} exclude each other", remedy="keep one")
        history = self._recording(entry)
        control, compliance, _ = control_from(given)
        begun = history.from_contact(drive_of(control, compliance, history.load, history.depth))
        drive = drive_of(control, compliance, begun.load, begun.depth)
        return recorded(begun.time, drive, self.points, control, compliance)

    def _recording(self, entry: Mapping[str, Any]) -> Recording:
        """Return the recording whose load or displacement a condition follows."""
        if entry["load_history"] != RECORDED:
            return read_history(Path(entry["load_history"]).expanduser(), entry.get("drive", LOAD))
        if entry["name"] in conditions_of(self.source):
            return self.tests()[entry["name"]][0].recording
        for folder in self.recordings.values():
            for file in recording_files(folder):
                if condition_of(file) == entry["name"]:
                    return read_recording(file)
        searched = " and ".join(map(str, self.recordings.values()))
        where = f" in {searched} below {Path.cwd()}" if searched else ""
        raise InputError(
            f"load_history is `recorded`, but there is no recording of this condition{where}",
            remedy=f"add {entry['name']}_1.csv to a folder under recordings that no laboratory writes",
        )
