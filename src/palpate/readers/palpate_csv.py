"""The project's own recording CSV."""

from __future__ import annotations

from palpate.readers.source import Source
from palpate.readers.vendor import Corrections, Reader, VendorTest, refuse_corrections
from palpate.recording import HEADER, read_recording


def matches(source: Source) -> bool:
    """Return whether the first line that is no comment is the recording's header."""
    lines = source.content[:8192].lstrip(b"\xef\xbb\xbf").splitlines()
    body = [line.strip() for line in lines if line.strip() and not line.startswith(b"#")]
    return bool(body) and body[0] == HEADER.encode()


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the recording; there is nothing to leave off in it."""
    refuse_corrections(source, corrections)
    recording = read_recording(source.path)
    return [VendorTest(recording.name, recording)]


READER = Reader("palpate_csv", "palpate recording", matches, read)
