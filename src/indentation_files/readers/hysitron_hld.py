"""Hysitron/Bruker TriboScan ``.hld``: settings, approach, drift hold and test in one file.

The depth in the file is the capacitive sensor's displacement, plus that of the load cell that carries the specimen,
less machine compliance * force and drift rate * time. (Rebuilt from the volts by the calibration polynomial in the
header this holds to 0.01 nm.)

Older files state compliance and rate, and the vendor's zero of contact as shifts of displacement and force. Newer ones
(without a ``File Version``) state neither and mark no contact, but hold the sensor's own displacement, from which
compliance and rate follow, exactly but for rounding::

    displacement = a + sensor + load cell - compliance * force - rate * time
"""

from __future__ import annotations

import re

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.hysitron_txt import EXACT, applied
from indentation_files.readers.numbers_in_text import counted, number, require_tabs
from indentation_files.readers.source import Source
from indentation_files.readers.units import SCALES, plain, unit_of
from indentation_files.readers.vendor import Corrections, Reader, VendorTest, contact, usable, vendor_test

COUNT = "Test Data Points"
VERSION = "File Version: Hysitron"
COLUMNS = {"Time": "time", "Disp": "depth", "Force": "load", "LoadCell": "depth"}
CELL, SENSOR = "LoadCell", "PiezoDisp"
HEADING = re.compile(r"\s*(\w+)_([^\W_]+)\s*")
NEEDED = ("Machine Comp", "Drift Rate", "Disp Shift", "Force Shift")
COMPLIANCE, RATE = (
    {f"{a}/{b}": SCALES["depth"][a] / SCALES[over][b] for a in SCALES["depth"] for b in SCALES[over]}
    for over in ("load", "time")
)
UNITS = dict(zip(NEEDED, (COMPLIANCE, RATE, SCALES["depth"], SCALES["load"]), strict=True))
LEVEL = 10  # points before contact that give the load without it
UNMARKED = "the file marks no contact; contact is where the load shows it"


def matches(source: Source) -> bool:
    """Return whether the file begins with a Hysitron version, or announces points and Hysitron's columns."""
    if source.first.startswith(VERSION):
        return True
    start = _announced(source)
    return start is not None and {"Time", "Disp", "Force"} <= _places(source, start).keys()


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test; time is counted from the last point without load before it is loaded.

    ``frame`` is everything compliant behind the specimen: machine compliance and load cell.
    """
    start, versioned = _announced(source), source.first.startswith(VERSION)
    entries = dict(line.split(":", 1) for line in source.lines[:start] if ":" in line)
    if start is None or (versioned and any(key not in entries for key in NEEDED)):
        raise InputError(f"lacks {COUNT} or one of {', '.join(NEEDED)}", remedy="copy it again")
    for headings in source.lines[start + 1 : start + 2]:
        require_tabs(headings)
    places = _places(source, start)
    missing = [name for name in COLUMNS if name not in places and (name != CELL or versioned)]
    if missing:
        raise InputError(f"lacks the column {', '.join(missing)}", remedy="copy it again")
    width = len(source.lines[start + 1].split("\t"))
    announced = source.lines[start].partition(":")[2]
    values = counted(source.lines[start + 2 :], width, announced)
    places.setdefault(CELL, (0, 0.0))  # a specimen that rests on none
    wanted = [*COLUMNS, *([SENSOR] if SENSOR in places else [])]
    columns = [values[:, index] * factor for index, factor in (places[name] for name in wanted)]
    kept, warnings = usable("test data", *columns)
    time, depth, load, cell, *sensor = (column[kept] for column in columns)
    begin, zero, free = contact(load, depth), 0.0, 0.0
    if versioned:
        zero, free = _entry(entries, "Disp Shift"), _entry(entries, "Force Shift")
        begin = contact(load - free, depth - zero)
    else:
        zero, free = float(depth[begin]), float(np.median(load[max(begin - LEVEL, 0) : begin + 1]))
        warnings = (*warnings, UNMARKED)
    facts = {key.strip(): value.strip() for key, value in entries.items()}
    since, pressed, yielded = time - time[begin], load - load[begin], cell - cell[begin]
    if corrections is not None and not versioned:
        target = depth - cell - sensor[0] if sensor else depth - cell
        rate, compliance, misfit = applied(target, [], load, time)
        if not sensor or misfit > EXACT:
            problem = "states neither compliance nor drift rate, and its sensor's displacement does not give them"
            raise InputError(problem, remedy="leave --raw and --correct off")
        facts |= {"drift [nm/s]": f"{rate:.5g}", "frame compliance [nm/mN]": f"{compliance:.5g}"}
    if corrections is not None and "drift" not in corrections:
        depth = depth + (_entry(entries, "Drift Rate") if versioned else rate) * since
    if corrections is not None and "frame" not in corrections:
        depth = depth + (_entry(entries, "Machine Comp") if versioned else compliance) * pressed - yielded
    channels = since, load - free, depth - zero
    return [vendor_test(source, source.path.stem, channels, facts, warnings, marked=versioned)]


def _announced(source: Source) -> int | None:
    """Return the line that announces how many points follow; None where none does."""
    return next((k for k, line in source.lines.in_words() if line.startswith(COUNT)), None)


def _places(source: Source, start: int) -> dict[str, tuple[int, float]]:
    """Return the place and the scale to s, mN or nm of each channel that the line below `start` names."""
    found: dict[str, tuple[int, float]] = {}
    for line in source.lines[start + 1 : start + 2]:
        for index, cell in enumerate(line.split("\t")):
            heading = HEADING.fullmatch(plain(cell))
            key = (COLUMNS | {SENSOR: "depth"}).get(heading[1]) if heading else None
            if heading and key and (unit := unit_of(key, heading[2])):
                found.setdefault(heading[1], (index, SCALES[key][unit]))
    return found


def _entry(entries: dict[str, str], key: str) -> float:
    """Return a number of the header in nm, mN, nm/s or nm/mN, whatever its decimal sign and its unit."""
    text = entries[key].strip()
    size, _, unit = text.partition(" ")
    value = number(size) * UNITS[key].get(plain(unit), np.nan)
    if not np.isfinite(value):
        problem = f"is {text!r}, expected a number and its unit, such as 0.1 {next(iter(UNITS[key]))}"
        raise InputError(problem, remedy="correct the entry, or copy the file again", place=key)
    return value


READER = Reader("hysitron_hld", "Hysitron TriboScan .hld", matches, read, corrects=True)
