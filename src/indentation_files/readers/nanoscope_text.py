"""Force curves that NanoScope Analysis exports as text: the columns of extension and retraction side by side.

A heading names channel, unit and direction: ``Defl_pN_Ex``, ``Height_Sensor_nm_Rt``, ``Time_s_Ex``. The separation is
the way of the piezo less the cantilever's deflection; either is counted along the way in::

    depth = separation, or height - deflection

Without a column of times the rows are spread evenly by the scan rate that the header states: its period is one
extension and one retraction. Two public headers confirm it, with ramps of 3000.0 and 2000.0 nm = speed / (2 rate).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.afm import BY_PIEZO
from indentation_files.readers.numbers_in_text import column, table
from indentation_files.readers.source import Source
from indentation_files.readers.units import scale, unit_of
from indentation_files.readers.vendor import Reader, VendorTest, usable, vendor_test

HEADING = re.compile(r"(\w+?)_(?:(Ex|Rt)_([^\W_]+)|([^\W_]+)_(Ex|Rt))")
DIRECTIONS = ("Ex", "Rt")  # extension, retraction
TIME, DEFLECTION, SEPARATION = "Time", "Defl", "Separation"
HEIGHTS = ("Height_Sensor", "Calc_Ramp")
WITH_UNIT = {"Tip Radius": "Tip Radius [nm]"}
FORCE_LIST, RATE, SAMPLES = "*Ciao force list", "Scan rate", "Samps/line"
SPEEDS = {"Ex": "Forward vel.", "Rt": "Reverse vel."}  # both in one unit
NUMBER = re.compile(r"\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
REMEDY = "export it with time, force and separation, or with height and deflection in nm for the latter"
SPREAD = (
    "the file holds no time: the rows of each direction are spread evenly, by the scan rate in the header; a pause "
    "between extension and retraction is not in it"
)
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


def read(source: Source) -> list[VendorTest]:
    """Read the one curve, with its approach; contact is not marked."""
    start = _header(source) or 0
    columns = _columns(source.lines[start])
    untimed = None if any(key[0] == TIME for key in columns) else source.lines[:start]
    since, pressed, depth = _joined(source, start, columns, untimed)
    kept, warnings = usable("measured values", since, pressed, depth)
    if not any(key[0] in (SEPARATION, HEIGHTS[0]) for key in columns):
        warnings = (*warnings, BY_PIEZO)
    if untimed is not None:
        warnings = (*warnings, SPREAD)
    first = kept[0]
    channels = since[kept] - since[first], pressed[kept], depth[kept] - depth[first]
    return [vendor_test(source, source.path.stem, channels, _facts(source.lines[:start]), warnings)]


def _joined(source: Source, start: int, columns: Columns, untimed: Sequence[str] | None) -> list[np.ndarray]:
    """Return time [s], load [mN] and depth [nm] below the line of headings, of one direction after the other."""
    values = table(source.lines[start + 1 :], len(source.lines[start].rstrip().split("\t")))
    ways = [way for way in DIRECTIONS if (DEFLECTION, way) in {key[::2] for key in columns}]
    time, load, height, bent = zip(*(_segment(columns, values, way, untimed) for way in ways), strict=True)
    if len(ways) > 1:
        _check_turn(*load)
        if time[1][0] <= time[0][-1]:  # a clock that the retraction begins anew goes on
            time = (time[0], time[1] - time[1][0] + 2 * time[0][-1] - time[0][-2])
    return [np.concatenate(parts) for parts in (time, load, _depths(height, bent))]


def _segment(columns: Columns, values: np.ndarray, way: str, untimed: Sequence[str] | None) -> tuple[np.ndarray, ...]:
    """Return, in the order of time, time [s], load [mN], separation or height, and what bends beside it [nm].

    They lie in the columns of `values` wherever these hold them. `untimed` is the header of a file without a column of
    times, None of another.
    """
    time, load, height = (
        _channel(columns, values, way, quantity, names)
        for quantity, names in (("time", [TIME]), ("load", [DEFLECTION]), ("depth", [SEPARATION]))
    )
    bent = None if height is None else np.zeros(1)
    if height is None:
        height, bent = (_channel(columns, values, way, "depth", names) for names in (HEIGHTS, [DEFLECTION]))
    if time is None and untimed is not None and load is not None:
        time = _spread(untimed, way, load)
    if time is None or load is None or height is None or bent is None:
        needed = {f"{TIME}_s_{way}": time, f"{DEFLECTION}_pN_{way}": load}
        missing = [name for name, found in needed.items() if found is None]
        missing += [f"{SEPARATION}_nm_{way}"] if height is None or bent is None else []
        raise InputError(f"its force curve lacks {', '.join(missing)}", remedy=REMEDY)
    whole = np.flatnonzero(np.isfinite(time + load + height + bent))
    if len(whole) < 2:
        raise InputError("holds no measured values", remedy="export the force curve again")
    order = whole[np.argsort(time[whole], kind="stable")]
    for channel in (time, load, height, *([bent] if len(bent) > 1 else [])):
        channel[: len(order)] = channel[order]
    return time[: len(order)], load[: len(order)], height[: len(order)], bent[: len(order)]


def _spread(header: Sequence[str], way: str, load: np.ndarray) -> np.ndarray:
    """Return even times [s] for the loads (n,) of a direction, by the scan rate that the header states.

    Rows may run against time, as those of the extension often do: the load is largest where the directions meet.
    """
    begin = next((k for k, line in enumerate(header) if FORCE_LIST in line), 0)
    entries = _facts(header[begin:])
    stated = {name: NUMBER.match(entries.get(name, "")) for name in (RATE, *SPEEDS.values())}
    rate, *speeds = (float(found[0]) if found else 0.0 for found in stated.values())
    samples, filled = NUMBER.findall(entries.get(SAMPLES, "")), load[np.isfinite(load)]
    if not rate:
        raise InputError(f"holds no times, and its header states no {RATE} that would give them", remedy=REMEDY)
    if samples and str(len(filled)) not in samples:
        problem = f"holds no times, and {len(filled)} rows of {way} where its header states {SAMPLES} {samples[0]}"
        raise InputError(f"{problem}, over which the {RATE} counts", remedy=REMEDY)
    share = 1 - dict(zip(SPEEDS, speeds, strict=True))[way] / sum(speeds) if all(speeds) else 0.5
    clock = share / rate / max(len(filled), 1) * np.arange(len(load))
    inward = len(filled) > 0 and filled[-1] > filled[0]
    return clock if inward == (way == DIRECTIONS[0]) else clock[::-1]


def _depths(height: Sequence[np.ndarray], bent: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return the depth of each direction [nm], which grows in extension and falls in retraction, from any zero.

    Where they are counted from opposite ends, as ramps may be, the retraction begins where the extension ends.
    """
    signs = [turn * np.sign(way[-1] - way[0]) for turn, way in zip((1.0, -1.0), height, strict=False)]
    depths = list(height)
    for sign, way, yielded in zip(signs, height, bent, strict=True):
        way *= sign
        way -= yielded
    if len(set(signs)) > 1:
        depths[1] += depths[0][-1] - depths[1][0]
    return depths


