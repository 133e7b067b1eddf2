"""Which tests were made alike: recordings of one load history are replicates of one condition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_lowercase

import numpy as np
from scipy.optimize import least_squares

from palpate.errors import InputError
from palpate.inference.observation import WHOLE
from palpate.inference.study_recordings import check_drive
from palpate.recordings.alignment import aligned
from palpate.recordings.recording import Recording
from palpate.recordings.segments import segments
from palpate.study.recorded_history import recorded

TRAPEZOIDAL = 0.005  # of the largest load, root mean square, within which a load is called a trapezoid
BRIEF = 0.003  # of loading and unloading, a hold that counts as none
REACHED = 0.98


@dataclass(frozen=True, eq=False)
class Group:
    """Tests of one load history.

    Parameters
    ----------
    name
        After the largest load [mN] and the time of loading [s], such as ``P2_T20``.
    recordings
        From contact on, in the order in which they were given.
    history
        Keys of a study's condition: those of a trapezoid where the loads are one, else ``load_history: recorded``.
    """

    name: str
    recordings: tuple[Recording, ...]
    history: Mapping[str, float | str]


def grouped(recordings: Sequence[Recording]) -> list[Group]:
    """Return the tests by load history, the smallest load first.

    Two tests are alike where a study would take each for a recording of a condition that follows the other.

    Parameters
    ----------
    recordings
        From contact on, named after their files.

    Raises
    ------
    InputError
        When a test is too short to tell its segments; with the recording's name as the file.
    """
    found: list[list[Recording]] = []
    for recording in recordings:
        members = next((group for group in found if _alike(group[0], recording)), None)
        if members is None:
            found.append(members := [])
        members.append(recording)
    found.sort(key=lambda members: (members[0].load.max(), _loading_time(members[0])))
    given: Counter[str] = Counter()
    groups: list[Group] = []
    for members in found:
        load = np.median([member.load.max() for member in members])
        stem = f"P{_short(load, 2)}_T{_short(_loading_time(members[0]), 2)}"
        name = stem + _suffix(given[stem])
        given[stem] += 1
        groups.append(Group(name, tuple(members), _trapezoid(members) or {"load_history": "recorded"}))
    return groups


def _suffix(earlier: int) -> str:
    """Return what tells a name from so many earlier ones: nothing, b to z, z26, z27, ..."""
    if earlier < len(ascii_lowercase):
        return ascii_lowercase[earlier] if earlier else ""
    return f"z{earlier}"


def _alike(first: Recording, other: Recording) -> bool:
    try:
        for one, two in ((first, other), (other, first)):
            protocol = recorded(one.time, one.load)
            check_drive(protocol, aligned(two, protocol))
    except InputError:
        return False
    return True


def _trapezoid(recordings: Sequence[Recording]) -> dict[str, float | str] | None:
    """Return the keys of the trapezoid that the loads are, rounded to three digits; None if they are none.

    A test that ends under load, long before the trapezoid that it follows would, is none either.
    """
    found = []
    for recording in recordings:
        try:
            parts = segments(recording.time, recording.load)
        except InputError as error:
            raise error.located(file=recording.name) from None
        if [part.kind for part in parts] not in (["loading", "unloading"], ["loading", "hold", "unloading"]):
            return None
        durations = parts[0].end, parts[-1].start - parts[0].end, parts[-1].duration
        found.append(_fitted(recording, [recording.load.max(), *durations]))
    load, loading, hold, unloading = (float(_short(value)) for value in np.median(found, axis=0))
    hold = hold if hold > BRIEF * (loading + unloading) else 0.0
    corners = [load, loading, hold, unloading]
    if max(np.sqrt(np.mean(_departure(corners, r) ** 2)) for r in recordings) > TRAPEZOIDAL * load:
        return None
    if min(recording.time[-1] for recording in recordings) < WHOLE * (loading + hold + unloading):
        return None
    return dict(zip(("max_load", "loading_time", "hold_time", "unloading_time"), corners, strict=True))


def _fitted(recording: Recording, start: Sequence[float]) -> np.ndarray:
    """Return load [mN] and times [s] of loading, hold and unloading of the trapezoid next to a recorded load."""
    scale = np.array([start[0], *[recording.time[-1]] * 3])
    least = np.array([1e-3, 1e-3, 0.0, 1e-3])
    begin = np.maximum(start / scale, least)
    return scale * least_squares(lambda x: _departure(scale * x, recording), begin, bounds=(least, 2.0)).x


def _departure(corners: Sequence[float] | np.ndarray, recording: Recording) -> np.ndarray:
    """Return the recorded load less that of a trapezoid [mN] at the recorded times."""
    load, *durations = corners
    return recording.load - np.interp(recording.time, np.cumsum([0.0, *durations]), [0.0, load, load, 0.0])


def _loading_time(recording: Recording) -> float:
    return float(recording.time[np.argmax(recording.load >= REACHED * recording.load.max())]) / REACHED


def _short(value: float, digits: int = 3) -> str:
    """Return a number to so many digits, without an exponent."""
    return np.format_float_positional(value, precision=digits, fractional=False, trim="-")
