"""Hysitron/Bruker TriboScan ``.hld``: settings, approach, drift hold and test in one file.

The depth in the file is the capacitive sensor's displacement, plus that of the load cell that carries the specimen,
less machine compliance * force and drift rate * time. (Rebuilt from the volts by the calibration polynomial in the
header this holds to 0.01 nm.) The vendor's zero of contact is written as shifts of displacement and force.
"""

from __future__ import annotations

import re

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.text import table
from palpate.readers.vendor import Corrections, Reader, VendorTest, contact, recording_from

COUNT = "Test Data Points"
COLUMNS = ("Time_s", "Disp_nm", "Force_µN", "LoadCell_nm")
NEEDED = ("Machine Comp", "Drift Rate", "Disp Shift", "Force Shift")


def matches(source: Source) -> bool:
    """Return whether the file begins with the version of a Hysitron file."""
    return source.content[:200].startswith(b"File Version: Hysitron")


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test; time is counted from the last point without load before it is loaded.

    ``frame`` stands for all that yields behind the specimen: machine compliance and load cell.
    """
    start = next((k for k, line in enumerate(source.lines) if line.startswith(COUNT)), None)
    entries = dict(line.split(":", 1) for line in source.lines[:start] if ":" in line)
    if start is None or any(key not in entries for key in NEEDED):
        raise InputError(f"lacks {COUNT} or one of {', '.join(NEEDED)}", remedy="copy it again", file=source.path)
    names = source.lines[start + 1].split("\t")
    if any(name not in names for name in COLUMNS):
        raise InputError(f"lacks one of the columns {', '.join(COLUMNS)}", remedy="copy it again", file=source.path)
    announced = int(source.lines[start].split(":")[1])
    values = table(source.lines[start + 2 :], start + 3, len(names), source.path)
    if len(values) != announced:
        raise InputError(
            f"holds {len(values)} points, {announced} were announced; the file is cut off",
            remedy="copy it again",
            file=source.path,
        )
    time, depth, force, cell = (values[:, names.index(name)] for name in COLUMNS)
    compliance, drift, depth_shift, force_shift = (_number(entries[key]) for key in NEEDED)
    depth, load = depth - depth_shift, (force - force_shift) / 1e3
    begin = contact(load)
    if corrections is not None and "drift" not in corrections:
        depth = depth + drift * (time - time[begin])
    if corrections is not None and "frame" not in corrections:
        depth = depth + 1e3 * compliance * (load - load[begin]) - (cell - cell[begin])
    name = source.path.stem
    recording = recording_from(source, "test data", name, time - time[begin], load, depth)
    return [VendorTest(name, recording, {key.strip(): value.strip() for key, value in entries.items()})]


def _number(text: str) -> float:
    found = re.match(r"\s*([-+0-9.eE]+)", text)
    return float(found[1]) if found else float(np.nan)


READER = Reader("hysitron_hld", "Hysitron TriboScan .hld", matches, read)
