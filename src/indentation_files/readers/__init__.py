"""Vendors' files: modules of this folder that define ``READER`` are found; formats are detected from the content."""

from __future__ import annotations

import glob
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from indentation_files.discovery import discover
from indentation_files.errors import InputError, located_in, part_of
from indentation_files.readers.column_map import ColumnMap, by_headings
from indentation_files.readers.columns import holds_columns, missing_channel, read_columns
from indentation_files.readers.left_out import nothing_found
from indentation_files.readers.source import Source, numbers_of
from indentation_files.readers.tables import tables_of
from indentation_files.readers.tagged import averages, no_less_hidden, not_shown, remarked, selected, set_aside
from indentation_files.readers.units import CHANNELS, mended
from indentation_files.readers.unknown import no_table, unknown
from indentation_files.readers.vendor import (
    CORRECTIONS,
    Corrections,
    Reader,
    Unreadable,
    VendorTest,
    all_sound,
    messages,
    raise_if_unreadable,
    refuse_corrections,
    unless_all_fail,
)
from indentation_files.readers.zero import Contact, zeroed_each
from indentation_files.recording_file import errors_of_reading
from indentation_files.regular_file import refuse_special
from indentation_files.sentences import PLACES

LARGEST = 1 << 29  # bytes of a file; the columns of a text take about as much memory
READERS: dict[str, Reader] = {reader.key: reader for reader in discover(__name__, __path__, "READER")}

__all__ = [
    "CORRECTIONS",
    "READERS",
    "ColumnMap",
    "Reader",
    "Unreadable",
    "VendorTest",
    "locate",
    "messages",
    "read_each",
    "read_source",
    "read_vendor_file",
    "select",
    "zeroed_each",
]


def read_vendor_file(
    path: str | Path,
    sha256: str | None = None,
    corrections: Corrections = None,
    contact: Contact = "file",
    columns: ColumnMap | None = None,
) -> list[VendorTest]:
    """Read all tests of a vendor's file.

    Parameters
    ----------
    path
        The file.
    sha256
        Expected checksum; not checked when None.
    corrections
        Those to be in the depth: None for the vendor's own, otherwise a set of ``drift`` and ``frame``.
    contact
        Where the tests begin: see `indentation_files.readers.zero.zeroed` and `zeroed_each`.
    columns
        Where a table holds time, load and depth; a file of a known format that lacks these columns is read as such.

    Raises
    ------
    InputError
        When the file is missing, of no known format, cut off, or not the one expected, or one of its tests cannot be
        read.
    """
    return all_sound(read_each(path, sha256, corrections, contact, columns))


def read_each(
    path: str | Path,
    sha256: str | None = None,
    corrections: Corrections = None,
    contact: Contact = "file",
    columns: ColumnMap | None = None,
    *,
    columns_required: bool = False,
) -> list[VendorTest | Unreadable]:
    """Read all tests of a vendor's file as `read_vendor_file` does, and say what is wrong with those that cannot be.

    The arguments `path`, `sha256`, `corrections`, `contact` and `columns` are as there. `columns_required` refuses a
    file of a known format that lacks the columns: they are meant for this very file. Raises `InputError` when no test
    can be read.
    """
    path = Path(path)
    refuse_special(path)
    with located_in(path), errors_of_reading(path):
        if path.stat().st_size > LARGEST:
            raise InputError(f"is larger than {LARGEST >> 20} MB", remedy="export fewer tests at once")
        with path.open("rb") as stream:
            if sha256 is not None and hashlib.file_digest(stream, "sha256").hexdigest() != sha256:
                raise InputError("is not the file that the study names (sha256 differs)", remedy="fetch it again")
            source = Source(path, stream)
            if all(block.isspace() for block in source.blocks()):
                raise InputError("is empty", remedy="export or copy it again")
            with no_less_hidden(source):
                tests = [_printable(test) for test in _whole(source, corrections, columns, columns_required)]
                aside = [set_aside(source, test) for test in zeroed_each(path, averages(tests), contact)]
                return [*unless_all_fail(remarked(source, aside)), *not_shown(source)]


def locate(named: str, data: str | None) -> str:
    """Return the vendor's file: `data`, or what lies below the folder `data` under the path that a study gives.

    Where nothing lies under the whole path, the name alone counts. Raises `InputError` when several files below the
    folder answer to the path or to the name.
    """
    if data is None or not named or not Path(data).is_dir():
        return data or named
    path = Path(named)
    of_name = sorted(Path(data).rglob(glob.escape(path.name)))
    found = [file for file in of_name if file.parts[-len(path.parts) :] == path.parts] or of_name
    if Path(data) / path in found:
        return str(Path(data) / path)
    if len(found) > 1:
        problem = f"{named} may be {' or '.join(str(file) for file in found[:PLACES])}"
        raise InputError(problem, remedy="give its path below the folder of data", place="source.file")
    return str(found[0] if found else Path(data) / path.name)


