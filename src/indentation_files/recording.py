"""A recording: time, load and depth of one test, and how it is written as a CSV."""

from __future__ import annotations

import io
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from indentation_files.errors import InputError
from indentation_files.whole_file import written_whole

HEADER = "time_s,load_mN,depth_nm"
WITH_STIFFNESS = HEADER + ",stiffness_mN_per_nm"
STIFFNESS_FOLDER = "stiffness"
TEST_NUMBER = re.compile(r"^test_number:\s*(\d+)\s*$")
SYNTHETIC = "SYNTHETIC"  # begins the comment that marks a recording as simulated, not measured
BARELY_LOADED = 1e-3  # of the largest drive, up to which a test has not begun
DIGITS, MOST_DIGITS = 9, 15  # significant ones that are written; of times that these would not distinguish
MOST = 200_000  # points that are kept of one: curves are compared at a hundred times
ROUNDED = 1e-3  # of a channel's range, beyond which no rounding makes copies differ
COMPARED = 30  # points that show which recordings may be copies
RATE_START, RATE_SPAN = 0.005, 0.05  # of the largest load, between which the rate of the first loading is taken


@dataclass(frozen=True, eq=False)
class Recording:
    """Time, load and depth of one indentation test.

    Parameters
    ----------
    time, load, depth : ndarray, shape (n,)
        [s] strictly increasing, [mN], [nm]. Load and depth are zero at contact.
    name
        Such as ``P1.00_T030_1``.
    notes
        Lines kept as comments at the head of the CSV.
    stiffness : ndarray, shape (n,), optional
        dP/dh [mN/nm] that the instrument measured by a small oscillation, with the corrections that the depth has; NaN
        where it measured none.
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    name: str = ""
    notes: tuple[str, ...] = ()
    stiffness: np.ndarray | None = None

    def __post_init__(self) -> None:
        for key in ("time", "load", "depth"):
            object.__setattr__(self, key, np.asarray(getattr(self, key), dtype=float))
        if not len(self.time) == len(self.load) == len(self.depth):
            raise InputError("time, load and depth differ in length", remedy="give one value of each a point")
        if self.stiffness is not None and len(self.stiffness) != len(self.time):
            raise InputError("time and stiffness differ in length", remedy="give one value of each a point")
        check_points(self.time, self.load, self.depth)
        if len(self.time) == 0:
            raise InputError("the recording is empty", remedy="export the test again")

    def __len__(self) -> int:
        return len(self.time)

    @property
    def test_number(self) -> int | None:
        """Its place in the order in which tests were made, by a note ``test_number: N``; None where none says so."""
        found = next(filter(None, map(TEST_NUMBER.match, self.notes)), None)
        return int(found[1]) if found else None

    @property
    def synthetic(self) -> bool:
        """Whether its notes say that it was simulated, and not measured."""
        return marked_synthetic(self.notes)

    def at(self, kept: slice | np.ndarray) -> Recording:
        """Return the recording at some of its points."""
        stiffness = None if self.stiffness is None else self.stiffness[kept]
        return replace(self, time=self.time[kept], load=self.load[kept], depth=self.depth[kept], stiffness=stiffness)

    def from_contact(self, drive: np.ndarray | None = None) -> Recording:
        """Return the recording with time zero where loading began, and zero load there.

        What comes before the clock's zero without load is the approach, and is left out. A recording that begins under
        load (its first points cut off, or taken after the start) is extended back to zero load and depth at the rate of
        its first loading, after a hold at a preload if there is one. The clock's own zero is kept when loading began
        within one sampling interval of it, and no point under load is there. Where a displacement is prescribed, that
        is the `drive` (n,) by which all this is decided, in place of the load.

        Raises `InputError` when the recording begins under load that does not rise.
        """
        drive = self.load if drive is None else drive
        peak = int(np.argmax(drive))
        approach = self.time < 0.0
        if 0 < approach.sum() < len(self) and np.all(drive[approach] <= BARELY_LOADED * drive[peak]):
            return self.at(~approach).from_contact(drive[~approach])
        begin, loaded = self.time[0], drive[0] > BARELY_LOADED * drive[peak]
        if begin == 0.0 and not loaded:
            return self
        interval = float(np.median(np.diff(self.time))) if len(self) > 1 else 0.0
        if loaded:
            risen = (drive[: peak + 1] - drive[0]) / drive[peak]
            last = max(int(np.argmax(risen > RATE_SPAN)) - 1, 1) if risen[-1] > RATE_SPAN else peak
            first = min(int(np.flatnonzero(risen[: last + 1] <= RATE_START)[-1]), last - 1) if last else 0
            rise = slice(first, last + 1)
            rate = np.polyfit(self.time[rise] - begin, drive[rise], 1)[0] if last else 0.0
            if rate <= 0:
                problem = f"the recording begins under {self.load[0]:.4g} mN that does not rise"
                raise InputError(problem, remedy="export the test from contact on", place="load_mN")
            begin -= drive[0] / rate
        if abs(begin) <= interval and not (loaded and self.time[0] <= 0.0):
            begin = 0.0
        time, load, depth, stiffness = self.time - begin, self.load, self.depth, self.stiffness
        if time[0] > 0:
            time, load, depth = (np.append(0.0, values) for values in (time, load, depth))
            stiffness = None if stiffness is None else np.append(np.nan, stiffness)
        return replace(self, time=time, load=load, depth=depth, stiffness=stiffness)

    def write(self, path: str | Path) -> None:
        """Write the recording as CSV; the file appears whole or not at all.

        Raises `InputError` when something exists there that is no file.
        """
        path = Path(path)
        if path.exists() and not path.is_file():
            raise InputError("the output is no file", remedy="name a file", file=path)
        path = Path(os.path.realpath(path))
        text = io.StringIO()
        for note in self.notes:
            text.write(f"# {' '.join(note.split())}\n")
        header, measured = (HEADER, []) if self.stiffness is None else (WITH_STIFFNESS, [self.stiffness])
        channels = [self.time, self.load, self.depth, *measured]
        text.write(header + "\n")
        rounded = [float(f"{instant:.{DIGITS}g}") for instant in self.time]
        digits = [DIGITS if np.all(np.diff(rounded) > 0.0) else MOST_DIGITS] + [DIGITS] * (len(channels) - 1)
        np.savetxt(text, np.column_stack(channels), fmt=[f"%.{count}g" for count in digits], delimiter=",")
        with written_whole(path) as partial:
            partial.write_text(text.getvalue(), encoding="utf-8")

    def write_apart(self, path: str | Path) -> None:
        """Write the recording in three columns, and once more with its stiffness, if it has one, in a folder beside.

        `read_recording` puts the two together again.
        """
        path = Path(path)
        replace(self, stiffness=None).write(path)
        beside = stiffness_file(path)
        beside.unlink(missing_ok=True)
        if self.stiffness is not None:
            beside.parent.mkdir(exist_ok=True)
            self.write(beside)


def stiffness_file(path: Path) -> Path:
    """Return where the stiffness of a recording lies, if it has one of its own, see `Recording.write_apart`."""
    return path.parent / STIFFNESS_FOLDER / path.name


def marked_synthetic(notes: Iterable[str]) -> bool:
    """Return whether the notes of a recording say that it was simulated, and not measured."""
    return any(note.startswith(SYNTHETIC) for note in notes)


def spaced(points: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return, of more than `MOST` of some points (n,), every second, third, ... and the last, and in words how many."""
    every = math.ceil(len(points) / MOST)
    if every <= 1:
        return points, ()
    kept = np.append(points[:-1:every], points[-1])
    return kept, (f"{len(kept)} of {len(points)} points are kept, evenly spaced: curves are compared at far fewer",)


