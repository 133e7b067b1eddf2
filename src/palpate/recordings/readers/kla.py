"""KLA (InView, iNano, G200X) workbooks: time, load and depth of every test; contact is where the surface is marked."""

from __future__ import annotations

import numpy as np

from palpate.recordings.readers.source import Source
from palpate.recordings.readers.vendor import (
    Corrections,
    Reader,
    Unreadable,
    VendorTest,
    attempt,
    contact,
    refuse_corrections,
    unless_all_fail,
    usable,
)
from palpate.recordings.recording import Recording

CHANNELS = {"Time": "time", "Load": "load", "Depth": "depth"}
MARKERS = "Markers"
UNMARKED = "no marker says where the surface is; the test begins where the load does (--contact auto finds the touch)"


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has the columns Markers, Time, Load and Depth."""
    return source.has_test_with({MARKERS, *CHANNELS})


def read(source: Source, corrections: Corrections) -> list[VendorTest | Unreadable]:
    """Read all tests, in the order of their numbers."""
    refuse_corrections(source, corrections)
    tables = [source.by_test(name) for name in ("Pre-Test Inputs", "Post-Test Inputs", "Results")]
    facts = {
        sheet: {key: value for table in tables for key, value in table.get(number, {}).items()}
        for sheet, number in source.tests.items()
    }
    return unless_all_fail([attempt(source.path, sheet, _test, source, sheet, facts[sheet]) for sheet in facts])


def _test(source: Source, sheet: str, metadata: dict[str, str]) -> VendorTest:
    """Return the test on a sheet; where no marker tells its contact, the load does."""
    channels = source.columns(sheet, CHANNELS)
    kept, warnings = usable(source, sheet, *channels.values())
    time, load, depth = (channels[name][kept] for name in CHANNELS)
    rows = source.sheet(sheet)
    markers = [str(cell).strip() for cell in rows[0]].index(MARKERS)
    surface = [k for k, row in enumerate(rows[2:]) if str(row[markers]).strip().lower().startswith("surface")]
    if surface and surface[0] <= kept[-1]:
        begin = int(np.searchsorted(kept, surface[0]))
    else:
        begin, warnings = contact(load, depth), (*warnings, UNMARKED)
    recording = Recording(time - time[begin], load, depth, sheet, (f"from {source.path.name}",))
    return VendorTest(sheet, recording, metadata, warnings)


READER = Reader("kla", "KLA workbook", matches, read)
