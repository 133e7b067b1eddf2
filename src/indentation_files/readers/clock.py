"""Times that a table writes as a clock or a calendar does: hours, minutes and seconds, with or without a date."""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

ORIGIN = datetime.datetime(1899, 12, 31)  # a workbook's time of day without a date counts from here
DAY, HOUR = 86400.0, 3600.0
ROUNDS = {DAY: (DAY, DAY / 2), HOUR: (HOUR,)}  # a clock of twelve hours may not say which half of the day it is
LARGEST_STEP = 2.0  # of the largest step elsewhere: a clock that begins anew goes on with a step such as the others
ISO = re.compile(r"\d{4}-?\d\d-?\d\d[T ]\d\d.*")
CLOCK = re.compile(
    r"(?P<sign>[-−])?(?:(?P<days>\d+) ?d(?:ays?)?,? )?"
    r"(?:(?P<date>[^:]*\d[^:]*?),?[ T]+)??(?:(?P<before>[ap])\.?m\.? ?)?"
    r"(?:(?P<hours>\d+):)?(?P<minutes>\d+):(?P<seconds>[0-5]?\d(?:[.,]\d+|:\d{3})?)"
    r" ?(?:(?P<after>[ap])\.? ?m\.?)?(?: ?(?:Z|[-+]\d\d:?\d\d))?(?: \d{4})?",
    re.IGNORECASE,
)
HALVES = {"午前": "AM ", "午後": "PM ", "上午": "AM ", "下午": "PM ", "오전": "AM ", "오후": "PM "}
MINUTES_FIRST = re.compile(r"\bm+(?:in)?:s+", re.IGNORECASE)
HOURS_FIRST = re.compile(r"\bh+:m+(?:in)?(?!\w*:)", re.IGNORECASE)
TAKEN = "times such as {} are taken as minutes and seconds (a heading with hh:mm says hours and minutes)"


@dataclass(frozen=True)
class Reading:
    """What a clock shows.

    It shows `seconds` since its zero, or midnight [s]; a calendar's time has a `day` since `ORIGIN` too, apart from the
    seconds, which keep their microseconds so. After the `period` [s] the clock begins anew; None for a calendar's time.
    `date` is any date beside it, as written. `text` is the text where nothing shows whether it is of minutes and
    seconds or of hours and minutes.
    """

    seconds: float
    day: int = 0
    period: float | None = None
    date: str = ""
    text: str = ""


def seconds(cells: Sequence[Any], heading: str = "") -> tuple[list[Any], tuple[str, ...]]:
    """Return a column's times [s] in place of what is written as a clock or a date does, others as they are.

    Known are ``1:02:03.5``, ``-02:03.5`` (minutes and seconds), ``11:59:40 PM``, ``2024-03-05T23:59:40Z``, a date
    before a clock, and a workbook's times, dates and durations. A clock that passes midnight, or the hour where no
    hours are written, goes on. The `heading`, the column's name, may say ``mm:ss`` or ``hh:mm``.

    Beside the cells, what the user should know is returned: what was taken for what.
    """
    readings = [_reading(cell, heading) for cell in cells]
    shown = [reading for reading in readings if reading]
    calendar = [reading for reading in shown if reading.period is None]
    if len(calendar) < len(shown) and any(reading.day > 1 for reading in calendar):
        return [*cells], ()
    going_on = iter(_going_on(shown))
    result = [next(going_on) if reading else cell for cell, reading in zip(cells, readings, strict=True)]
    result = [cell if value is None else value for cell, value in zip(cells, result, strict=True)]
    doubtful = [reading.text for reading in shown if reading.period == HOUR and reading.text]
    return result, (TAKEN.format(doubtful[0]),) if doubtful and len(doubtful) == len(shown) else ()


def _going_on(shown: Sequence[Reading]) -> list[float | None]:
    """Return the seconds of readings, with the clock's period added wherever it begins anew.

    None from where the date beside the clock changes and the clock does not begin anew.
    """
    given = [DAY * (reading.day - shown[0].day) + reading.seconds for reading in shown]
    steps = [later - earlier for earlier, later in pairwise(given)]
    largest = LARGEST_STEP * max((step for step in steps if step > 0), default=0.0)
    rounds, result = 0.0, given[:1]
    for (earlier, later), value, step in zip(pairwise(shown), given[1:], steps, strict=True):
        added = [period for period in ROUNDS.get(later.period or 0.0, ()) if 0 <= step + period <= largest]
        rounds += added[0] if added and step < 0 else 0.0 if earlier.date == later.date else math.nan
        result.append(value + rounds)
    return [None if math.isnan(value) else value for value in result]


def _reading(cell: Any, heading: str) -> Reading | None:
    """Return what a cell shows, None where it is no clock and no date with a clock."""
    if isinstance(cell, datetime.timedelta):
        return Reading(cell.total_seconds(), period=DAY)
    if isinstance(cell, datetime.time):
        return replace(_of_calendar(datetime.datetime.combine(ORIGIN, cell)), period=DAY)
    if isinstance(cell, datetime.date):
        return _of_calendar(cell if isinstance(cell, datetime.datetime) else datetime.datetime(*cell.timetuple()[:3]))
    if not isinstance(cell, str) or (":" not in cell and not ISO.fullmatch(cell.strip())):
        return None
    if not cell.isascii():
        for half, meant in HALVES.items():
            cell = cell.replace(half, meant)
    text = " ".join(cell.split())
    if ISO.fullmatch(text):
        try:
            return _of_calendar(datetime.datetime.fromisoformat(text))
        except ValueError:
            return None
    found = CLOCK.fullmatch(text)
    return _of_clock(found.groupdict(), text, heading) if found else None


def _of_calendar(moment: datetime.datetime) -> Reading:
    """Return the day and the seconds of a moment, in UTC where it has a time zone."""
    since = moment.replace(tzinfo=None) - ORIGIN - (moment.utcoffset() or datetime.timedelta())
    return Reading(since.seconds + since.microseconds / 1e6, since.days)


def _of_clock(part: dict[str, str | None], text: str, heading: str) -> Reading | None:
    """Return what the parts of a clock's text show; None where no clock shows that."""
    if part["sign"]:
        shown = _of_clock(part | {"sign": None}, text, heading)
        return shown and replace(shown, seconds=-shown.seconds)
    minutes, rest = int(part["minutes"] or 0), str(part["seconds"])
    half, date = part["before"] or part["after"], part["date"] or ""
    if part["hours"] is None and rest.isdecimal() and not MINUTES_FIRST.search(heading):
        if half or date or HOURS_FIRST.search(heading):
            return _of_clock(part | {"hours": part["minutes"], "minutes": rest, "seconds": "0"}, text, heading)
        return Reading(60 * minutes + int(rest), 0, HOUR, date, text) if len(rest) == 2 else None
    with_point = float(re.sub("[,:]", ".", rest))
    if part["hours"] is None:
        return Reading(60 * minutes + with_point, 0, HOUR, date)
    hours = int(part["hours"])
    if minutes > 59 or (half and hours > 12):
        return None
    if half:
        hours = hours % 12 + (12 if half.casefold() == "p" else 0)
    return Reading(DAY * int(part["days"] or 0) + 3600 * hours + 60 * minutes + with_point, 0, DAY, date)
