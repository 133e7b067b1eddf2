"""How the ends of the time steps, and the load there, move with parameters that move the load history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError
from palpate.protocol import Protocol


@dataclass(frozen=True, eq=False)
class Shift:
    """The load history a little below and a little above a parameter's value.

    Parameters
    ----------
    index
        Which of the parameters.
    low, high : Protocol
    width
        Distance between the two values.
    """

    index: int
    low: Protocol
    high: Protocol
    width: float


@dataclass(frozen=True, eq=False)
class Clock:
    """The time steps of a simulation, and where they move.

    Parameters
    ----------
    ends : ndarray, shape (s,)
        Ends of the steps [s].
    moved : tuple
        For each shift of the load history, the ends below and above it.
    shifts : tuple of Shift
    count
        Number of parameters.

    Raises
    ------
    InputError
        When a shift adds or removes a step: a corner of the load history meets a sampling time.
    """

    ends: np.ndarray
    moved: tuple[tuple[np.ndarray, np.ndarray], ...]
    shifts: tuple[Shift, ...]
    count: int

    def __post_init__(self) -> None:
        if any(len(ends) != len(self.ends) for pair in self.moved for ends in pair):
            raise InputError(
                "the depth has no derivative where a corner of the moving load history meets a sampling time, "
                "as all do without a lag",
                remedy="change the lag a little",
                place="parameters",
            )

    def changes(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the changes (p,) of a `time` at which a step ends [s], and of the load then [mN]."""
        d_time, d_load = np.zeros(self.count), np.zeros(self.count)
        for shift, ends in zip(self.shifts, self.moved, strict=True):
            low, high = (np.interp(time, np.append(0.0, self.ends), np.append(0.0, moved)) for moved in ends)
            d_time[shift.index] = (high - low) / shift.width
            d_load[shift.index] = (shift.high.load_at(high) - shift.low.load_at(low)) / shift.width
        return d_time, d_load
