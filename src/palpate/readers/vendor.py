"""What a reader of an instrument's files gives back, and what it must declare."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.recording import Recording

CORRECTIONS = ("drift", "frame")
MOST_LEFT_OUT = 0.05
Corrections = frozenset[str] | None


@dataclass(frozen=True)
class VendorTest:
    """One test from a vendor's file.

    Parameters
    ----------
    name
        The test's name in the file, or its number.
    recording
        Time [s], load [mN], depth [nm], whole: time is zero at the file's own contact and negative in the approach.
    metadata
        Whatever the file says of instrument, tip, method and results, by the vendor's names.
    warnings
        What the user should know of the reading, such as rows that were left out.
    """

    name: str
    recording: Recording
    metadata: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reader:
    """A file format.

    Parameters
    ----------
    key, title
        Short name, and name for people.
    matches
        Whether a file is of this format, by its content.
    read
        Reads all tests. The corrections are those to be in the depth: None for the vendor's own, otherwise a set of
        ``drift`` and ``frame``; `InputError` where the file does not hold what that needs.
    """

    key: str
    title: str
    matches: Callable[[Source], bool]
    read: Callable[[Source, Corrections], list[VendorTest]]


def refuse_corrections(source: Source, corrections: Corrections) -> None:
    """Raise `InputError` when corrections are chosen on a file that holds nothing but the final channels."""
    if corrections is not None:
        raise InputError(
            "this export holds the vendor's final channels only",
            remedy="leave --raw and --correct off, or export raw data",
            file=source.path,
        )


def corrected(
    displacement: np.ndarray,
    time: np.ndarray,
    load: np.ndarray,
    *,
    drift: float,
    compliance: float,
    corrections: frozenset[str],
) -> np.ndarray:
    """Return displacement (n,) [nm] less the drift and the frame's deflection, where they are among `corrections`.

    Parameters
    ----------
    displacement, time, load : ndarray, shape (n,)
        [nm], [s] and [mN], all counted from contact.
    drift, compliance
        [nm/s], [nm/mN].
    """
    depth = displacement.copy()
    if "drift" in corrections:
        depth -= drift * time
    if "frame" in corrections:
        depth -= compliance * load
    return depth


def contact(load: np.ndarray) -> int:
    """Return the index of the last point at or below zero load before a tenth of the largest load is reached.

    Where the load never gets that low, its least value before then is taken.
    """
    early = load[: max(1, int(np.argmax(load > 0.1 * load.max())))]
    return int(np.flatnonzero(early <= max(0.0, early.min()))[-1])


def increasing(time: np.ndarray) -> np.ndarray:
    """Return which points of `time` (n,) are later than all before them, by more than its rounding."""
    return np.diff(np.maximum.accumulate(time), prepend=-np.inf) > 1e-9 * np.ptp(time)


def recording_from(
    source: Source,
    place: str,
    name: str,
    time: np.ndarray,
    load: np.ndarray,
    depth: np.ndarray,
    stiffness: np.ndarray | None = None,
) -> Recording:
    """Return a recording less its invalid points and repeated times (a segment's last point is often written twice).

    Raises
    ------
    InputError
        When more than a twentieth of the points between the first and the last valid one would have to go, or the rest
        is no recording.
    """
    valid = np.isfinite(time) & np.isfinite(load) & np.isfinite(depth)
    if stiffness is not None:
        stiffness = stiffness[valid]
    if valid.any():
        ends = np.flatnonzero(valid)[[0, -1]]
        time, load, depth, valid = (values[ends[0] : ends[1] + 1] for values in (time, load, depth, valid))
    time, load, depth = time[valid], load[valid], depth[valid]
    later = increasing(time) if len(time) else valid[:0]
    if len(time) < 2 or later.sum() < (1 - MOST_LEFT_OUT) * len(valid):
        lost = len(valid) - int(later.sum())
        raise InputError(
            f"{lost} of {len(valid)} points are invalid or go back in time" if lost else "holds fewer than two points",
            remedy="export the test again",
            file=source.path,
            place=place,
        )
    try:
        notes = (f"from {source.path.name}",)
        stiffness = None if stiffness is None else stiffness[later]
        return Recording(time[later], load[later], depth[later], name, notes, stiffness)
    except InputError as error:
        raise error.located(file=source.path, place=place) from None
