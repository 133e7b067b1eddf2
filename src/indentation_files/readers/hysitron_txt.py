"""Hysitron/Bruker TriboScan text exports: depth, load and time, and the sensors' volts where they were exported.

The instrument's drift and frame corrections are in the depth, but not written. Where the volts are, they follow from
them, because the sensor is linear: depth = a + b volts - compliance * load - drift * time, exactly but for rounding.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.numbers_in_text import column, counted, refuse_unlike, require_tabs
from indentation_files.readers.source import Source
from indentation_files.readers.units import CHANNELS, SCALES, unit_of
from indentation_files.readers.vendor import Corrections, Reader, VendorTest, contact, usable, vendor_test

COUNT = re.compile(r"Number of Points\s*[=:](.*)")
HEADING = re.compile(r"\s*(Time|Load|Depth)\s*\((.+)\)\s*")
DEPTH = re.compile(r"\bDepth *\((?!V)")
VOLTS = "volts"
SENSOR = re.compile(r"\s*(Depth|Disp\. Voltage)\s*\(V\)\s*")
EXACT = 0.05
HEAD = 20


def matches(source: Source) -> bool:
    """Return whether the file announces its number of points and then its columns, whatever is between these."""
    head = source.lines[:HEAD]
    return any(COUNT.match(line) for line in head) and any(DEPTH.search(line) for line in head)


def columns(line: str) -> dict[str, tuple[int, float]]:
    """Return the place and the scale of each channel, and of the depth in volts, that a line of headings names."""
    found: dict[str, tuple[int, float]] = {}
    for index, cell in enumerate(line.split("\t")):
        heading = HEADING.fullmatch(cell)
        if heading:
            key = heading[1].lower()
            if unit := unit_of(key, heading[2]):
                found.setdefault(key, (index, SCALES[key][unit]))
        if SENSOR.fullmatch(cell):
            found[VOLTS] = (index, 1.0)
    return found


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test; time is counted from the last point without load before it is loaded."""
    start = next(k for k, line in source.lines.in_words() if DEPTH.search(line))
    require_tabs(source.lines[start])
    places = columns(source.lines[start])
    if not {*CHANNELS} <= {*places}:
        raise InputError("lacks one of the columns Depth (nm), Load (µN), Time (s)", remedy="export them")
    if corrections is not None and VOLTS not in places:
        problem = "without the column Depth (V) or Disp. Voltage(V) the corrections cannot be taken off"
        raise InputError(problem, remedy="export the volts, or leave --raw and --correct off")
    announced = next(found[1] for line in source.lines[:HEAD] if (found := COUNT.match(line)))
    width = len(source.lines[start].rstrip().split("\t"))
    values = counted(source.lines[start + 1 :], width, announced)
    refuse_unlike(source.lines[start], columns, values)
    needed = [*CHANNELS] if corrections is None else [*CHANNELS, VOLTS]
    channels = [column(values, *places[key]) for key in needed]
    kept, warnings = usable("values", *channels)
    time, load, depth, *volts = (channel[kept] for channel in channels)
    begin = contact(load, depth)
    metadata = {"date": source.lines[0].strip()}
    if corrections is not None:
        drift, compliance, misfit = applied(depth, volts, load, time)
        if misfit > EXACT:
            problem = f"depth does not follow from volts, load and time (they leave {misfit:.3g} nm)"
            raise InputError(problem, remedy="leave --raw and --correct off")
        if "drift" not in corrections:
            depth = depth + drift * (time - time[begin])
        if "frame" not in corrections:
            depth = depth + compliance * (load - load[begin])
        metadata |= {"drift [nm/s]": f"{drift:.5g}", "frame compliance [nm/mN]": f"{compliance:.5g}"}
    return [vendor_test(source, source.path.stem, (time - time[begin], load, depth), metadata, warnings)]


def applied(
    depth: np.ndarray, sensor: Sequence[np.ndarray], load: np.ndarray, time: np.ndarray
) -> tuple[float, float, float]:
    """Return the drift [nm/s] and compliance [nm/mN] taken off a `depth` (n,) [nm], and the misfit [nm] of that.

    What is left of the depth is constant, or follows linearly from the volts of a `sensor`, in one column or none.
    `load` and `time` (n,) are in mN and s.
    """
    terms = np.column_stack([np.ones_like(load), *sensor, load, time])
    solution = np.linalg.lstsq(terms, depth, rcond=None)[0]
    misfit = float(np.sqrt(np.mean((terms @ solution - depth) ** 2)))
    return -float(solution[-1]), -float(solution[-2]), misfit


READER = Reader("hysitron_txt", "Hysitron TriboScan text", matches, read, corrects=True)
