"""What the instrument of a draft prescribes: a load, or a displacement, that of a piezo behind a cantilever too.

Tests that were cut off end under load, in the course of others that go on and are unloaded.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from indentation_files.corners import corners
from indentation_files.recording import Recording
from palpate.data.observation import WHOLE
from palpate.data.recording_checks import LOAD_TOLERANCE
from palpate.draft.stated import Stated
from palpate.study.protocol import DISPLACEMENT, LOAD, Protocol, drive_of
from palpate.study.recorded_history import recorded

STRAIGHT = 0.005  # of the largest, within which a channel that is prescribed follows a few straight lines
CLEARER = 3.0  # times as many corners as the depth needs, that a load needs which answers
FEW = 8  # corners of a prescribed history
DEPTH = re.compile(r"indentation|displacement|depth|position", re.IGNORECASE)
UNLOADED = 0.1  # of its largest load, chosen: a test that ends under less has been unloaded
OWN_DEPTH = re.compile(r"indentation|depth", re.IGNORECASE)


@dataclass(frozen=True)
class Drive:
    """What is prescribed.

    Parameters
    ----------
    control
        ``load`` or ``displacement``.
    spring
        Stiffness of what lies between the displacement that is prescribed and the tip [mN/nm]; None for nothing.
    why
        Where it is known from.
    """

    control: str = LOAD
    spring: float | None = None
    why: str = "guess: the load, as its history is the simpler one"

    @classmethod
    def by_all(cls, recordings: Sequence[Recording], stated: Stated) -> Drive:
        """Return what the files state, or what most recordings look like.

        A cantilever is moved by a piezo, whose displacement is prescribed, unless the file says that the load or the
        indentation is held to its course.
        """
        word = stated.control
        if stated.spring and not re.search("load|force", word, re.IGNORECASE) and not OWN_DEPTH.search(word):
            return cls(DISPLACEMENT, stated.spring, "the piezo's displacement behind the spring that the files state")
        if DEPTH.search(word):
            return cls(DISPLACEMENT, None, f"the depth, by the files' control mode {word!r}")
        if word:
            return cls(LOAD, None, f"the load, by the files' control mode {word!r}")
        if 2 * sum(map(_follows_depth, recordings)) > len(recordings):
            return cls(DISPLACEMENT, None, "guess: the depth, which runs along straight lines, while the load does not")
        return cls()

    @property
    def compliance(self) -> float:
        """Of the spring [nm/mN]."""
        return 1.0 / self.spring if self.spring else 0.0

    @property
    def keys(self) -> dict[str, object]:
        """Keys of a study's condition."""
        if self.control == LOAD:
            return {}
        return {"drive": DISPLACEMENT} | ({"spring": self.spring} if self.spring else {})

    def of(self, recording: Recording) -> np.ndarray:
        """Return what is prescribed (n,) in a recording [mN] or [nm]."""
        return drive_of(self.control, self.compliance, recording.load, recording.depth)

    def followed(self, recording: Recording) -> Protocol:
        """Return the history of the drive that a recording gives from contact on."""
        return recorded(recording.time, self.of(recording), control=self.control, compliance=self.compliance)


def _follows_depth(recording: Recording) -> bool:
    """Return whether the depth follows few straight lines, and the load needs many more for the same accuracy."""
    needed = [
        int(corners(recording.time, channel, STRAIGHT * float(channel.max())).sum())
        for channel in (recording.depth, recording.load)
    ]
    return needed[0] <= FEW and needed[1] >= CLEARER * needed[0]


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
