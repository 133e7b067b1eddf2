"""Anton Paar (CSM) indentation exports ``.TXT``: one test with a header of settings and results."""

from __future__ import annotations

import re

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.text import table
from palpate.readers.vendor import Corrections, Reader, VendorTest, refuse_corrections, usable
from palpate.recording import Recording

COLUMNS = "Time (s)\tPd (nm)\tFn (mN)"


def matches(source: Source) -> bool:
    """Return whether the file begins with the word Indentation."""
    return source.first.startswith("Indentation")


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test of the file; depth and load are the vendor's, from contact on."""
    refuse_corrections(source, corrections)
    lines, path = source.lines, source.path
    starts = [k for k, line in enumerate(lines) if line.startswith(COLUMNS)]
    if not starts:
        raise InputError(f"lacks its column line {COLUMNS!r}", remedy="export the test again, with data", file=path)
    start = starts[0]
    values = table(lines[start + 1 :], start + 2, len(lines[start].split("\t")), path)
    time, depth, load = values[:, :3].T
    kept, warnings = usable(source, "measured values", time, load, depth)
    recording = Recording(time[kept], load[kept], depth[kept], path.stem, (f"from {path.name}",))
    return [VendorTest(path.stem, recording, metadata(lines[:start]), warnings)]


def metadata(lines: list[str]) -> dict[str, str]:
    """Return the header's entries ``name : value`` and ``name= value`` as text."""
    entries = {}
    for line in lines:
        found = re.match(r"\s*([^:=]+?)\s*[:=]\s*(.*\S)", line)
        if found:
            entries[found[1]] = " ".join(found[2].split())
    return entries


READER = Reader("anton_paar", "Anton Paar indentation export", matches, read)
