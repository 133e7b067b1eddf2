"""Times that a table writes as a clock does: hours, minutes and seconds."""

from __future__ import annotations

import datetime
import re
from typing import Any

CLOCK = re.compile(r"(\d+):([0-5]?\d):([0-5]?\d(?:[.,]\d+)?)")


def seconds(cell: Any) -> Any:
    """Return the seconds [s] that ``1:02:03.5`` or a workbook's time of day or duration stands for; others as they are.

    ``02:03`` stays text: it may be minutes and seconds, or hours and minutes.
    """
    if isinstance(cell, datetime.timedelta):
        return cell.total_seconds()
    found = CLOCK.fullmatch(str(cell).strip())
    if not found:
        return cell
    hours, minutes, rest = found.groups()
    return 3600 * int(hours) + 60 * int(minutes) + float(rest.replace(",", "."))
