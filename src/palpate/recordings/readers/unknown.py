"""What to say of a file that no reader knows: what it seems to be, and what its owner can do."""

from __future__ import annotations

import re

from palpate.errors import InputError
from palpate.recordings.readers.igor import may_be_wave
from palpate.recordings.readers.source import Source

LIST = "`palpate read --formats` lists formats and units"
BY_COLUMNS = "name the columns of its table (--columns time=...,load=...,depth=...); " + LIST
NANOSCOPE = re.compile(rb"[\\?]\*(force )?file list", re.IGNORECASE)


def of_nanoscope(source: Source) -> bool:
    """Return whether a file is one of NanoScope: a header of text, before binary channels, which a text has not."""
    return NANOSCOPE.match(source.content) is not None and b"\0" in source.content


def unknown(source: Source) -> InputError:
    """Return the error of a file of no known format: a container, a file of NanoScope or Igor, or another."""
    kind, remedy = source.container, f"unpack it, or export its tests as text; {LIST}"
    if of_nanoscope(source):
        kind = "a NanoScope file, which the library afmformats does not read either"
        remedy = "export the force curve as text with time, force and separation, by NanoScope Analysis"
    elif may_be_wave(source.content):
        kind = "an Igor wave that is cut off, or has no note on a cantilever"
        remedy = "copy it again, or export the force curve as text with time, force and separation"
    if kind:
        return InputError(f"is of no format that palpate knows: {kind}", remedy=remedy, file=source.path)
    first = " ".join(source.first.split())
    begins = f"; its first line is {first[:60]!r}" if first.isprintable() and first else ""
    return InputError(f"is of no format that palpate knows{begins}", remedy=BY_COLUMNS, file=source.path)
