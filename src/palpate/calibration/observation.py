"""What was measured in one condition: replicate depth curves on the sample times of its simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError
from palpate.interpolation import depth_at
from palpate.recording import Recording

ROLES = ("calibrate", "validate")
WHOLE = 0.98  # of a condition's duration, what a recording of it covers at least


@dataclass(frozen=True, eq=False)
class Observation:
    """Replicates of one condition.

    Parameters
    ----------
    time : ndarray, shape (n_points,)
        Sample times [s].
    depth : ndarray, shape (n_replicates, n_points)
        One depth curve for each recording [nm].
    role
        ``calibrate``, or ``validate``: never enters the fit, judges it.
    """

    time: np.ndarray
    depth: np.ndarray
    role: str = "calibrate"

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", np.asarray(self.time, dtype=float))
        object.__setattr__(self, "depth", np.atleast_2d(np.asarray(self.depth, dtype=float)))
        if self.role not in ROLES:
            raise InputError(f"role is {self.role!r}", remedy=f"use one of: {', '.join(ROLES)}", place="role")
        if self.depth.ndim != 2 or self.depth.shape[1:] != self.time.shape or not self.depth.size:
            raise InputError(
                f"depth has shape {self.depth.shape}, expected (n_replicates, {self.time.size})",
                remedy="resample every replicate on the sample times",
                place="depth",
            )
        if not np.all(np.isfinite(self.depth)):
            raise InputError("a depth is not a number", remedy="remove or repair the recording", place="depth")

    @classmethod
    def from_recordings(cls, time: np.ndarray, recordings: Sequence[Recording], role: str = "calibrate") -> Observation:
        """Resample recordings on the sample times, see `palpate.interpolation.depth_at`.

        Raises
        ------
        InputError
            When a recording ends before the last sample time by more than 2 % of the test.
        """
        for recording in recordings:
            if recording.time[-1] < WHOLE * time[-1]:
                raise InputError(
                    f"recording {recording.name} ends at {recording.time[-1]:g} s, its condition at {time[-1]:g} s",
                    remedy="give a complete recording or correct the times of the condition",
                )
        return cls(time, np.array([depth_at(time, r.time, r.depth) for r in recordings]), role)

    @property
    def mean(self) -> np.ndarray:
        """Mean depth curve (n_points,) [nm]."""
        return self.depth.mean(axis=0)
