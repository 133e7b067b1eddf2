"""Hysitron/Bruker TriboScan text exports: depth, load and time, and the sensors' volts where they were exported.

The instrument's drift and frame corrections are in the depth, but not written. Where the volts are, they follow from
them, because the sensor is linear: depth = a + b volts - compliance * load - drift * time, exactly but for rounding.
"""

from __future__ import annotations

import re

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.text import table
from palpate.readers.vendor import Corrections, Reader, VendorTest, contact, corrected, recording_from

COUNT = re.compile(r"Number of Points\s*=\s*(\d+)")
COLUMNS = ("Depth (nm)", "Load (µN)", "Time (s)")
VOLTS = "Depth (V)"
EXACT = 0.05


def matches(source: Source) -> bool:
    """Return whether the file announces its number of points and then its columns, depth first."""
    return b"Number of Points" in source.content[:1000] and b"Depth (nm)" in source.content[:2000]


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one test; time is counted from the last point without load before it is loaded."""
    start = next((k for k, line in enumerate(source.lines) if line.startswith(COLUMNS[0])), None)
    announced = next((int(found[1]) for line in source.lines[:20] if (found := COUNT.match(line))), 0)
    names = source.lines[start].split("\t") if start is not None else []
    if start is None or any(name not in names for name in COLUMNS):
        raise InputError(f"lacks one of the columns {', '.join(COLUMNS)}", remedy="export them", file=source.path)
    values = table(source.lines[start + 1 :], start + 2, len(names), source.path)
    if len(values) != announced:
        raise InputError(
            f"holds {len(values)} points, {announced} were announced; the file is cut off",
            remedy="copy or export it again",
            file=source.path,
        )
    depth, load, time = (values[:, names.index(name)] for name in COLUMNS)
    load = load / 1e3
    begin = contact(load)
    metadata = {"date": source.lines[0].strip()}
    if corrections is not None:
        if VOLTS not in names:
            raise InputError(
                "without the column Depth (V) the corrections cannot be taken off",
                remedy="export the volts, or leave --raw and --correct off",
                file=source.path,
            )
        drift, compliance = applied(depth, values[:, names.index(VOLTS)], load, time, source)
        since, force = time - time[begin], load - load[begin]
        every = frozenset({"drift", "frame"})
        depth = 2 * depth - corrected(depth, since, force, drift=drift, compliance=compliance, corrections=every)
        depth = corrected(depth, since, force, drift=drift, compliance=compliance, corrections=corrections)
        metadata |= {"drift [nm/s]": f"{drift:.5g}", "frame compliance [nm/mN]": f"{compliance:.5g}"}
    recording = recording_from(source, "values", source.path.stem, time - time[begin], load, depth)
    return [VendorTest(source.path.stem, recording, metadata)]


def applied(
    depth: np.ndarray, volts: np.ndarray, load: np.ndarray, time: np.ndarray, source: Source
) -> tuple[float, float]:
    """Return the drift [nm/s] and compliance [nm/mN] that make a linear sensor's `volts` (n,) into `depth` (n,)."""
    terms = np.column_stack([np.ones_like(volts), volts, load, time])
    solution = np.linalg.lstsq(terms, depth, rcond=None)[0]
    misfit = float(np.sqrt(np.mean((terms @ solution - depth) ** 2)))
    if misfit > EXACT:
        raise InputError(
            f"depth does not follow from volts, load and time (they leave {misfit:.3g} nm)",
            remedy="leave --raw and --correct off",
            file=source.path,
        )
    return -float(solution[3]), -float(solution[2])


READER = Reader("hysitron_txt", "Hysitron TriboScan text", matches, read)
