"""KLA (InView, iNano, G200X) workbooks: time, load and depth of every test; contact is where the surface is marked."""

from __future__ import annotations

from palpate.readers.source import Source
from palpate.readers.vendor import Corrections, Reader, VendorTest, recording_from, refuse_corrections

CHANNELS = {"Time": "time", "Load": "load", "Depth": "depth"}


def matches(source: Source) -> bool:
    """Return whether a sheet ``Test ...`` has the columns Markers, Time, Load and Depth."""
    tests = [name for name in source.sheets if name.startswith("Test ")]
    rows = source.sheet(tests[0]) if tests else []
    return bool(rows) and {"Markers", *CHANNELS} <= {str(cell).strip() for cell in rows[0]}


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read all tests, in the order of the workbook."""
    refuse_corrections(source, corrections)
    tables = [source.by_test(name) for name in ("Pre-Test Inputs", "Post-Test Inputs", "Results")]
    tests = []
    for sheet in (name for name in source.sheets if name.startswith("Test ")):
        channels = source.columns(sheet, CHANNELS)
        time, load, depth = (channels[name] for name in CHANNELS)
        markers = [str(cell).strip() for cell in source.sheet(sheet)[0]].index("Markers")
        marked = [k for k, row in enumerate(source.sheet(sheet)[2:]) if str(row[markers]).startswith("Surface")]
        recording = recording_from(source, sheet, sheet, time - time[marked[0] if marked else 0], load, depth)
        number = sheet.removeprefix("Test ").strip()
        metadata = {key: value for table in tables for key, value in table.get(number, {}).items()}
        tests.append(VendorTest(sheet, recording, metadata))
    return tests


READER = Reader("kla", "KLA workbook", matches, read)
