"""Vendors' files: every module of this folder that defines ``READER`` is found by itself; files are told by content."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.discovery import discover
from palpate.errors import InputError
from palpate.readers.columns import ColumnMap, read_columns
from palpate.readers.source import Source
from palpate.readers.vendor import CORRECTIONS, Corrections, Reader, VendorTest, refuse_corrections
from palpate.readers.zero import zeroed

READERS: dict[str, Reader] = {reader.key: reader for reader in discover(__name__, __path__, "READER")}

__all__ = [
    "CORRECTIONS",
    "READERS",
    "ColumnMap",
    "Reader",
    "VendorTest",
    "locate",
    "read_source",
    "read_vendor_file",
    "select",
    "zeroed",
]


def read_vendor_file(
    path: str | Path,
    sha256: str | None = None,
    corrections: Corrections = None,
    contact: str | float = "file",
    columns: ColumnMap | None = None,
) -> list[VendorTest]:
    """Read all tests of a vendor's file.

    Parameters
    ----------
    sha256
        Expected checksum; not checked when None.
    corrections
        Those to be in the depth: None for the vendor's own, otherwise a set of ``drift`` and ``frame``.
    contact
        Where the tests begin: see `palpate.readers.zero.zeroed`.
    columns
        Where a table of no known format holds time, load and depth; the file is then read by it alone.

    Raises
    ------
    InputError
        When the file is missing, of no known format, cut off, or not the one expected.
    """
    path = Path(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", remedy="check the path", file=path) from error
    if sha256 is not None and hashlib.sha256(content).hexdigest() != sha256:
        raise InputError("is not the file that the study names (sha256 differs)", remedy="fetch it again", file=path)
    if not content.strip():
        raise InputError("is empty", remedy="export or copy it again", file=path)
    source = Source(path, content)
    try:
        return [zeroed(_printable(test), contact) for test in _whole(source, corrections, columns)]
    except InputError as error:
        raise error.located(file=path) from None


def locate(named: str, data: str | None) -> str:
    """Return the vendor's file: `data`, or what lies below the folder `data` under the name that a study gives."""
    if data is None or not Path(data).is_dir():
        return data or named
    found = sorted(Path(data).rglob(Path(named).name))
    return str(found[0]) if found else str(Path(data) / Path(named).name)


def read_source(source: Mapping[str, Any]) -> dict[str, list[VendorTest]]:
    """Read the tests of each condition from a study's section ``source``; raises `InputError` when one is missing."""
    if "units" in source and "columns" not in source:
        raise InputError(
            "units are given without columns", remedy="add columns, or leave units off", place="source.units"
        )
    columns = ColumnMap(source["columns"], source.get("units", {})) if "columns" in source else None
    chosen = frozenset(source["corrections"]) if "corrections" in source else None
    tests = read_vendor_file(source["file"], source.get("sha256"), chosen, source.get("contact", "file"), columns)
    if "condition" in source:
        return {source["condition"]: tests}
    return {
        condition: [select(tests, str(name), source["file"], f"source.conditions.{condition}") for name in names]
        for condition, names in source["conditions"].items()
    }


def _whole(source: Source, corrections: Corrections, columns: ColumnMap | None) -> list[VendorTest]:
    """Return all tests with their approach, by the map of columns or by the reader that knows the content."""
    if columns is not None:
        refuse_corrections(source, corrections)
        return read_columns(source, columns)
    for reader in READERS.values():
        if reader.matches(source):
            return reader.read(source, corrections)
    first = next((line.strip() for line in source.lines if line.strip()), "") if source.workbook is None else ""
    begins = f"; its first line is {first[:60]!r}" if first.isprintable() and first else ""
    raise InputError(
        f"is of no format that palpate knows{begins}",
        remedy="name the columns of its table (--columns time=...,load=...,depth=...); "
        "`palpate read --formats` lists formats and units",
        file=source.path,
    )


def _printable(test: VendorTest) -> VendorTest:
    """Return a test with bytes of its file's name that are no letters written as numbers, so that it can be printed."""
    name, *notes = (text.encode(errors="backslashreplace").decode() for text in (test.name, *test.recording.notes))
    return replace(test, name=name, recording=replace(test.recording, name=name, notes=tuple(notes)))


def select(tests: list[VendorTest], wanted: str, path: str | Path, place: str = "--test") -> VendorTest:
    """Return the test called `wanted`, or the one of that number, counted from 1."""
    for test in tests:
        if test.name == wanted:
            return test
    if wanted.isdecimal() and 1 <= int(wanted) <= len(tests):
        return tests[int(wanted) - 1]
    names = ", ".join(test.name for test in tests)
    raise InputError(f"has no test {wanted!r}", remedy=f"use a number or one of: {names}", file=path, place=place)
