"""What was measured in one condition: replicate curves of the response, at the sample times of its simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.errors import InputError
from palpate.observables import Observable, Quantity, response_to
from palpate.observables.depth import DEPTH
from palpate.study.protocol import Protocol

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
        One curve for each recording, in the unit of the quantity.
    role
        ``calibrate``, or ``validate``: held out of the fit, to validate it.
    quantity
        What the curves are of.
    order
        Mean of the numbers of its tests in the order in which they were made; NaN where that is not known.
    own
        History of each replicate's own drive where they differ, see `palpate.models.own_loads`; none where all
        follow that of the condition.
    """

    time: np.ndarray
    response: np.ndarray
    role: str = "calibrate"
    quantity: Quantity = DEPTH
    order: float = np.nan
    own: tuple[Protocol, ...] = ()

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
        protocol: Protocol,
        recordings: Sequence[Recording],
        role: str = "calibrate",
        observable: Observable | None = None,
    ) -> Observation:
        """Resample recordings on the sample times, see `palpate.observables.observable.Observable.of_recording`.

        Parameters
        ----------
        protocol
            History of the condition.
        recordings
            Replicates of one condition.
        role
            ``calibrate`` or ``validate``.
        observable
            What they are compared by, at a scale of one (`Quantity.of`); by default the response to the drive.

        Raises
        ------
        InputError
            When a recording ends before the last sample time by more than 2 % of the test.
        """
        time = protocol.sample_time
        for recording in recordings:
            if recording.time[-1] < WHOLE * time[-1]:
                raise InputError(
                    f"recording {recording.name} ends at {recording.time[-1]:g} s, its condition at {time[-1]:g} s",
                    remedy="give a complete recording or correct the times of the condition",
                )
        observable = observable or response_to(protocol)
        rows = [observable.of_recording(protocol, each.time, each.load, each.depth) for each in recordings]
        numbers = [np.nan if each.test_number is None else each.test_number for each in recordings]
        return cls(time, np.array(rows), role, Quantity(observable), float(np.mean(numbers)))

    @property
    def mean(self) -> np.ndarray:
        """Mean curve (n_points,)."""
        return self.response.mean(axis=0)

    def as_depth(self) -> Observation:
        """Return what was measured in nm."""
        quantity = replace(DEPTH, share=self.quantity.share)
        return replace(self, response=self.quantity.nm * self.response, quantity=quantity)


def in_order(conditions: Sequence[Condition], recorded: Mapping[str, Observation]) -> tuple[Condition, ...]:
    """Return conditions that know when their recordings were made, in tests since the mean one, where that is known."""
    every = {name: item.order for name, item in recorded.items() if np.isfinite(item.order)}
    counts = [len(recorded[name].response) for name in every]
    mean = np.average(list(every.values()), weights=counts) if every else 0.0
    return tuple(replace(c, order=every[c.name] - float(mean)) if c.name in every else c for c in conditions)
