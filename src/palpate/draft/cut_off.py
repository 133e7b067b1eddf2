"""Tests that were cut off: they end under load, in the course of others that go on and are unloaded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.draft.prescribed_drive import Drive
from palpate.inference.observation import WHOLE
from palpate.inference.recording_checks import LOAD_TOLERANCE
from palpate.recordings.recording import Recording

UNLOADED = 0.1  # of its largest load, chosen: a test that ends under less has been unloaded


def cut_off(tests: Sequence[Recording], drive: Drive) -> dict[Recording, Recording]:
    """Return the tests that were cut off, each with a whole test of its course.

    They count as cut off where no more tests end in one course than go through it; else they may be meant to end there.

    Parameters
    ----------
    tests
        From contact on.
    drive
        What was prescribed.
    """
    whole = [test for test in tests if _unloaded(test)]
    through = {
        test: found
        for test in tests
        if not _unloaded(test) and (found := [other for other in whole if _goes_on(test, other, drive)])
    }
    return {
        test: found[0]
        for test, found in through.items()
        if len(found) >= sum(found[0] in others for others in through.values())
    }


def _unloaded(test: Recording) -> bool:
    return bool(test.load[-1] <= UNLOADED * test.load.max())


def _goes_on(test: Recording, other: Recording, drive: Drive) -> bool:
    """Return whether another test has the course of a test's drive up to its end, and goes on."""
    if test.time[-1] >= WHOLE * other.time[-1]:
        return False
    departure = drive.of(test) - np.interp(test.time, other.time, drive.of(other))
    return bool(np.sqrt(np.mean(departure**2)) <= LOAD_TOLERANCE * drive.of(test).max())
