"""What a reader of an instrument's files gives back, and what it must declare."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate.recording import Recording


@dataclass(frozen=True)
class VendorTest:
    """One test from a vendor's file.

    Parameters
    ----------
    name
        The test's name in the file, or its number.
    recording
        Time from contact [s], load [mN], depth [nm].
    metadata
        Whatever the file says of instrument, tip, method and results, by the vendor's names.
    """

    name: str
    recording: Recording
    metadata: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Reader:
    """A file format.

    Parameters
    ----------
    key, title
        Short name, and name for people.
    matches
        Whether the first bytes of a file are this format's.
    read
        Reads all tests; `raw` leaves the vendor's corrections off, and raises `InputError` where the file does not hold
        what that needs.
    """

    key: str
    title: str
    matches: Callable[[bytes], bool]
    read: Callable[[Path, bool], list[VendorTest]]
