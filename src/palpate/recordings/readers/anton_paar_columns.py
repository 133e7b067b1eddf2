"""Anton Paar column exports ``.TXT``: tests side by side, a time before each channel or for all, no settings."""

from __future__ import annotations

import re

import numpy as np

from palpate.errors import InputError
from palpate.recordings.readers.numbers_in_text import require_tabs, table
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.units import scale
from palpate.recordings.readers.vendor import (
    Corrections,
    Reader,
    Unreadable,
    VendorTest,
    attempt,
    refuse_corrections,
    unfinished,
    unless_all_fail,
    usable,
)
from palpate.recordings.recording import Recording

HEADING = re.compile(r"[XY]_(.+)_(Time|Fn|Pd)_\[(.+)\]")
KEYS = {"Time": "time", "Fn": "load", "Pd": "depth"}
GAP = 10
Series = tuple[np.ndarray, np.ndarray]


def matches(source: Source) -> bool:
    """Return whether the first line names columns X_..._Time_[s], Y_..._Fn_[mN]."""
    return source.first.startswith("X_") and "_Time_[" in source.first and "_Fn_[" in source.first


def read(source: Source, corrections: Corrections) -> list[VendorTest | Unreadable]:
    """Read all tests; depth is brought to the times of the load. A channel's time is the last one named before it.

    The instrument writes the last point of a segment again as the first of the next; the repetition is dropped.
    """
    refuse_corrections(source, corrections)
    require_tabs(source.first, source.path)
    start = next(k for k, line in enumerate(source.lines) if line.strip())
    headings = source.lines[start].rstrip().split("\t")
    values = table(source.lines[start + 1 :], start + 2, len(headings), source.path)
    time = np.full(len(values), np.nan)
    tests: dict[str, dict[str, list[Series]]] = {}
    for index, heading in enumerate(headings):
        found = HEADING.fullmatch(heading.strip())
        if found:
            key = KEYS[found[2]]
            channel = values[:, index] * scale(key, found[3])
            if key == "time":
                time = channel
            else:
                tests.setdefault(found[1], {"load": [], "depth": []})[key].append((time, channel))
    return unless_all_fail(
        [attempt(source.path, name, _test, source, name, both["load"], both["depth"]) for name, both in tests.items()]
    )


def _test(source: Source, name: str, load: list[Series], depth: list[Series]) -> VendorTest:
    """Return the test of a name, from its one column of load and its one column of depth."""
    warnings: list[str] = []
    clean: list[Series] = []
    for key, found in (("load", load), ("depth", depth)):
        if len(found) != 1:
            raise InputError(
                f"has {len(found)} columns of {key}",
                remedy="export both channels once, under a name of its own for each test",
            )
        kept, said = usable(source, f"{name}, {key}", *found[0])
        warnings += [f"{key}: {words}" for words in said]
        clean.append((found[0][0][kept], found[0][1][kept]))
    (time, force), (moments, path) = clean
    common = _common(time, moments)
    if not common.all():
        warnings.append(f"{(~common).sum()} of {len(time)} points of the load left out: the depth has none there")
    time, force = time[common], force[common]
    recording = Recording(time, force, np.interp(time, moments, path), name, (f"from {source.path.name}",))
    return VendorTest(name, recording, warnings=(*warnings, *unfinished(force)))


def _common(time: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """Return which times of the load (n,) lie within the depth's (m,).

    Raises
    ------
    InputError
        When fewer than two do, or many more than elsewhere lie between two points of the depth.
    """
    rounding = 1e-9 * np.ptp(time)
    common = (time > moments[0] - rounding) & (time < moments[-1] + rounding)
    if common.sum() < 2:
        raise InputError("load and depth have no time in common", remedy="export the test again")
    between = np.bincount(np.searchsorted(moments, time[common] - rounding), minlength=len(moments))
    widest = int(np.argmax(between))
    if between[widest] > GAP * max(1.0, float(np.median(between))):
        raise InputError(
            f"the depth has no point from {moments[widest - 1]:.5g} to {moments[widest]:.5g} s, the load has "
            f"{between[widest]}",
            remedy="export the test again",
        )
    return common


READER = Reader("anton_paar_columns", "Anton Paar export in columns", matches, read)
