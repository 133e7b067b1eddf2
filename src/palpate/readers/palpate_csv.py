"""The project's own recording CSV."""

from __future__ import annotations

from pathlib import Path

from palpate.errors import InputError
from palpate.readers.vendor import Reader, VendorTest
from palpate.recording import HEADER, read_recording


def matches(head: bytes) -> bool:
    """Return whether the first line that is no comment is the recording's header."""
    lines = head.lstrip(b"\xef\xbb\xbf").splitlines()
    body = [line.strip() for line in lines if line.strip() and not line.startswith(b"#")]
    return bool(body) and body[0] == HEADER.encode()


def read(path: Path, raw: bool) -> list[VendorTest]:
    """Read the recording; there is nothing to leave off in it."""
    if raw:
        raise InputError("a recording CSV holds no vendor corrections", remedy="leave --raw off", file=path)
    recording = read_recording(path)
    return [VendorTest(recording.name, recording)]


READER = Reader("palpate_csv", "palpate recording", matches, read)