def check_points(time: np.ndarray, load: np.ndarray, depth: np.ndarray, first: int = 1) -> None:
    """Check that points (n,) are numbers and their times increase; raises `InputError` when one is not, or does not.

    The points are `time`, `load` and `depth`; the number of the `first` one is for messages.
    """
    check_numbers({"time_s": time, "load_mN": load, "depth_nm": depth}, first)
    steps = np.diff(time)
    if np.any(steps <= 0):
        row = int(np.flatnonzero(steps <= 0)[0])
        raise InputError(
            f"time does not increase from point {first + row} ({time[row]:g} s) to point {first + row + 1} "
            f"({time[row + 1]:g} s)",
            remedy="sort the points and drop repeated times",
            place="time_s",
        )


def check_numbers(columns: Mapping[str, np.ndarray], first: int = 1) -> None:
    """Raise `InputError` where a column (n,), by its heading, is no finite number at a point, counted from `first`."""
    for key, values in columns.items():
        if not np.all(np.isfinite(values)):
            row = first + int(np.flatnonzero(~np.isfinite(values))[0])
            problem = f"{key} is not a number at point {row}"
            raise InputError(problem, remedy="remove the point or fill it in", place=key)


def copies(recordings: Iterable[Recording]) -> list[tuple[Recording, Recording]]:
    """Return each recording that repeats an earlier one, and that one.

    It has as many points, and each channel agrees at all of them to half of the last digit with which the coarser one
    is written, as where a test was exported again. Noise makes replicates differ by more.
    """
    of_length: dict[int, list[Recording]] = {}
    for recording in recordings:
        of_length.setdefault(len(recording), []).append(recording)
    return [pair for alike in of_length.values() if len(alike) > 1 for pair in _copies(alike)]


def _copies(alike: Sequence[Recording]) -> Iterator[tuple[Recording, Recording]]:
    """Yield those of recordings of one length; some of their points show of which pairs it may be true."""
    from scipy.spatial import cKDTree

    places = np.linspace(0, len(alike[0]) - 1, COMPARED).astype(int)
    some = np.array([[each.depth[places], each.load[places]] for each in alike])
    some /= np.maximum(ROUNDED * np.ptp(some, axis=(0, 2)), np.finfo(float).tiny)[:, None]
    pairs = cKDTree(some.reshape(len(alike), -1)).query_pairs(1.0, p=np.inf)
    found = set[int]()
    for number, first in sorted((max(pair), min(pair)) for pair in pairs):
        channels = ((getattr(alike[k], key) for k in (number, first)) for key in ("depth", "load", "time"))
        if number not in found and all(_agree_as_written(*pair) for pair in channels):
            found.add(number)
            yield alike[number], alike[first]


def _agree_as_written(values: np.ndarray, others: np.ndarray) -> bool:
    """Return whether two channels (n,) differ by no more than the rounding of either explains."""
    span, apart = float(np.ptp(values)), float(np.abs(values - others).max())
    if apart > ROUNDED * span:
        return False
    return apart <= 0.5 * max(last_digit(values), last_digit(others)) + 1e-9 * span


def last_digit(values: np.ndarray) -> float:
    """Return the largest power of ten of which all of some values (n,) are multiples; zero where none is."""
    for step in 10.0 ** np.arange(6, -13, -1):
        counts = values / step
        if (np.abs(counts - np.round(counts)) <= 1e-6 + 1e-15 * np.abs(counts)).all():
            return float(step)
    return 0.0
