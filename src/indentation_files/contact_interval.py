"""The 95 % interval of a contact that was sought, as a comment of the recording: ``contact_interval_nm: LOWER UPPER``.

It is on the recording's own scale, whose zero is the contact that was taken.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from indentation_files.contact_point import ContactPoint
from indentation_files.errors import InputError
from indentation_files.recording import Recording

KEY = "contact_interval_nm"


def interval_note(point: ContactPoint) -> str:
    """Return the comment that a recording carries whose depth is zero at a contact that was found."""
    return f"{KEY}: {point.lower - point.depth:.4g} {point.upper - point.depth:.4g}"


def interval_of(recording: Recording) -> tuple[float, float] | None:
    """Return the interval (lower, upper) [nm] that a recording carries, or None; raises `InputError` on no interval."""
    for note in recording.notes:
        key, _, text = note.partition(":")
        if key.strip() == KEY:
            return _numbers(text, recording.name)
    return None


def joint_interval(recordings: Iterable[Recording]) -> tuple[float, float] | None:
    """Return the interval that holds those of all recordings; None where one of them carries none."""
    found = [interval_of(recording) for recording in recordings]
    known = [interval for interval in found if interval is not None]
    if not known or len(known) < len(found):
        return None
    return min(lower for lower, _ in known), max(upper for _, upper in known)


def _numbers(text: str, name: str) -> tuple[float, float]:
    """Return two finite numbers in order; raises `InputError`."""
    try:
        lower, upper = (float(cell) for cell in text.split())
    except ValueError:
        lower = upper = math.nan
    if not (math.isfinite(lower) and math.isfinite(upper) and lower <= upper):
        raise InputError(
            f"{name}: {text.strip()!r} is no interval", remedy="give two depths in nm, the lower one first", place=KEY
        )
    return lower, upper
