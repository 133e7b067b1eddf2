"""The sets of recordings that a study names: their folders, and what writes them."""

from __future__ import annotations

from pathlib import Path

from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError

RESERVED = (
    "benchmarks", "figures", "instrument.json", "law.json", "logs", "receipt.json", "recordings", "report.html",
    "report.manifest.json", "sent.json", "sent.lock", "snapshots", "snapshots.csv", "surrogates", "tracking",
)  # fmt: skip


def recording_sets(study: StudyFile) -> dict[str, Path]:
    """Return the folder of each set of recordings.

    Parameters
    ----------
    study
        Its file, whose sections ``laboratory`` and ``source`` write sets.

    Raises
    ------
    InputError
        When a set has the name of other results, is written but not named, or is written twice.
    """
    for name in study.recordings:
        if name in RESERVED:
            raise InputError(
                f"{name!r} is reserved for other results", remedy="choose another name", place="recordings"
            )
    for name in study.laboratory:
        if name not in study.recordings:
            raise InputError(
                f"{name} is no set of recordings", remedy=f"add the folder of {name} to recordings",
                place=f"laboratory.{name}",
            )  # fmt: skip
        if study.source and name == study.source.recordings:
            raise InputError(
                f"{name} is converted from the vendor's file, too", remedy="take it out here or under source",
                place=f"laboratory.{name}",
            )  # fmt: skip
    return {name: Path(folder).expanduser() for name, folder in study.recordings.items()}
