"""The sets of recordings that a study names: their folders, and what writes them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.errors import InputError

RESERVED = (
    "benchmarks", "figures", "law.json", "logs", "receipt.json", "recordings", "report.html", "report.manifest.json",
    "sent.json", "sent.lock", "snapshots", "snapshots.csv", "surrogates", "tracking",
)  # fmt: skip


def recording_sets(settings: Mapping[str, Any]) -> dict[str, Path]:
    """Return the folder of each set of recordings.

    Parameters
    ----------
    settings
        The study, whose sections ``laboratory`` and ``source`` write sets.

    Raises
    ------
    InputError
        When a set has the name of other results, is written but not named, or is written twice.
    """
    given, laboratory = settings.get("recordings", {}), settings.get("laboratory", {})
    for name in given:
        if name in RESERVED:
            raise InputError(
                f"{name!r} is reserved for other results", remedy="choose another name", place="recordings"
            )
    for name in laboratory:
        if name not in given:
            raise InputError(
                f"{name} is no set of recordings", remedy=f"add the folder of {name} to recordings",
                place=f"laboratory.{name}",
            )  # fmt: skip
        if name == settings.get("source", {}).get("recordings"):
            raise InputError(
                f"{name} is converted from the vendor's file, too", remedy="take it out here or under source",
                place=f"laboratory.{name}",
            )  # fmt: skip
    return {name: Path(folder).expanduser() for name, folder in given.items()}
