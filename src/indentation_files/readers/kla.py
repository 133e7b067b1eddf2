"""KLA (InView, iNano, G200X) workbooks: time, load and depth of every test; contact is where the surface is marked.

The names of the channels depend on the version and on what was exported: ``Depth``, ``DEPTH``, ``Displacement Into
Surface``. The channels ``Displacement`` and ``Force`` are raw and no substitutes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from indentation_files.readers.sheets_of_tests import (
    MARKERS,
    channel,
    evaluated,
    facts_of,
    first_of,
    headings_of,
    read_sheets,
    stated_unit,
    surface,
    tests_of,
)
from indentation_files.readers.source import Source
from indentation_files.readers.units import unit_of
from indentation_files.readers.vendor import (
    Corrections,
    Reader,
    Unreadable,
    VendorTest,
    contact,
    refuse_corrections,
    usable,
)
from indentation_files.recording import Recording

CHANNELS = {
    "time": ("time", "time on sample", "time in contact", "test time"),
    "load": ("load", "load on sample", "force on surface", "corrected load"),
    "depth": ("depth", "displacement into surface", "indentation depth", "penetration depth", "corrected depth"),
}
STIFFNESS = ("harmonic contact stiffness", "stiffness")
UNMARKED = "no marker gives the surface; contact is where the load shows it"


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has columns of time, load and depth, and markers or all their units."""
    for sheet in tests_of(source):
        names = _names(source, sheet)
        if names and (first_of(headings_of(source, sheet), MARKERS) or all(_units(source, sheet, names))):
            return True
    return False


def _units(source: Source, sheet: str, names: Mapping[str, str]) -> list[str | None]:
    """Return the units that a sheet states for its channels; None for what is none."""
    return [unit_of(key, stated_unit(source, sheet, name)) for key, name in names.items()]


def _names(source: Source, sheet: str) -> dict[str, str]:
    """Return what a sheet calls its channels; empty where it lacks one."""
    headings = headings_of(source, sheet)
    found = {key: first_of(headings, spellings) for key, spellings in CHANNELS.items()}
    return {key: name for key, name in found.items() if name} if all(found.values()) else {}


def read(source: Source, corrections: Corrections) -> list[VendorTest | Unreadable]:
    """Read all tests, in the order of their numbers."""
    refuse_corrections(source, corrections)
    facts = facts_of(source, ("Pre-Test Inputs", "Post-Test Inputs", "Results"))
    return read_sheets(source, facts, _names, test_on_sheet)


def test_on_sheet(source: Source, sheet: str, metadata: dict[str, str]) -> VendorTest:
    """Return the test on a sheet, its depth zero at contact; where no marker gives that, the load does."""
    names = _names(source, sheet) or {key: spellings[0] for key, spellings in CHANNELS.items()}
    channels = [channel(source, sheet, names[key], key) for key in CHANNELS]
    kept, warnings = usable(source, sheet, *channels)
    time, load, depth = (values[kept] for values in channels)
    marker = surface(source, sheet)
    if marker is not None and marker <= kept[-1]:
        begin, marked = int(np.searchsorted(kept, marker)), True
    else:
        begin, marked, warnings = contact(load, depth), False, (*warnings, UNMARKED)
    named = first_of(headings_of(source, sheet), STIFFNESS)
    stiffness = 1e-6 * channel(source, sheet, named, "stiffness")[kept] if named else None
    if stiffness is not None and not np.isfinite(stiffness).any():
        stiffness = None
    notes = (f"from {source.path.name}",)
    recording = Recording(time - time[begin], load, depth - depth[begin], sheet, notes, stiffness)
    return VendorTest(sheet, recording, metadata | evaluated(source, sheet, kept, load), warnings, marked)


READER = Reader("kla", "KLA workbook", matches, read)
