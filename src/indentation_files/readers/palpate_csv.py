"""The project's own recording CSV."""

from __future__ import annotations

from indentation_files.readers.source import Source
from indentation_files.readers.vendor import Reader, VendorTest
from indentation_files.recording import HEADER, WITH_STIFFNESS
from indentation_files.recording_file import recording_in, with_stiffness_beside


def matches(source: Source) -> bool:
    """Return whether the first line that is no comment is the recording's header."""
    body = (line.strip() for line in source.lines if line.strip() and not line.startswith("#"))
    return next(body, "") in (HEADER, WITH_STIFFNESS)


def read(source: Source) -> list[VendorTest]:
    """Read the recording, and its stiffness if that lies beside; there is nothing to leave off in it."""
    recording = with_stiffness_beside(recording_in(source.lines.one_by_one(), source.path), source.path)
    return [VendorTest(recording.name, recording)]


READER = Reader("palpate_csv", "palpate recording", matches, read)
