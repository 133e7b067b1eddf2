"""JPK force curves exported as text: segments below one another, each under a header of lines that begin with ``#``.

The header names the columns, their units and the spring constant. The tip is where the height sensor is, moved by the
cantilever's deflection: depth = -(height + force / stiffness). The column ``verticalTipPosition`` is that sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.afm import BY_PIEZO, not_stated
from indentation_files.readers.lines import Lines
from indentation_files.readers.numbers_in_text import number, table
from indentation_files.readers.source import Source
from indentation_files.readers.units import SCALES, unit_of
from indentation_files.readers.vendor import Reader, VendorTest, usable, vendor_test

TITLE = "# TEXT EXPORT"
FORCE = "vDeflection"
TIP = ("verticalTipPosition", "tipSampleSeparation")
SENSORS = ("strainGaugeHeight", "capacitiveSensorHeight", "measuredHeight")
HEIGHTS = (*SENSORS, *(f"smoothed{name[0].upper()}{name[1:]}" for name in SENSORS), "height")
DURATIONS = {
    "extend": ("force-settings.extend-scan-time", "traceScanTime"),
    "retract": ("force-settings.retract-scan-time", "retraceScanTime"),
    "pause": ("force-settings.extended-pause-time", "pauseAtEnd"),
}
SPREAD = "the file holds no time: the points of each segment are spread evenly over the duration in its header"


@dataclass(frozen=True)
class ExportedSegment:
    """One segment of a force curve: the entries of its header, and its columns, each with its unit."""

    facts: dict[str, str]
    channels: dict[str, tuple[np.ndarray, str]]

    def channel(self, quantity: str, names: Sequence[str]) -> np.ndarray:
        """Return the first of the columns `names` that there is, brought to s, mN or nm in place, once."""
        name = next((name for name in names if name in self.channels), None)
        if name is None:
            raise InputError(f"lacks the column {names[0]}", remedy="export it too")
        values, written = self.channels[name]
        unit = unit_of(quantity, written)
        if unit is None:
            raise InputError(f"{name} is in {written!r}", remedy=f"export it in one of: {', '.join(SCALES[quantity])}")
        values *= SCALES[quantity][unit]
        return values

    def stated(self, *names: str) -> float:
        """Return the first positive number that the header states under one of the names; zero without."""
        return next((value for name in names if (value := number(self.facts.get(name, ""))) > 0), 0.0)


def matches(source: Source) -> bool:
    """Return whether the first line is JPK's title of text exports."""
    return source.first == TITLE


def read(source: Source) -> list[VendorTest]:
    """Read the one curve, with its approach; contact is not marked."""
    channels, facts, messages = _curve(source)
    kept, warnings = usable("measured values", *channels)
    since, load, way = (channel[kept] for channel in channels)
    channels = [since - since[0], load, way - way[0]]
    return [vendor_test(source, source.path.stem, channels, facts, (*warnings, *messages))]


def _curve(source: Source) -> tuple[list[np.ndarray], dict[str, str], tuple[str, ...]]:
    """Return time [s], load [mN] and depth [nm] of all segments, what the first states, and messages."""
    segments = _segments(source.lines)
    if not segments:
        raise InputError("holds no measured values", remedy="export the force curve again")
    force = [_force(segment) for segment in segments]
    depth = [_depth(segment, load) for segment, load in zip(segments, force, strict=True)]
    time, messages = _time(segments)
    if not any(name in segment.channels for segment in segments for name in (*TIP, *HEIGHTS[:-1])):
        messages = (*messages, BY_PIEZO)
    facts = {key: value for key, value in segments[0].facts.items() if value}
    if spring := segments[0].stated("springConstant"):
        facts["spring constant [N/m]"] = f"{spring:.6g}"
    return [np.concatenate(parts) for parts in (time, force, depth)], facts, messages


def _segments(lines: Lines) -> list[ExportedSegment]:
    """Return the segments that hold numbers."""
    found: list[ExportedSegment] = []
    facts: dict[str, str] = {}
    begin = 0
    headers = [(k, line) for k, line in lines.in_words() if line.startswith("#")]
    for k, line in [*headers, (len(lines), "#")]:
        if any(row.strip() for row in lines[begin:k]):
            found.append(_segment(dict(facts), lines[begin:k]))
        begin = k + 1
        key, colon, value = line[1:].partition(":")
        if colon:
            facts[key.strip()] = value.strip()
    return found


def _segment(facts: dict[str, str], lines: Lines) -> ExportedSegment:
    """Return the segment in `lines`, below its header's entries."""
    names, units = (facts.get(key, "").split() for key in ("columns", "units"))
    if not names or len(names) != len(units):
        problem = "its header does not name each column with a unit"
        raise InputError(problem, remedy="export the force curve again", place=f"line {lines.first}")
    values = table(lines, len(names), delimiter=" ")
    return ExportedSegment(facts, dict(zip(names, zip(values.T, units, strict=True), strict=True)))


def _force(segment: ExportedSegment) -> np.ndarray:
    """Return the load of a segment [mN], from the deflection where that is no force yet."""
    values, unit = segment.channels.get(FORCE, (np.empty(0), ""))
    way = unit_of("depth", unit)
    if unit != "V" and way is None:
        return segment.channel("load", [FORCE])
    factors = {"spring constant": segment.stated("springConstant")}
    if way is None:
        factors["sensitivity"] = segment.stated("sensitivity")
    missing = [name for name, factor in factors.items() if not factor]
    if missing:
        raise not_stated(*missing)
    in_metres = 1.0 if way is None else SCALES["depth"][way] / SCALES["depth"]["m"]
    return SCALES["load"]["N"] * in_metres * np.prod(list(factors.values())) * values


def _depth(segment: ExportedSegment, load: np.ndarray) -> np.ndarray:
    """Return the depth of the tip [nm], from any zero, under a `load` [mN]."""
    if any(name in segment.channels for name in TIP):
        return -segment.channel("depth", TIP)
    spring = segment.stated("springConstant")
    if not spring:
        problem = "states no spring constant, so that the way of the tip is not known"
        raise InputError(problem, remedy=f"calibrate the cantilever, or export the column {TIP[0]} too")
    return -segment.channel("depth", HEIGHTS) - 1e6 * load / spring


def _time(segments: Sequence[ExportedSegment]) -> tuple[list[np.ndarray], tuple[str, ...]]:
    """Return the times of all segments [s], and what the user should know of them.

    A clock that each segment starts anew goes on from the end of the one before.
    """
    if all("seriesTime" in segment.channels for segment in segments):
        return [segment.channel("time", ["seriesTime"]) for segment in segments], ()
    clocks, end = [], 0.0
    for segment in segments:
        if "time" in segment.channels:
            clock = segment.channel("time", ["time"])
            step = clock[1] - clock[0] if len(clock) > 1 else 0.0
        else:
            count = len(next(iter(segment.channels.values()))[0])
            duration = segment.stated(*DURATIONS.get(segment.facts.get("segment", ""), ()))
            if not duration:
                raise InputError("holds no time, and no duration of its segments", remedy="export it with time")
            clock, step = duration * np.arange(count) / count, duration / count
        clocks.append(end + clock)
        end = float(clocks[-1][-1] + step)
    return clocks, () if all("time" in segment.channels for segment in segments) else (SPREAD,)


READER = Reader("jpk_text", "JPK force curve as text", matches, read)
