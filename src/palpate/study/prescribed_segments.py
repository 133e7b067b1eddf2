"""The segments of a test: loading, hold and unloading, from what is prescribed, over the whole test and by cycle."""

from __future__ import annotations

import numpy as np

from palpate.study.protocol import Protocol

STILL = 0.05  # of the mean rate, up to which the drive is held
HELD_OUT = 1 / 3  # of the cycles of a test that are held out, chosen: as much as of three tests one
SWING = 0.05  # of the largest drive, by which it falls and rises again between two cycles


def segments(protocol: Protocol) -> dict[str, np.ndarray]:
    """Return which sample times (bool, n) belong to each segment that the test has.

    Load or displacement rises by more than a twentieth of its mean rate during loading, falls by as much in unloading.
    """
    time, drive = protocol.sample_time, protocol.sample_drive
    before = protocol.drive_at(np.concatenate([[0.0], time[:-1]]))
    rate = (drive - before) / np.diff(time, prepend=0.0)
    usual = np.abs(rate).mean()
    found = {
        "loading": rate > STILL * usual,
        "hold": np.abs(rate) <= STILL * usual,
        "unloading": rate < -STILL * usual,
    }
    return {name: where for name, where in found.items() if where.sum() >= 2}


def by_cycle(protocol: Protocol) -> dict[tuple[int, str], np.ndarray]:
    """Return which sample times (bool, n) belong to each segment of each loading cycle, numbered from 1."""
    number = cycles(protocol)
    found = {
        (int(cycle), name): where & (number == cycle)
        for cycle in np.unique(number)
        for name, where in segments(protocol).items()
    }
    return {key: where for key, where in found.items() if where.sum() >= 2}


def cycles(protocol: Protocol) -> np.ndarray:
    """Return the number of the loading cycle (n,) at each sample time, see `cycle_begins`."""
    return np.searchsorted(cycle_begins(protocol), protocol.sample_time, side="left")


def cycle_begins(protocol: Protocol) -> list[float]:
    """Return when each loading cycle begins [s], the first at zero.

    A cycle begins where the drive turns to rise, after a fall by a twentieth of the largest drive and before a rise by
    as much.
    """
    swing, time, drive = SWING * protocol.largest_drive, protocol.knot_time, protocol.knot_drive
    begins = [0.0]
    highest, lowest, turned = drive[0], np.inf, 0.0
    for moment, value in zip(time, drive, strict=True):
        if lowest == np.inf:  # before the fall that ends the cycle
            highest = max(highest, value)
            if value <= highest - swing:
                lowest, turned = value, moment
        elif value <= lowest:
            lowest, turned = value, moment
        elif value >= lowest + swing:
            begins.append(float(turned))
            highest, lowest = value, np.inf
    return begins


def last_cycles(protocol: Protocol) -> tuple[tuple[float, float], str] | None:
    """Return when the last third of the cycles begins and ends [s], and its name in words; None of a single cycle.

    Their number is not stated: cycles below a twentieth of the largest drive are not told apart.
    """
    begins = cycle_begins(protocol)
    if len(begins) == 1:
        return None
    count = max(1, round(HELD_OUT * len(begins)))
    words = f"the last {count} cycles" if count > 1 else "the last cycle"
    return (begins[-count], float(protocol.knot_time[-1])), words
