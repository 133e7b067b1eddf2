"""What was measured in one condition: replicate curves of the response, at the sample times of its simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.base.interpolation import depth_at, load_at
from palpate.errors import InputError
from palpate.recordings.recording import Recording
from palpate.study.quantity import DEPTH, Quantity

ROLES = ("calibrate", "validate")
WHOLE = 0.98  # of a condition's duration, what a recording of it covers at least


@dataclass(frozen=True, eq=False)
class Observation:
    """Replicates of one condition.

    Parameters
    ----------
    time : ndarray, shape (n_points,)
        Sample times [s].
    response : ndarray, shape (n_replicates, n_points)
        One curve for each recording, of depth [nm] or load [mN].
    role
        ``calibrate``, or ``validate``: held out of the fit, to validate it.
    quantity
        What the curves are of.
    """

    time: np.ndarray
    response: np.ndarray
    role: str = "calibrate"
    quantity: Quantity = DEPTH

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", np.asarray(self.time, dtype=float))
        object.__setattr__(self, "response", np.atleast_2d(np.asarray(self.response, dtype=float)))
        if self.role not in ROLES:
            raise InputError(f"role is {self.role!r}", remedy=f"use one of: {', '.join(ROLES)}", place="role")
        if self.response.ndim != 2 or self.response.shape[1:] != self.time.shape or not self.response.size:
            raise InputError(
                f"response has shape {self.response.shape}, expected (n_replicates, {self.time.size})",
                remedy="resample every replicate on the sample times",
                place="response",
            )
        if not np.all(np.isfinite(self.response)):
            raise InputError(
                f"a {self.quantity.name} is not a number", remedy="remove or repair the recording", place="response"
            )

    @classmethod
    def from_recordings(
        cls,
        time: np.ndarray,
        recordings: Sequence[Recording],
        role: str = "calibrate",
        quantity: str = "depth",
    ) -> Observation:
        """Resample depths or loads of recordings on the sample times, see `palpate.base.interpolation`.

        Parameters
        ----------
        time : ndarray, shape (n_points,)
            Sample times [s].
        recordings
            Replicates of one condition.
        role
            ``calibrate`` or ``validate``.
        quantity
            The response: ``depth`` or ``load``.

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
        if quantity == "load":
            return cls(time, np.array([load_at(time, r.time, r.load) for r in recordings]), role)
        return cls(time, np.array([depth_at(time, r.time, r.depth) for r in recordings]), role)

    @property
    def mean(self) -> np.ndarray:
        """Mean curve (n_points,)."""
        return self.response.mean(axis=0)
