"""Which tests were made alike: recordings of one history of the drive, or of one method, are replicates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from string import ascii_lowercase

import numpy as np
from scipy.optimize import least_squares

from indentation_files.recording import Recording
from indentation_files.segments import Segment, segments
from palpate.base.classes import classes_of, levels
from palpate.data.observation import WHOLE
from palpate.data.recording_checks import LOAD_TOLERANCE, check_drive
from palpate.draft.methods import LOADED, end_of_loading, of_one_method, the_middle
from palpate.draft.prescribed_drive import Drive
from palpate.errors import InputError
from palpate.study.alignment import aligned
from palpate.study.prescribed_segments import last_cycles
from palpate.study.protocol import LOAD

TRAPEZOIDAL = 0.005  # of the largest drive, root mean square, within which it is called a trapezoid
BRIEF = 0.003  # of loading and unloading, a hold that counts as none
FOR_VALIDATION = 3  # conditions from which on one is held out
SAME_TIME = 1.05  # chosen: ratio of durations of one history, whose start and end are seen a little early or late


@dataclass(frozen=True, eq=False)
class Group:
    """Tests of one history of the drive, or of one method.

    Parameters
    ----------
    name
        After the largest load [mN], or displacement [nm], and the time of loading [s], such as ``P2_T20``, ``D500_T5``.
    recordings
        From contact on, in the order in which they were given; but where a recorded load is followed, the shortest
        comes first, or of one method that in the middle.
    history
        Keys of a study's condition: those of a trapezoid where the drive is one, else ``load_history: recorded``, with
        ``own_loads`` where tests of one method reach different loads.
    held_out
        Which cycles of the tests are held out, in words, see `with_held_out_cycles`; empty for none.
    """

    name: str
    recordings: tuple[Recording, ...]
    history: Mapping[str, object]
    held_out: str = ""


def grouped(recordings: Sequence[Recording], drive: Drive) -> list[Group]:
    """Return the tests by history of their drive, the smallest first.

    Two tests are alike where a study would take the longer for a recording of a condition that follows the shorter, and
    both last about as long. Groups of one method whose tests reach different loads become one, see
    `palpate.draft.methods`.

    Parameters
    ----------
    recordings
        From contact on, named after their files.
    drive
        What was prescribed.

    Raises
    ------
    InputError
        When a test is too short to find its segments; with the recording's name as the file.
    """
    exact = [
        alike
        for level in levels(recordings, lambda one: float(drive.of(one).max()), 1.0 + LOAD_TOLERANCE)
        for alike in classes_of(sorted(level, key=_duration), lambda first, other: _alike(first, other, drive))
    ]
    found = of_one_method(exact, drive)
    found.sort(key=lambda members: _size_and_rise(members, drive))
    given: Counter[str] = Counter()
    groups: list[Group] = []
    for members in found:
        letter, (largest, rise) = "P" if drive.control == LOAD else "D", _size_and_rise(members, drive)
        stem = f"{letter}{_short(largest, 2)}_T{_short(rise, 2)}"
        name = stem + _suffix(given[stem])
        given[stem] += 1
        history: dict[str, object]
        if any(members is each for each in exact):
            followed, history = members[0], _trapezoid(members, drive) or {"load_history": "recorded"}
        else:
            followed, history = the_middle(members, drive), {"load_history": "recorded", "own_loads": True}
        first = followed if "load_history" in history else None
        members = sorted(members, key=lambda one: (one is not first, recordings.index(one)))
        groups.append(Group(name, tuple(members), {**drive.keys, **history}))
    return groups


def with_held_out_cycles(groups: Sequence[Group], drive: Drive) -> list[Group]:
    """Return the groups, where they are too few for one to be held out with their last cycles held out."""
    if len(groups) >= FOR_VALIDATION:
        return list(groups)
    found = []
    for group in groups:
        if last := last_cycles(drive.followed(group.recordings[0])):
            (begin, end), words = last
            group = replace(group, history={**group.history, "held_out": [[begin, end]]}, held_out=words)
        found.append(group)
    return found


def _suffix(earlier: int) -> str:
    """Return what distinguishes a name from so many earlier ones: nothing, b to z, z26, z27, ..."""
    if earlier < len(ascii_lowercase):
        return ascii_lowercase[earlier] if earlier else ""
    return f"z{earlier}"


def _alike(shorter: Recording, longer: Recording, drive: Drive) -> bool:
    if _duration(longer) > SAME_TIME * _duration(shorter):
        return False
    try:
        protocol = drive.followed(shorter)
        check_drive(protocol, aligned(longer, protocol))
    except InputError:
        return False
    return True


def _duration(recording: Recording) -> float:
    return float(recording.time[-1])


def _trapezoid(recordings: Sequence[Recording], drive: Drive) -> dict[str, object] | None:
    """Return the keys of the trapezoid that the drives are, rounded to three digits; None if they are none.

    A test that ends under load, long before the trapezoid that it follows would, is none either.
    """
    found = []
    for recording in recordings:
        prescribed = drive.of(recording)
        try:
            parts = _loaded(segments(recording.time, prescribed), prescribed)
        except InputError as error:
            raise error.located(file=recording.name) from None
        if [part.kind for part in parts] not in (["loading", "unloading"], ["loading", "hold", "unloading"]):
            return None
        durations = parts[0].end, parts[-1].start - parts[0].end, parts[-1].duration
        found.append(_fitted(recording.time, prescribed, [prescribed.max(), *durations]))
    largest, loading, hold, unloading = (float(_short(value)) for value in np.median(found, axis=0))
    hold = hold if hold > BRIEF * (loading + unloading) else 0.0
    corners = [largest, loading, hold, unloading]
    if max(np.sqrt(np.mean(_departure(corners, r.time, drive.of(r)) ** 2)) for r in recordings) > TRAPEZOIDAL * largest:
        return None
    if min(recording.time[-1] for recording in recordings) < WHOLE * (loading + hold + unloading):
        return None
    return dict(zip((f"max_{drive.control}", "loading_time", "hold_time", "unloading_time"), corners, strict=True))


def _loaded(parts: Sequence[Segment], drive: np.ndarray) -> list[Segment]:
    """Return the segments without those of noise after unloading."""
    least = TRAPEZOIDAL * float(drive.max())
    return [part for part in parts if drive[part.first : part.last + 1].max() > least]


def _fitted(time: np.ndarray, drive: np.ndarray, start: Sequence[float]) -> np.ndarray:
    """Return size and times [s] of loading, hold and unloading of the trapezoid next to a recorded drive."""
    scale = np.array([start[0], *[time[-1]] * 3])
    least = np.array([1e-3, 1e-3, 0.0, 1e-3])
    begin = np.maximum(start / scale, least)
    return scale * least_squares(lambda x: _departure(scale * x, time, drive), begin, bounds=(least, 2.0)).x


def _departure(corners: Sequence[float] | np.ndarray, time: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Return the recorded drive less that of a trapezoid at the recorded times."""
    largest, *durations = corners
    return drive - np.interp(time, np.cumsum([0.0, *durations]), [0.0, largest, largest, 0.0])


def _size_and_rise(members: Sequence[Recording], drive: Drive) -> tuple[float, float]:
    """Return the largest drive of tests and their time of loading [s], medians."""
    drives = [drive.of(member) for member in members]
    rises = [member.time[end_of_loading(of)] / LOADED for member, of in zip(members, drives, strict=True)]
    return float(np.median([of.max() for of in drives])), float(np.median(rises))


def _short(value: float, digits: int = 3) -> str:
    """Return a number to so many digits, without an exponent."""
    return np.format_float_positional(value, precision=digits, fractional=False, trim="-")
