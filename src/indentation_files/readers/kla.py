"""KLA (InView, iNano, G200X) workbooks: time, load and depth of every test; contact is where the surface is marked.

The names of the channels depend on the version and on what was exported: ``Depth``, ``DEPTH``, ``Displacement Into
Surface``. The channels ``Displacement`` and ``Force`` are raw and no substitutes.
"""

from __future__ import annotations

import numpy as np

from indentation_files.readers import sheets_of_tests as sheets
from indentation_files.readers.source import Source
from indentation_files.readers.units import unit_of
from indentation_files.readers.vendor import Reader, Unreadable, VendorTest, contact, usable, vendor_test

CHANNELS = {
    "time": ("time", "time on sample", "time in contact", "test time"),
    "load": ("load", "load on sample", "force on surface", "corrected load"),
    "depth": ("depth", "displacement into surface", "indentation depth", "penetration depth", "corrected depth"),
}
STIFFNESS = ("harmonic contact stiffness", "stiffness")
UNMARKED = "no marker gives the surface; contact is where the load shows it"


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has columns of time, load and depth, and markers or all their units."""
    for sheet in sheets.tests_of(source):
        names = sheets.names_of(source, sheet, CHANNELS)
        stated = (unit_of(key, sheets.stated_unit(source, sheet, name)) for key, name in names.items())
        if names and (sheets.first_of(sheets.headings_of(source, sheet), sheets.MARKERS) or all(stated)):
            return True
    return False


def read(source: Source) -> list[VendorTest | Unreadable]:
    """Read all tests, in the order of their numbers."""
    facts = sheets.facts_of(source, ("Pre-Test Inputs", "Post-Test Inputs", "Results"))
    return sheets.read_sheets(source, facts, CHANNELS, test_on_sheet)


def test_on_sheet(source: Source, sheet: str, metadata: dict[str, str]) -> VendorTest:
    """Return the test on a sheet, its depth zero at contact; where no marker gives that, the load does."""
    channels = [*sheets.values_of(source, sheet, CHANNELS).values()]
    kept, warnings = usable(sheet, *channels)
    time, load, depth = (values[kept] for values in channels)
    marker = sheets.surface(source, sheet)
    if marker is not None and marker <= kept[-1]:
        begin, marked = int(np.searchsorted(kept, marker)), True
    else:
        begin, marked, warnings = contact(load, depth), False, (*warnings, UNMARKED)
    named = sheets.first_of(sheets.headings_of(source, sheet), STIFFNESS)
    stiffness = 1e-6 * sheets.channel(source, sheet, named, "stiffness")[kept] if named else None
    if stiffness is not None and not np.isfinite(stiffness).any():
        stiffness = None
    facts = metadata | sheets.evaluated(source, sheet, kept, load)
    channels = [time - time[begin], load, depth - depth[begin]]
    return vendor_test(source, sheet, channels, facts, warnings, marked=marked, stiffness=stiffness)


READER = Reader("kla", "KLA workbook", matches, read)
