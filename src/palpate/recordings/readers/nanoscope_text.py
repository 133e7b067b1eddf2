"""Force curves that NanoScope Analysis exports as text: the columns of extension and retraction side by side.

A heading names channel, unit and direction: ``Defl_pN_Ex``, ``Height_Sensor_nm_Rt``, ``Time_s_Ex``. The separation is
the way of the piezo less the cantilever's deflection; either is counted along the way in::

    depth = separation, or height - deflection
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.afm import BY_PIEZO
from palpate.recordings.readers.numbers_in_text import table
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.units import scale, unit_of
from palpate.recordings.readers.vendor import Corrections, Reader, VendorTest, refuse_corrections, usable
from palpate.recordings.recording import Recording

HEADING = re.compile(r"(\w+?)_(?:(Ex|Rt)_([^\W_]+)|([^\W_]+)_(Ex|Rt))")
DIRECTIONS = ("Ex", "Rt")  # extension, retraction
TIME, DEFLECTION, SEPARATION = "Time", "Defl", "Separation"
HEIGHTS = ("Height_Sensor", "Calc_Ramp")
WITH_UNIT = {"Tip Radius": "Tip Radius [nm]"}
HALF = 0.5  # of the load's rise within a segment: one that is beyond it is turned at, not away from the surface
Columns = dict[tuple[str, str, str], int]


def matches(source: Source) -> bool:
    """Return whether a line names the deflection while the tip approaches."""
    return _header(source) is not None


def _header(source: Source) -> int | None:
    """Return the line of headings; None where there is none."""
    named = ((k, line) for k, line in source.lines.in_words() if DEFLECTION in line)
    return next((k for k, line in named if (DEFLECTION, DIRECTIONS[0]) in {key[::2] for key in _columns(line)}), None)


def _columns(line: str) -> Columns:
    """Return the place of each channel, unit and direction; the first of those that the program writes twice."""
    found: Columns = {}
    for place, heading in enumerate(map(HEADING.fullmatch, map(str.strip, line.split("\t")))):
        if heading:
            found.setdefault((heading[1], heading[3] or heading[4], heading[2] or heading[5]), place)
    return found


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read the one curve, with its approach; contact is not marked."""
    refuse_corrections(source, corrections)
    start = _header(source) or 0
    columns = _columns(source.lines[start])
    width = len(source.lines[start].rstrip().split("\t"))
    values = table(source.lines[start + 1 :], start + 2, width, source.path)
    present = {key[::2] for key in columns}
    segments = [_segment(source, columns, values, way) for way in DIRECTIONS if (DEFLECTION, way) in present]
    time, load, height, bent = ([segment[k] for segment in segments] for k in range(4))
    if len(segments) > 1:
        _check_turn(*load)
        if time[1][0] <= time[0][-1]:  # a clock that the retraction begins anew goes on
            time[1] = time[1] - time[1][0] + 2 * time[0][-1] - time[0][-2]
    inward = np.sign(height[0][-1] - height[0][0])
    since, pressed, way = np.concatenate(time), np.concatenate(load), np.concatenate(height)
    kept, warnings = usable(source, "measured values", since, pressed, way)
    depth = (inward * way - np.concatenate(bent))[kept]
    if not any(key[0] in (SEPARATION, HEIGHTS[0]) for key in columns):
        warnings = (*warnings, BY_PIEZO)
    name, notes = source.path.stem, (f"from {source.path.name}",)
    recording = Recording(since[kept] - since[kept][0], pressed[kept], depth - depth[0], name, notes)
    return [VendorTest(name, recording, _facts(source.lines[:start]), warnings, marked=False)]


def _segment(source: Source, columns: Columns, values: np.ndarray, way: str) -> tuple[np.ndarray, ...]:
    """Return, in the order of time, time [s], load [mN], separation or height, and what bends beside it [nm]."""
    time, load, height = (
        _channel(columns, values, way, quantity, names)
        for quantity, names in (("time", [TIME]), ("load", [DEFLECTION]), ("depth", [SEPARATION]))
    )
    bent = None if height is None else np.zeros(len(height))
    if height is None:
        height, bent = (_channel(columns, values, way, "depth", names) for names in (HEIGHTS, [DEFLECTION]))
    if time is None or load is None or height is None or bent is None:
        needed = {f"{TIME}_s_{way}": time, f"{DEFLECTION}_pN_{way}": load}
        missing = [name for name, found in needed.items() if found is None]
        missing += [f"{SEPARATION}_nm_{way}"] if height is None or bent is None else []
        raise InputError(
            f"its force curve lacks {', '.join(missing)}",
            remedy="export it with time, force and separation, or with height and deflection in nm for the latter",
            file=source.path,
        )
    whole = np.flatnonzero(np.isfinite(time + load + height + bent))
    if len(whole) < 2:
        raise InputError("holds no measured values", remedy="export the force curve again", file=source.path)
    order = whole[np.argsort(time[whole], kind="stable")]
    return time[order], load[order], height[order], bent[order]


def _channel(columns: Columns, values: np.ndarray, way: str, quantity: str, names: Sequence[str]) -> np.ndarray | None:
    """Return the first of the channels of these names in a unit of a quantity, in s, mN or nm; None without one."""
    for name in names:
        for (channel, unit, direction), place in columns.items():
            if channel == name and direction == way and unit_of(quantity, unit):
                return values[:, place] * scale(quantity, unit)
    return None


def _check_turn(extended: np.ndarray, retracted: np.ndarray) -> None:
    """Raise `InputError` unless the extension ends and the retraction begins under load."""
    for name, far, near, largest in (
        ("extension does not end", extended[0], extended[-1], extended.max()),
        ("retraction does not begin", retracted[-1], retracted[0], retracted.max()),
    ):
        if near < far + HALF * (largest - far):
            raise InputError(
                f"the {name} under load: its rows and its times run against each other",
                remedy="export the force curve again, or the extension alone",
            )


def _facts(lines: Sequence[str]) -> dict[str, str]:
    r"""Return the header's entries, ``\name: value``, the first of each name; the radius of the tip is in nm."""
    entries: dict[str, str] = {}
    for line in lines:
        name, _, value = line.strip('"').lstrip("\\@").partition(": ")
        if name and value.strip():
            entries.setdefault(WITH_UNIT.get(name.strip(), name.strip()), value.strip())
    return entries


READER = Reader("nanoscope_text", "NanoScope force curve as text", matches, read)
