"""MTS/Agilent/Keysight XP and G200 workbooks (TestWorks): raw and corrected channels of every test.

The vendor's formulas, with everything counted from the surface marker (where ``Time On Sample`` is zero)::

    depth = displacement - drift * time - raw load / frame stiffness
    load  = raw load - support spring * displacement

The stiffness by the oscillation has the frame taken off in "Harmonic Contact Stiffness", and not in "Harmonic
Stiffness".
"""

from __future__ import annotations

import itertools

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.numbers_in_text import number
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.vendor import (
    Corrections,
    Reader,
    Unreadable,
    VendorTest,
    attempt,
    unless_all_fail,
    usable,
)
from palpate.recordings.recording import Recording

DEPTH, LOAD, TIME = "Displacement Into Surface", "Load On Sample", "Time On Sample"
CHANNELS = {TIME: "time", LOAD: "load", DEPTH: "depth"}
RAW = {TIME: "time", LOAD: "load", "Raw Displacement": "depth", "Raw Load": "load"}
ALSO = {LOAD: "Force On Surface", TIME: "Time in Contact"}  # by the method of the test
DRIFT, FRAME = "Drift Correction [nm/s]", "Frame Stiffness"
STIFFNESS = {True: "Harmonic Contact Stiffness", False: "Harmonic Stiffness"}


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has the XP's names of channels."""
    choices = [(name, ALSO.get(name, name)) for name in CHANNELS]
    return any(source.has_test_with(set(spelt)) for spelt in itertools.product(*choices))


def read(source: Source, corrections: Corrections) -> list[VendorTest | Unreadable]:
    """Read all tests, in the order of their numbers, from the approach to the end of the drift hold."""
    results, inputs = source.by_test("Results"), source.by_test("Required Inputs")
    facts = {sheet: inputs.get(number, {}) | results.get(number, {}) for sheet, number in source.tests.items()}
    return unless_all_fail(
        [attempt(source.path, sheet, _test, source, sheet, facts[sheet], corrections) for sheet in facts]
    )


def _test(source: Source, sheet: str, metadata: dict[str, str], corrections: Corrections) -> VendorTest:
    """Return the test on a sheet, its depth as the vendor gives it or with the corrections chosen."""
    named = {str(cell).strip() for row in source.sheet(sheet)[:1] for cell in row}
    wanted = CHANNELS if corrections is None else RAW
    spelt = {name if name in named else ALSO.get(name, name): unit for name, unit in wanted.items()}
    channels = source.columns(sheet, spelt)
    kept, warnings = usable(source, sheet, *channels.values())
    time, load, depth, *force = (values[kept] for values in channels.values())
    if time[-1] < 0:
        raise InputError("the indenter never touched the sample", remedy="remove the test")
    surface = int(np.argmax(time >= 0))
    measured = STIFFNESS[corrections is None or "frame" in corrections]
    extra = {
        name: source.columns(sheet, {name: "stiffness"})[name][kept] for name in (FRAME, measured) if name in named
    }
    if FRAME in extra:
        metadata = metadata | {f"{FRAME} [N/m]": f"{extra[FRAME][surface]:g}"}
    if corrections is not None:
        raw = force[0] - force[0][surface]
        depth = depth - depth[surface]
        if "drift" in corrections:
            depth = depth - _drift(metadata.get(DRIFT)) * time
        if "frame" in corrections:
            depth = depth - raw * _compliance(float(extra[FRAME][surface]) if FRAME in extra else 0.0)
    stiffness = 1e-6 * extra[measured] if measured in extra else None
    recording = Recording(time, load, depth, sheet, (f"from {source.path.name}",), stiffness)
    return VendorTest(sheet, recording, metadata, warnings)


def _drift(text: str | None) -> float:
    """Return the drift that the workbook states [nm/s]."""
    try:
        value = np.nan if text is None else number(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        problem = f"the sheet Results gives no {DRIFT}" if text is None else f"{DRIFT} is {text!r}, no number"
        raise InputError(problem, remedy="leave drift off")
    return value


def _compliance(stiffness: float) -> float:
    """Return the compliance [nm/mN] of a frame of this stiffness [N/m]."""
    if not stiffness > 0:
        raise InputError(f"{FRAME} is {stiffness:g} N/m, expected more than zero", remedy="leave frame off")
    return 1e6 / stiffness


READER = Reader("agilent_xp", "MTS/Agilent XP workbook", matches, read)