def read_source(source: Mapping[str, Any]) -> dict[str, list[VendorTest]]:
    """Read the tests of each condition from a study's section ``source``.

    Raises `InputError` when a test is missing, cannot be read or is named twice, or the file lacks the columns given.
    """
    with part_of("source"):
        columns = ColumnMap.stated(source.get("columns"), source.get("units"))
    chosen = frozenset(source["corrections"]) if "corrections" in source else None
    contact = source.get("contact", "file")
    tests = read_each(source["file"], source.get("sha256"), chosen, contact, columns, columns_required=True)
    if "condition" in source:
        return {source["condition"]: all_sound(tests)}
    found: dict[str, list[VendorTest]] = {}
    owners: dict[str, str] = {}
    for condition, names in source["conditions"].items():
        found[condition] = []
        for name in names:
            place = f"source.conditions.{condition}"
            test = select(tests, str(name), source["file"], place)
            if test.name in owners:
                problem = f"{name} is test {test.name!r}, which counts in {owners[test.name]} already"
                raise InputError(problem, remedy="name each test once", place=place)
            owners[test.name] = condition
            found[condition].append(test)
    return found


def _whole(
    source: Source, corrections: Corrections, columns: ColumnMap | None, columns_required: bool
) -> Sequence[VendorTest | Unreadable]:
    """Return all tests with their approach, by the map of columns or by the reader that knows the content."""
    reader = next((reader for reader in READERS.values() if reader.matches(source)), None)
    if columns is not None and not no_table(source) and (reader is None or holds_columns(source, columns)):
        refuse_corrections(corrections)
        return read_columns(source, columns)
    if reader is not None:
        if columns is not None and columns_required:
            if not no_table(source):
                raise nothing_found(tables_of(source), columns).located(place="source.columns")
            problem = f"the file holds no table, and is read as {reader.title}"
            raise InputError(problem, remedy="leave columns and units off", place="source.columns")
        message = () if columns is None else (f"lacks the columns named, and is read as {reader.title}",)
        if not reader.corrects:
            refuse_corrections(corrections)
        tests = reader.read(source, corrections) if reader.corrects else reader.read(source)
        return [_with(message, test) for test in tests]
    named = None if no_table(source) else by_headings(tables_of(source))
    if named is not None:
        refuse_corrections(corrections)
        shown = ", ".join(f"{key} from {name!r}" for key, name in named.names.items())
        return [_with((f"read by its headings: {shown}",), test) for test in read_columns(source, named)]
    missing = None if no_table(source) else missing_channel(source)
    if missing:
        others = " and ".join(key for key in CHANNELS if key != missing)
        remedy = f"name that column (--columns time=...,load=...,depth=...), or export the {missing} too"
        raise InputError(f"its table names {others}, but no column that palpate knows as {missing}", remedy=remedy)
    raise unknown(source)


def _with(messages: tuple[str, ...], test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test with messages before its own."""
    return test if isinstance(test, Unreadable) else replace(test, warnings=(*messages, *test.warnings))


def _printable(test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test that can be printed: bytes of its file's name that are no letters are written as numbers.

    What the file says of it is mended where it was read in another encoding than it was written in.
    """
    if isinstance(test, Unreadable):
        return test
    name, *notes = (text.encode(errors="backslashreplace").decode() for text in (test.name, *test.recording.notes))
    recording = replace(test.recording, name=name, notes=tuple(notes))
    facts = {mended(key): mended(value) for key, value in test.metadata.items()}
    return replace(test, name=name, recording=recording, metadata=facts)


def select(
    tests: Sequence[VendorTest | Unreadable], wanted: str, path: str | Path, place: str = "--test"
) -> VendorTest:
    """Return the test called `wanted`, or the one of that number: its own as in ``Test 010``, or counted from 1.

    `tests` are those of the file `path`, and `place` is where the choice was made, for messages. Raises `InputError`
    when there is none, or it cannot be read.
    """
    named = {test.name: test for test in tests}
    numbered = dict(zip(numbers_of([test.name for test in tests]), tests, strict=True))
    found = named.get(wanted) or (numbered.get(int(wanted)) if wanted.isdecimal() else None)
    if found is not None:
        return raise_if_unreadable(selected(found))
    names = ", ".join(named)
    raise InputError(f"has no test {wanted!r}", remedy=f"use a number or one of: {names}", file=path, place=place)
