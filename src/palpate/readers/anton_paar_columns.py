"""Anton Paar column exports ``.TXT``: several tests side by side, pairs of time and channel, no settings."""

from __future__ import annotations

import re

import numpy as np

from palpate.errors import InputError
from palpate.readers.source import Source
from palpate.readers.text import table
from palpate.readers.vendor import Corrections, Reader, VendorTest, refuse_corrections
from palpate.recording import Recording

HEADING = re.compile(r"Y_(.+)_(Fn_\[mN\]|Pd_\[nm\])$")


def matches(source: Source) -> bool:
    """Return whether the first line names pairs X_..._Time_[s], Y_..._Fn_[mN]."""
    first = source.content[:8192].split(b"\n", 1)[0]
    return first.startswith(b"X_") and b"_Time_[s]" in first and b"Fn_[mN]" in first


def read(source: Source, corrections: Corrections) -> list[VendorTest]:
    """Read all tests; depth is brought to the times of the load.

    The instrument writes the last point of a segment again as the first of the next; the repetition is dropped.
    """
    refuse_corrections(source, corrections)
    lines, path = source.lines, source.path
    headings = [cell.strip() for cell in lines[0].split("\t") if cell.strip()]
    values = table(lines[1:], 2, len(headings), path)
    channels: dict[str, dict[str, np.ndarray]] = {}
    for k, heading in enumerate(headings):
        found = HEADING.match(heading)
        if found:
            pair = values[:, k - 1 : k + 1]
            pair = pair[np.isfinite(pair).all(axis=1)]
            channels.setdefault(found[1], {})[found[2]] = pair[np.append(True, np.diff(pair[:, 0]) > 0)]
    tests = []
    for name, channel in channels.items():
        if len(channel) < 2:
            raise InputError(f"test {name} lacks load or depth", remedy="export both", file=path, place="line 1")
        load, depth = channel["Fn_[mN]"], channel["Pd_[nm]"]
        time = load[:, 0]
        try:
            recording = Recording(
                time, load[:, 1], np.interp(time, depth[:, 0], depth[:, 1]), name=name, notes=(f"from {path.name}",)
            )
        except InputError as error:
            raise error.located(file=path, place=f"test {name}") from None
        tests.append(VendorTest(name, recording))
    return tests


READER = Reader("anton_paar_columns", "Anton Paar export in columns", matches, read)
