"""MTS/Agilent/Keysight XP and G200 workbooks (TestWorks): raw and corrected channels of every test.

The vendor's formulas, with everything counted from the surface marker (where ``Time On Sample`` is zero)::

    depth = displacement - drift * time - raw load / frame stiffness
    load  = raw load - support spring * displacement

The stiffness by the oscillation has the frame taken off in "Harmonic Contact Stiffness", and not in "Harmonic
Stiffness".
"""

from __future__ import annotations

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers import sheets_of_tests as sheets
from indentation_files.readers.numbers_in_text import number
from indentation_files.readers.source import Source
from indentation_files.readers.vendor import Corrections, Reader, Unreadable, VendorTest, usable, vendor_test

CHANNELS = {
    "time": ("time on sample", "time in contact"),
    "load": ("load on sample", "force on surface"),
    "depth": ("displacement into surface",),
}
DRIFT, FRAME = "Drift Correction [nm/s]", "Frame Stiffness"
STIFFNESS = {True: "harmonic contact stiffness", False: "harmonic stiffness"}


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has the XP's names of channels."""
    return any(sheets.names_of(source, sheet, CHANNELS) for sheet in sheets.tests_of(source))


def read(source: Source, corrections: Corrections) -> list[VendorTest | Unreadable]:
    """Read all tests, in the order of their numbers, from the approach to the end of the drift hold."""
    facts = sheets.facts_of(source, ("Required Inputs", "Results"))
    return sheets.read_sheets(source, facts, CHANNELS, _test, corrections)


def _test(source: Source, sheet: str, metadata: dict[str, str], corrections: Corrections) -> VendorTest:
    """Return the test on a sheet, its depth as the vendor gives it or with the corrections chosen."""
    channels = sheets.values_of(source, sheet, CHANNELS)
    if corrections is not None:
        channels["depth"] = sheets.channel(source, sheet, "raw displacement", "depth")
        channels["raw"] = sheets.channel(source, sheet, "raw load", "load")
    kept, warnings = usable(sheet, *channels.values())
    time, load, depth, *force = (values[kept] for values in channels.values())
    if time[-1] < 0:
        raise InputError("the indenter never touched the sample", remedy="remove the test")
    begin, marker = int(np.argmax(time >= 0)), sheets.surface(source, sheet)
    marked = begin > 0
    if not marked and marker is not None and marker <= kept[-1]:
        begin, marked = int(np.searchsorted(kept, marker)), True
        time = time - time[begin]
    measured = STIFFNESS[corrections is None or "frame" in corrections]
    known = FRAME.casefold()
    wanted = [name for name in (known, measured) if name in sheets.headings_of(source, sheet)]
    extra = {name: sheets.channel(source, sheet, name, "stiffness")[kept] for name in wanted}
    frame = float(extra[known][begin]) if known in extra else 0.0
    if known in extra:
        metadata = metadata | {f"{FRAME} [N/m]": f"{frame:g}"}
    if corrections is not None:
        raw = force[0] - force[0][begin]
        depth = depth - depth[begin]
        if "drift" in corrections:
            depth = depth - _drift(metadata.get(DRIFT)) * time
        if "frame" in corrections:
            if not frame > 0:
                raise InputError(f"{FRAME} is {frame:g} N/m, expected more than zero", remedy="leave frame off")
            depth = depth - raw * (1e6 / frame)
    stiffness = 1e-6 * extra[measured] if measured in extra else None
    facts = metadata | sheets.evaluated(source, sheet, kept, load)
    return vendor_test(source, sheet, (time, load, depth), facts, warnings, marked=marked, stiffness=stiffness)


def _drift(text: str | None) -> float:
    """Return the drift that the workbook states [nm/s]."""
    value = number(text or "")
    if not np.isfinite(value):
        problem = f"the sheet Results gives no {DRIFT}" if text is None else f"{DRIFT} is {text!r}, no number"
        raise InputError(problem, remedy="leave drift off")
    return value


READER = Reader("agilent_xp", "MTS/Agilent XP workbook", matches, read, corrects=True)
