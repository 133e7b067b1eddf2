"""Hysitron/Bruker TriboScan ``.hld``: settings, approach, drift hold and test in one file.

The depth in the file is the capacitive sensor's displacement, plus that of the load cell that carries the specimen,
less machine compliance * force and drift rate * time. (Rebuilt from the volts by the calibration polynomial in the
header this holds to 0.01 nm.) The vendor's zero of contact is written as shifts of displacement and force.
"""

from __future__ import annotations

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.numbers_in_text import counted, number, require_tabs
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.units import SCALES, plain
from palpate.recordings.readers.vendor import Corrections, Reader, VendorTest, contact, usable
from palpate.recordings.recording import Recording

COUNT = "Test Data Points"
COLUMNS = ("Time_s", "Disp_nm", "Force_uN", "LoadCell_nm")
NEEDED = ("Machine Comp", "Drift Rate", "Disp Shift", "Force Shift")
COMPLIANCE, RATE = (
    {f"{a}/{b}": SCALES["depth"][a] / SCALES[over][b] for a in SCALES["depth"] for b in SCALES[over]}
    for over in ("load", "time")
)
UNITS = dict(zip(NEEDED, (COMPLIANCE, RATE, SCALES["depth"], SCALES["load"]), strict=True))


def matches(source: Source) -> bool:
    """Return whether the file begins with the version of a Hysitron file."""
    return source.first.startswith("File Version: Hysitron")


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test; time is counted from the last point without load before it is loaded.

    ``frame`` stands for all that yields behind the specimen: machine compliance and load cell.
    """
    start = next((k for k, line in enumerate(source.lines) if line.startswith(COUNT)), None)
    entries = dict(line.split(":", 1) for line in source.lines[:start] if ":" in line)
    if start is None or any(key not in entries for key in NEEDED):
        raise InputError(f"lacks {COUNT} or one of {', '.join(NEEDED)}", remedy="copy it again", file=source.path)
    for headings in source.lines[start + 1 : start + 2]:
        require_tabs(headings, source.path)
    names = [plain(name) for line in source.lines[start + 1 : start + 2] for name in line.split("\t")]
    if any(name not in names for name in COLUMNS):
        raise InputError(f"lacks one of the columns {', '.join(COLUMNS)}", remedy="copy it again", file=source.path)
    announced = source.lines[start].partition(":")[2]
    values = counted(source.lines[start + 2 :], start + 3, len(names), source.path, announced)
    columns = [values[:, names.index(name)] for name in COLUMNS]
    kept, warnings = usable(source, "test data", *columns)
    time, depth, force, cell = (column[kept] for column in columns)
    depth = depth - _entry(source, entries, "Disp Shift")
    load = force / 1e3 - _entry(source, entries, "Force Shift")
    begin = contact(load, depth)
    if corrections is not None and "drift" not in corrections:
        depth = depth + _entry(source, entries, "Drift Rate") * (time - time[begin])
    if corrections is not None and "frame" not in corrections:
        depth = depth + _entry(source, entries, "Machine Comp") * (load - load[begin]) - (cell - cell[begin])
    name = source.path.stem
    recording = Recording(time - time[begin], load, depth, name, (f"from {source.path.name}",))
    return [VendorTest(name, recording, {key.strip(): value.strip() for key, value in entries.items()}, warnings)]


def _entry(source: Source, entries: dict[str, str], key: str) -> float:
    """Return a number of the header in nm, mN, nm/s or nm/mN, whatever its decimal sign and its unit."""
    text = entries[key].strip()
    size, _, unit = text.partition(" ")
    try:
        value = number(size) * UNITS[key].get(plain(unit), np.nan)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(
            f"is {text!r}, expected a number and its unit, such as 0.1 {next(iter(UNITS[key]))}",
            remedy="correct the entry, or copy the file again",
            file=source.path,
            place=key,
        )
    return float(value)


READER = Reader("hysitron_hld", "Hysitron TriboScan .hld", matches, read)
