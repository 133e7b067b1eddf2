"""The 95 % interval of a contact that was sought, as a comment of the recording: ``contact_interval_nm: LOWER UPPER``.

It is on the recording's own scale, whose zero is the contact that was taken. Contacts of tests made alike are compared:
do they agree, and how well are they known.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from indentation_files.contact_point import ContactPoint
from indentation_files.errors import InputError
from indentation_files.recording import Recording
from indentation_files.sentences import and_more

KEY = "contact_interval_nm"
AT = re.compile(r"contact found by palpate: at (\S+) nm")
VAGUE = 0.1  # of the test's depth, chosen: a wider interval of contact is reported


def interval_note(point: ContactPoint) -> str:
    """Return the comment that a recording carries whose depth is zero at a contact that was found."""
    return f"{KEY}: {point.lower - point.depth:.4g} {point.upper - point.depth:.4g}"


def interval_of(recording: Recording) -> tuple[float, float] | None:
    """Return the interval (lower, upper) [nm] that a recording carries, or None; raises `InputError` on no interval."""
    for note in recording.notes:
        key, _, text = note.partition(":")
        if key.strip() == KEY:
            try:
                lower, upper = (float(cell) for cell in text.split())
            except ValueError:
                lower = upper = math.nan
            if not -math.inf < lower <= upper < math.inf:
                problem = f"{recording.name}: {text.strip()!r} is no interval"
                raise InputError(problem, remedy="give two depths in nm, the lower one first", place=KEY)
            return lower, upper
    return None


def joint_interval(recordings: Iterable[Recording]) -> tuple[float, float] | None:
    """Return the interval that holds those of all recordings; None where one of them carries none."""
    found = [interval_of(recording) for recording in recordings]
    known = [interval for interval in found if interval is not None]
    if not known or len(known) < len(found):
        return None
    return min(lower for lower, _ in known), max(upper for _, upper in known)


@dataclass(frozen=True)
class Sought:
    """A contact that was sought in a recording, with its 95 % interval [nm], in the file's own counting of the depth.

    `reach` is the largest depth beyond it [nm].
    """

    name: str
    depth: float
    lower: float
    upper: float
    reach: float


def sought_in(recordings: Sequence[Recording]) -> list[Sought]:
    """Return the contacts of those recordings whose comments tell where in the file it was found."""
    found = []
    for recording in recordings:
        at = next((match for note in recording.notes if (match := AT.match(note))), None)
        interval = interval_of(recording)
        if at and interval:
            depth = float(at[1])
            lower, upper = depth + interval[0], depth + interval[1]
            found.append(Sought(recording.name, depth, lower, upper, float(recording.depth.max())))
    return found


def disagreeing(recordings: Sequence[Recording]) -> Iterator[str]:
    """Report contacts of tests made alike that differ by more than their intervals.

    Where they lie farther apart than the tests are deep the files count depth from elsewhere, as from a piezo's rest:
    there they need not agree.
    """
    contacts = sought_in(recordings)
    if len(contacts) < 2:
        return
    depths = np.array([one.depth for one in contacts])
    usual = contacts[int(np.argsort(depths)[len(depths) // 2])]
    if np.median(np.abs(depths - usual.depth)) > min(one.reach for one in contacts):
        return
    odd = [one for one in contacts if one.lower > usual.upper or one.upper < usual.lower]
    if odd:
        first = max(odd, key=lambda one: abs(one.depth - usual.depth))
        theirs, others = (f"{one.depth:.4g} ({one.lower:.4g} to {one.upper:.4g})" for one in (first, usual))
        yield (
            f"{first.name}.csv{and_more(odd)}: contact was found at {theirs} nm of the file, that of replicates at "
            f"{others}: look at both (`palpate read --survey`)"
        )


def vague(recordings: Sequence[Recording]) -> Iterator[str]:
    """Report contacts whose interval is wider than a tenth of the test's depth."""
    wide = [one for one in sought_in(recordings) if one.upper - one.lower > VAGUE * one.reach]
    if wide:
        shares = {one.name: (one.upper - one.lower) / one.reach for one in wide}
        widest = max(shares, key=lambda name: shares[name])
        least = f"{100 * min(shares.values()):.0f} to " if len(wide) > 1 else ""
        yield (
            f"{widest}.csv{and_more(wide)}: contact is known to {least}{shares[widest]:.0%} of the test's depth only; "
            "a diagnosis tries every zero of the depth within it"
        )