def _channel(columns: Columns, values: np.ndarray, way: str, quantity: str, names: Sequence[str]) -> np.ndarray | None:
    """Return the first of the channels of these names in a unit of a quantity, in s, mN or nm; None without one."""
    for name in names:
        for (channel, unit, direction), place in columns.items():
            if channel == name and direction == way and unit_of(quantity, unit):
                return column(values, place, scale(quantity, unit))
    return None


def _check_turn(extended: np.ndarray, retracted: np.ndarray) -> None:
    """Raise `InputError` unless the extension ends and the retraction begins under load."""
    for name, far, near, largest in (
        ("extension does not end", extended[0], extended[-1], extended.max()),
        ("retraction does not begin", retracted[-1], retracted[0], retracted.max()),
    ):
        if near < far + HALF * (largest - far):
            problem = f"the {name} under load: its rows and its times run against each other"
            raise InputError(problem, remedy="export the force curve again, or the extension alone")


def _facts(lines: Sequence[str]) -> dict[str, str]:
    r"""Return the header's entries, ``\name: value``, the first of each name; the radius of the tip is in nm."""
    entries: dict[str, str] = {}
    for line in lines:
        name, _, value = line.strip('"').lstrip("\\@").partition(": ")
        if name and value.strip():
            entries.setdefault(WITH_UNIT.get(name.strip(), name.strip()), value.strip())
    return entries


READER = Reader("nanoscope_text", "NanoScope force curve as text", matches, read)
