"""Vendors' files: every module of this folder that defines ``READER`` is found by itself; files are told by content."""

from __future__ import annotations

import hashlib
from pathlib import Path

from palpate.discovery import discover
from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.vendor import CORRECTIONS, Corrections, Reader, VendorTest

READERS: dict[str, Reader] = {reader.key: reader for reader in discover(__name__, __path__, "READER")}

__all__ = ["CORRECTIONS", "READERS", "Reader", "VendorTest", "read_vendor_file", "select"]


def read_vendor_file(path: str | Path, sha256: str | None = None, corrections: Corrections = None) -> list[VendorTest]:
    """Read all tests of a vendor's file.

    Parameters
    ----------
    sha256
        Expected checksum; not checked when None.
    corrections
        Those to be in the depth: None for the vendor's own, otherwise a set of ``drift`` and ``frame``.

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
    source = Source(path, content)
    for reader in READERS.values():
        if reader.matches(source):
            return reader.read(source, corrections)
    known = "; ".join(reader.title for reader in READERS.values())
    raise InputError("is of no format that palpate knows", remedy=f"give one of: {known}", file=path)


def select(tests: list[VendorTest], wanted: str, path: str | Path) -> VendorTest:
    """Return the test called `wanted`, or the one of that number, counted from 1."""
    for test in tests:
        if test.name == wanted:
            return test
    if wanted.isdigit() and 1 <= int(wanted) <= len(tests):
        return tests[int(wanted) - 1]
    names = ", ".join(test.name for test in tests)
    raise InputError(f"has no test {wanted!r}", remedy=f"use a number or one of: {names}", file=path, place="--test")
