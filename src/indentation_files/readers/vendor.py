"""What a reader of an instrument's files gives back, and what it must declare."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.ndimage import median_filter

from indentation_files.channel_noise import noise_of
from indentation_files.contact_point import way_in
from indentation_files.errors import InputError
from indentation_files.readers.rising_time import increasing, stands_still
from indentation_files.readers.several_tests import padding, taken, whole, without_stand_ins, written_twice
from indentation_files.readers.source import Source
from indentation_files.recording import Recording, spaced
from indentation_files.sentences import and_more, first_few

CORRECTIONS = ("drift", "frame")
MOST_LEFT_OUT = 0.05
CORRECTED = "corrections in depth: "  # begins the note on these
NUMBER = re.compile(r"\d+(\.\d+)?(e[-+]?\d+)?")
Corrections = frozenset[str] | None
Found = TypeVar("Found")


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
    marked
        Whether the file says where contact is; time is zero at its first point else.
    uncounted
        Why the test is left out unless somebody names it; empty for all others.
    """

    name: str
    recording: Recording
    metadata: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    marked: bool = True
    uncounted: str = ""


@dataclass(frozen=True)
class Unreadable:
    """A test that cannot be read, which keeps nobody from the others of its file, and what is wrong with it.

    It is `sought` where it is known to be a test; a workbook's sheet with another table need not be one. A test that
    could be read, and is left out unless somebody names it, is kept as `uncounted`.
    """

    name: str
    error: InputError
    sought: bool = True
    uncounted: VendorTest | None = None


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
        Reads all tests, and says which it cannot; what it raises is given the file.
    corrects
        Whether the vendor's corrections can be chosen, so that `read` takes those to be in the depth too: None for the
        vendor's own, otherwise a set of ``drift`` and ``frame``; `InputError` where the file lacks what that needs.
    """

    key: str
    title: str
    matches: Callable[[Source], bool]
    read: Callable[..., Sequence[VendorTest | Unreadable]]
    corrects: bool = False


def read_or_report(path: Path, name: str, read: Callable[..., Found], *given: Any) -> Found | Unreadable:
    """Return what `read` makes of `given`, or what is wrong with the test of that name in the file at `path`."""
    try:
        return read(*given)
    except InputError as error:
        return Unreadable(name, error.located(file=path, place=name))


def unless_all_fail(tests: Sequence[VendorTest | Unreadable]) -> list[VendorTest | Unreadable]:
    """Return the tests as they are; raises the first one's `InputError` when none of them can be read."""
    if not tests:
        raise InputError("holds no test", remedy="export the tests again")
    if all(isinstance(test, Unreadable) for test in tests):
        raise_if_unreadable(tests[0])
    return list(tests)


def in_words(corrections: Iterable[str] | None) -> str:
    """Return which of the vendor's corrections are in a depth: chosen ones, or, where none were chosen, all."""
    return "those of the vendor" if corrections is None else ", ".join(sorted(corrections)) or "none"


def provenance(test: VendorTest, corrections: Corrections) -> tuple[str, ...]:
    """Return the comments with which a test that was read is written: where it comes from, and what was done to it.

    These are its notes, the corrections that its depth contains, by those that were asked for, its warnings, and what
    its file states. A recording that palpate has written states its corrections itself.
    """
    notes = test.recording.notes
    if not any(note.startswith(CORRECTED) for note in notes):
        notes = (*notes, CORRECTED + in_words(corrections))
    return (*notes, *test.warnings, *(f"{key}: {value}" for key, value in test.metadata.items()))


def raise_if_unreadable(test: VendorTest | Unreadable) -> VendorTest:
    """Return a test that can be read; raises what is wrong with another."""
    if isinstance(test, Unreadable):
        raise test.error
    return test


def all_sound(tests: Sequence[VendorTest | Unreadable]) -> list[VendorTest]:
    """Return the tests of a file, less uncounted ones; raises what is wrong with the first that cannot be read."""
    return [
        raise_if_unreadable(test)
        for test in tests
        if isinstance(test, VendorTest) or (test.sought and test.uncounted is None)
    ]


def messages(path: Path, tests: Sequence[VendorTest | Unreadable]) -> Iterator[str]:
    """Say what of a file is left out, and why, and what the readers warn of.

    Warnings of several tests that differ in their numbers alone are said once, with those of the first test; each
    recording states its own.
    """
    for test in tests:
        if isinstance(test, Unreadable):
            yield f"{test.error}; the {'test' if test.sought else 'sheet'} is left out"
    alike: dict[str, dict[str, str]] = {}
    for test in tests:
        for warning in () if isinstance(test, Unreadable) else test.warnings:
            alike.setdefault(NUMBER.sub("#", warning), {})[test.name] = warning
    for warnings in alike.values():
        name, warning = next(iter(warnings.items()))
        yield f"{path}, {name}{and_more(warnings)}: {warning}"


