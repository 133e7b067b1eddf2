"""MTS/Agilent/Keysight XP and G200 workbooks (TestWorks): raw and corrected channels of every test.

The vendor's formulas, with everything counted from the surface marker (where ``Time On Sample`` is zero)::

    depth = displacement - drift * time - raw load / frame stiffness
    load  = raw load - support spring * displacement

The stiffness by the oscillation has the frame taken off in "Harmonic Contact Stiffness", and not in "Harmonic
Stiffness".
"""

from __future__ import annotations

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.vendor import Corrections, Reader, VendorTest, corrected, recording_from

DEPTH, LOAD, TIME = "Displacement Into Surface", "Load On Sample", "Time On Sample"
CHANNELS = {DEPTH: "depth", LOAD: "load", TIME: "time"}
RAW_DEPTH, RAW_LOAD, FRAME = "Raw Displacement", "Raw Load", "Frame Stiffness"
RAW = {RAW_DEPTH: "depth", RAW_LOAD: "load", FRAME: "stiffness"}
DRIFT = "Drift Correction [nm/s]"
STIFFNESS = {True: "Harmonic Contact Stiffness", False: "Harmonic Stiffness"}


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has the XP's names of channels."""
    tests = [name for name in source.sheets if name.startswith("Test ")]
    rows = source.sheet(tests[0]) if tests else []
    return bool(rows) and set(CHANNELS) <= {str(cell).strip() for cell in rows[0]}


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read all tests, in the order of their numbers, from the approach to the end of the drift hold."""
    results, inputs = source.by_test("Results"), source.by_test("Required Inputs")
    tests = []
    for sheet in sorted(name for name in source.sheets if name.startswith("Test ")):
        number = sheet.removeprefix("Test ").lstrip("0")
        metadata = inputs.get(number, {}) | results.get(number, {})
        channels = source.columns(sheet, CHANNELS)
        time, load, depth = channels[TIME], channels[LOAD], channels[DEPTH]
        on_sample = np.flatnonzero(time >= 0)
        if not len(on_sample):
            raise InputError(
                "the indenter never touched the sample", remedy="remove the test", file=source.path, place=sheet
            )
        surface = on_sample[0]
        if FRAME in map(str, source.sheet(sheet)[0]):
            frame = source.columns(sheet, {FRAME: "stiffness"})[FRAME][surface]
            metadata = metadata | {"Frame Stiffness [N/m]": f"{frame:g}"}
        if corrections is not None:
            raw = source.columns(sheet, RAW)
            displacement, force = (raw[key] - raw[key][surface] for key in (RAW_DEPTH, RAW_LOAD))
            if "drift" in corrections and DRIFT not in metadata:
                raise InputError("the sheet Results gives no drift", remedy="leave drift off", file=source.path)
            depth = corrected(
                displacement, time, force,
                drift=float(metadata.get(DRIFT, "nan")),
                compliance=1e6 / raw[FRAME][surface],
                corrections=corrections,
            )  # fmt: skip
        measured = STIFFNESS[corrections is None or "frame" in corrections]
        stiffness = None
        if measured in map(str, source.sheet(sheet)[0]):
            stiffness = 1e-6 * source.columns(sheet, {measured: "stiffness"})[measured]
        recording = recording_from(source, sheet, sheet, time, load, depth, stiffness)
        tests.append(VendorTest(sheet, recording, metadata))
    return tests


READER = Reader("agilent_xp", "MTS/Agilent XP workbook", matches, read)
