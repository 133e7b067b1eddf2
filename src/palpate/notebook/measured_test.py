"""One test from a file of any instrument: the recording and the file's metadata."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

from indentation_files.readers import (
    CORRECTIONS,
    ColumnMap,
    Unreadable,
    VendorTest,
    messages,
    raise_if_unreadable,
    read_each,
    select,
    zeroed_each,
)
from indentation_files.readers.vendor import in_words
from indentation_files.segments import Segment, segments
from palpate.errors import InputError, located_in
from palpate.output.figures.recorded_test import by_segment
from palpate.output.shown import ShownCurve


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredTest(ShownCurve):
    """A test that was read from a file.

    Parameters
    ----------
    file
        Where it was read.
    source
        What the reader found: name, recording, metadata and warnings.
    corrections
        Which of the vendor's corrections are in the depth; None for those that the vendor's program applied.
    remarks
        Problems of other tests of the file.
    """

    file: Path
    source: VendorTest
    corrections: frozenset[str] | None = None
    remarks: tuple[str, ...] = ()

    name = property(lambda self: self.source.name, doc="Name of the test in its file, or its number.")
    recording = property(lambda self: self.source.recording, doc="The recording from contact on.")
    metadata = property(lambda self: self.source.metadata, doc="What the file states, by the vendor's names.")

    @property
    def segments(self) -> list[Segment]:
        """Loading, hold, unloading and so on, in the order of time; empty where they cannot be found."""
        with suppress(InputError):
            return segments(self.time, self.load)
        return []

    def sentences(self) -> list[str]:
        """Return extent, segments, corrections, and whatever was noted in reading."""
        parts = [f"{part.kind.replace('_', ' ')} {part.start:.4g} to {part.end:.4g} s" for part in self.segments]
        return [
            self.extent(),
            "; ".join(parts) or "its segments are not found",
            f"corrections in depth: {in_words(self.corrections)}",
            f"the file states {len(self.metadata)} facts about instrument, tip and sample (metadata)",
            *self.recording.notes,
            *self.source.warnings,
            *self.remarks,
        ]

    def draw(self, ax: Axes) -> None:
        """Draw the load over the depth, one colour a segment."""
        by_segment(ax, self.depth, self.load, self.segments)
        ax.set_title(f"{self.file.name}, {self.name}")

    def __repr__(self) -> str:
        return f"<MeasuredTest {self.name!r} of {self.file.name}>"


def read_recording(
    path: str | Path,
    test: str | int | None = None,
    *,
    contact: str | float = "file",
    corrections: Iterable[str] | None = None,
    columns: Mapping[str, str | int] | None = None,
    units: Mapping[str, str] | None = None,
) -> MeasuredTest:
    """Read one test from a recording CSV, or from the file of any instrument that ``palpate read`` knows.

    Parameters
    ----------
    path
        The file; its format is detected from its content.
    test
        Name of the test in its file, or its number: its own as in ``Test 010``, or counted from 1. Needed only where
        the file holds several; `read_recordings` returns all of them.
    contact
        Where the test begins: ``file``, at the file's own contact; ``auto``, at the first touch found in the curve;
        ``none``, with its approach; or a depth [nm].
    corrections
        Which of the vendor's corrections, ``drift`` and ``frame``, are applied to the depth: an empty list for none,
        None for those that the vendor's program applied.
    columns
        Name or number, counted from 1, of the columns ``time``, ``load`` and ``depth`` of a table of no known format.
    units
        Of these columns, where the table does not state them, such as ``{"load": "uN"}``; ``-uN`` changes the sign.

    Returns
    -------
    MeasuredTest

    Raises
    ------
    InputError
        When the file cannot be read, holds several tests and none is chosen, or has no such test.
    """
    tests, chosen = _read(path, contact, corrections, columns, units)
    if test is None and len([each for each in tests if isinstance(each, VendorTest) or each.sought]) > 1:
        names = ", ".join(f"{each.name!r}" for each in tests)
        remedy = "choose one by name or number, test=1, or read all with read_recordings"
        raise InputError(f"holds {len(tests)} tests: {names}", remedy=remedy, file=path)
    one = raise_if_unreadable(tests[0]) if test is None else select(tests, str(test), Path(path), "test")
    return MeasuredTest(Path(path), one, chosen)


def read_recordings(path: str | Path, **reading: Any) -> list[MeasuredTest]:
    """Read all tests of a file that can be read; the remarks of the first list the problems of the others.

    Arguments are those of `read_recording`; raises `InputError` when no test can be read.
    """
    tests, chosen = _read(path, **reading)
    lost = tuple(messages(Path(path), [test for test in tests if isinstance(test, Unreadable)]))
    readable = [test for test in tests if isinstance(test, VendorTest)]
    return [MeasuredTest(Path(path), test, chosen, () if number else lost) for number, test in enumerate(readable)]


def _read(
    path: object, contact: str | float = "file", corrections: object = None, columns: Any = None, units: Any = None
) -> tuple[Sequence[VendorTest | Unreadable], frozenset[str] | None]:
    """Return the tests of a file, each from contact on, and which corrections are in the depth."""
    if not isinstance(path, str | PathLike):
        raise InputError(f"{type(path).__name__} is no path", remedy="give the path of a file", place="path")
    chosen, file = _corrections(corrections), Path(path)
    with located_in(file):
        whole = read_each(file, None, chosen, "none", ColumnMap.stated(columns, units))
        return zeroed_each(file, whole, contact), chosen


def _corrections(given: object) -> frozenset[str] | None:
    """Return the corrections that are named, one or several; raises `InputError` when one is not known."""
    if given is None:
        return None
    names = list(given) if isinstance(given, Iterable) and not isinstance(given, str) else [given]
    if not all(name in CORRECTIONS for name in names):
        remedy = f"name some of: {', '.join(CORRECTIONS)}; an empty list for none"
        raise InputError(f"corrections are {', '.join(map(str, names))}", remedy=remedy, place="corrections")
    return frozenset(map(str, names))
