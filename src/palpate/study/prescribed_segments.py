"""The segments of a test: loading, hold and unloading, from what is prescribed."""

from __future__ import annotations

import numpy as np

from palpate.study.protocol import Protocol

STILL = 0.05  # of the mean rate, up to which the drive is held


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
