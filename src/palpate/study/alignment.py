"""Replicates in step: recordings of one history, shifted in time until their loads or displacements agree.

The clock of a test starts where contact was seen, which is uncertain by as long as the load takes to rise above its
noise; under a load that grows exponentially that is a second or more, in which nothing happens. At the end of loading
the same second is worth tens of nanometres.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from indentation_files.recording import Recording
from palpate.study.protocol import Protocol
from palpate.study.recorded_history import recorded

LONGEST = 0.05  # of the test, the largest shift
TRIALS = 201  # shifts before the minimum is refined


def time_shift(recording: Recording, protocol: Protocol) -> float:
    """Return by how much [s] the recording's clock is ahead of the protocol's: the shift of least difference in drive.

    Shifts up to a twentieth of the test are considered.
    """
    time = np.linspace(0.0, protocol.knot_time[-1], 4 * TRIALS)
    drive, recorded = protocol.drive_at(time), protocol.drive_of(recording.load, recording.depth)

    def difference(shift: float) -> float:
        return float(np.mean((np.interp(time + shift, recording.time, recorded) - drive) ** 2))

    longest = LONGEST * time[-1]
    trials = np.linspace(-longest, longest, TRIALS)
    best = min(trials, key=difference)
    step = trials[1] - trials[0]
    found = minimize_scalar(difference, bounds=(best - step, best + step), method="bounded")
    return float(found.x) if found.fun < difference(0.0) else 0.0


def aligned(recording: Recording, protocol: Protocol) -> Recording:
    """Return the recording on the protocol's clock."""
    time = recording.time - time_shift(recording, protocol)
    return replace(recording, time=time).at(time > 0.0)


def own_protocol(protocol: Protocol, recording: Recording) -> Protocol:
    """Return the history of one recording's own drive, sampled at the same parts of its duration as a condition's."""
    drive = protocol.drive_of(recording.load, recording.depth)
    own = recorded(recording.time, drive, control=protocol.control, compliance=protocol.compliance)
    times = protocol.sample_time * (own.knot_time[-1] / protocol.knot_time[-1])
    return replace(own, sample_time=np.minimum(times, own.knot_time[-1]))


def stretched(protocol: Protocol, recording: Recording) -> Recording:
    """Return a recording on a clock on which it lasts as long as the history of its condition."""
    return replace(recording, time=recording.time * (protocol.knot_time[-1] / recording.time[-1]))