def refuse_corrections(corrections: Corrections) -> None:
    """Raise `InputError` when corrections are chosen on a file that holds nothing but the final channels."""
    if corrections is not None:
        problem = "this export holds the vendor's final channels only"
        raise InputError(problem, remedy="leave --raw and --correct off, or export raw data")


def vendor_test(
    source: Source,
    name: str,
    channels: Sequence[np.ndarray],
    facts: Mapping[str, Any],
    warnings: tuple[str, ...],
    *,
    marked: bool = False,
    stiffness: np.ndarray | None = None,
) -> VendorTest:
    """Return a `VendorTest` of the file `source` whose recording states that.

    The `channels` are time [s], load [mN] and depth [nm], each (n,); `facts`, `warnings` and `marked` are the test's
    metadata, warnings and mark, `name` and `stiffness` the recording's.
    """
    time, load, depth = channels
    recording = Recording(time, load, depth, name, (f"from {source.path.name}",), stiffness)
    return VendorTest(name, recording, facts, warnings, marked)


def contact(load: np.ndarray, depth: np.ndarray) -> int:
    """Return the index of the last point without load before the tip presses for the first time.

    Only the way in counts, from the farthest retreat on (`way_in`): what was pressed before it, such as a preload, is
    passed over. What the load reads without contact is its median over the later half of the points that do not stand
    out above its least. Where those rise by more than the noise, the file begins under load: then its own zero counts,
    or its least load where that never falls to zero.
    """
    first, last = way_in(load, depth)
    force = load[first : last + 1]
    noise = max(noise_of(force), 1e-6 * float(np.ptp(load)))
    smooth = median_filter(force, 5, mode="nearest")
    free = force[: int(np.flatnonzero(smooth <= smooth.min() + 6 * noise)[-1]) + 1]
    half = len(free) // 2
    level = float(np.median(free[half:]))
    if level - np.median(free[: half + 1]) > 2 * noise:
        level = max(0.0, float(free.min()))
    return first + int(np.flatnonzero(force <= level)[-1])


def unfinished(load: np.ndarray) -> tuple[str, ...]:
    """Return a warning where a test, its `load` (n,) [mN], ends under more than half of its largest load."""
    if load[-1] <= load.max() / 2:
        return ()
    return (f"ends under {load[-1]:.4g} of {load.max():.4g} mN, not unloaded; the file may be cut off",)


def usable(place: str, time: np.ndarray, *others: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the indices of the points that make a test, and in words which are left out.

    Points without a number before the first whole one and after the last are no damage: a channel may begin later or
    end earlier. Nor are repeated times (the last point of a segment is often written again as the first of the next),
    points written twice, and zeros at the end. Of very many points evenly spaced ones are kept (`spaced`).

    The channels that a test needs, `time` and `others`, each (n,), are NaN where the file holds no number. Raises
    `InputError`, for the `place` in the file, when more than a twentieth of the points between the first and the last
    whole one would have to go, or fewer than two are left.
    """
    channels = without_stand_ins([time, *others])
    zeros = padding(channels)
    idle = written_twice(channels) | zeros
    filled = whole(channels) & ~idle
    complete = np.flatnonzero(filled).astype(np.int32)
    if len(complete) < 2:
        problem = "holds fewer than two points with a number in every channel"
        raise InputError(problem, remedy="export the test again", place=place)
    between = ~idle
    between[: complete[0]] = between[complete[-1] + 1 :] = False
    clock = taken(time, filled)
    later = increasing(clock)
    still = stands_still(clock, later)
    kept, count = complete[later], int(between.sum())
    damaged = {"no number": np.flatnonzero(between & ~filled), "time goes back": complete[~later & ~still]}
    repeated = {"time stands still": complete[still]}
    if count - len(kept) > MOST_LEFT_OUT * count:
        problem = f"{_listed(damaged | repeated)}: {count - len(kept)} of {count} points cannot be used"
        raise InputError(problem, remedy="export the test again", place=place)
    lost = sum(map(len, damaged.values()))
    reported = [f"{lost} of {count} points left out: {_listed(damaged)}"] if lost else []
    reported += [f"{zeros.sum()} points of zeros at the end left out"] if zeros.any() else []
    kept, thinned = spaced(kept)
    return kept, (*reported, *thinned)


def _listed(causes: Mapping[str, np.ndarray]) -> str:
    """Return each cause with the numbers of the first few points that it strikes, counted from 1."""
    return ", ".join(f"{cause} (point {first_few(at + 1)})" for cause, at in causes.items() if len(at))
