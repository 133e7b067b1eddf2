"""What the instrument imposes, a load or a displacement, and the times at which the response is recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError

LOAD, DISPLACEMENT = "load", "displacement"
LEAST_STEP = 1e-8  # of the test, the shortest that a segment, or the way from one sample to the next, may last


@dataclass(frozen=True, eq=False)
class Protocol:
    """A piecewise linear history of what is prescribed, the drive, with its sampling times.

    Under load control the drive is the load, and the depth is the response; a spring beside the body, of stiffness S,
    adds to the load that acts, P + S h. Under displacement control it is the
    displacement z of a transducer of compliance C in series with the body, and load F and depth h are the response
    together:

        z(t) = h + C F.

    Parameters
    ----------
    knot_time, knot_drive : ndarray, shape (k,)
        Corners of the history [s], [mN] or [nm]; the first knot is at time zero.
    sample_time : ndarray, shape (n,)
        Times at which a recording has points [s], increasing, within the history, all positive.
    control
        ``load`` or ``displacement``.
    compliance
        Of the transducer under displacement control [nm/mN]; zero for a rigid one.
    spring
        Load that a spring adds per depth under load control [mN/nm].

    Raises
    ------
    InputError
        If times do not increase, a load is negative, or nothing is loaded at all.
    """

    knot_time: np.ndarray
    knot_drive: np.ndarray
    sample_time: np.ndarray
    control: str = LOAD
    compliance: float = 0.0
    spring: float = 0.0

    def __post_init__(self) -> None:
        if self.control not in (LOAD, DISPLACEMENT):
            raise InputError(f"drive is {self.control!r}", remedy=f"use one of: {LOAD}, {DISPLACEMENT}", place="drive")
        time, drive, sample = (np.asarray(a, dtype=float) for a in (self.knot_time, self.knot_drive, self.sample_time))
        for name, value in (("knot_time", time), ("knot_drive", drive), ("sample_time", sample)):
            object.__setattr__(self, name, value)
            if value.ndim != 1 or not np.all(np.isfinite(value)):
                raise InputError(f"{name} must be a finite 1D array", remedy="remove missing values", place=name)
        history = f"{self.control} history"
        if len(time) < 2 or len(time) != len(drive):
            raise InputError(
                f"the {history} needs at least two points", remedy=f"give times and {self.control}s of equal number"
            )
        if time[0] != 0.0 or np.any(np.diff(time) <= 0):
            raise InputError(f"times of the {history} must start at 0 and increase", remedy="sort or correct the times")
        if drive.max() <= 0 or (self.control == LOAD and np.any(drive < 0)):
            wanted = "none negative and a positive maximum" if self.control == LOAD else "a positive maximum"
            raise InputError(
                f"{self.control}s are {drive.min():g} to {drive.max():g} {self.unit}, expected {wanted}",
                remedy=f"check sign and unit ({self.unit})",
                place=f"{self.control}s",
            )
        if len(sample) == 0 or np.any(np.diff(sample) <= 0) or sample[0] <= 0 or sample[-1] > time[-1] * (1 + 1e-12):
            raise InputError(
                "sample times must be positive, increasing and within the history", remedy="correct the times"
            )
        shortest = min(np.diff(time).min(), np.diff(sample).min(initial=np.inf))
        if shortest < LEAST_STEP * time[-1]:
            raise InputError(
                f"a step of {shortest:.3g} s in a test of {time[-1]:.3g} s is too short to be resolved",
                remedy="leave the shortest segment out, or let it last longer",
                place="protocol",
            )

    @property
    def unit(self) -> str:
        """Unit of the drive."""
        return "mN" if self.control == LOAD else "nm"

    @property
    def largest_drive(self) -> float:
        """Largest load [mN] or displacement [nm] that is prescribed."""
        return float(self.knot_drive.max())

    @property
    def sample_drive(self) -> np.ndarray:
        """Drive at the sampling times, shape (n,)."""
        return self.drive_at(self.sample_time)

    def drive_at(self, time: np.ndarray) -> np.ndarray:
        """Drive at any times (n,) [s]."""
        return np.interp(time, self.knot_time, self.knot_drive)

    def drive_of(self, load: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Return the drive (n,) under which an instrument recorded this load (n,) [mN] and depth (n,) [nm]."""
        return drive_of(self.control, self.compliance, load, depth)

    @property
    def knot_load(self) -> np.ndarray:
        """Load at the corners [mN], shape (k,); raises `InputError` where it is not prescribed."""
        if self.control != LOAD:
            raise InputError(
                "the load of a test under displacement control is not known beforehand, as is asked for here",
                remedy="use a test under load control",
                place="drive",
            )
        return self.knot_drive

    @property
    def max_load(self) -> float:
        """Largest load [mN]; raises `InputError` where it is not prescribed."""
        return float(self.knot_load.max())

    @property
    def sample_load(self) -> np.ndarray:
        """Load at the sampling times [mN], shape (n,); raises `InputError` where it is not prescribed."""
        return self.load_at(self.sample_time)

    def load_at(self, time: np.ndarray) -> np.ndarray:
        """Load at any times (n,) [s] [mN]; raises `InputError` where it is not prescribed."""
        return np.interp(time, self.knot_time, self.knot_load)


def drive_of(control: str, compliance: float, load: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the drive (n,), see `Protocol`, under which a load (n,) [mN] and a depth (n,) [nm] were recorded."""
    return load if control == LOAD else depth + compliance * load


def trapezoid(
    largest: float,
    loading_time: float,
    hold_time: float,
    unloading_time: float,
    points: int = 100,
    control: str = LOAD,
    compliance: float = 0.0,
) -> Protocol:
    """Linear loading, hold and linear unloading to zero, sampled evenly in time within each segment.

    Points are shared among the segments in proportion to their durations, at least two each; the ends of all
    segments are sampled, so the peak and the end of the hold are never missed.

    Parameters
    ----------
    largest
        Load [mN] or displacement [nm].
    loading_time, hold_time, unloading_time
        [s]; `hold_time` may be zero.
    points
        Number of samples; time zero is not one of them.
    control, compliance
        See `Protocol`.

    Raises
    ------
    InputError
        When a size or a time has the wrong sign, or there are fewer than two points for each segment.
    """
    if largest <= 0 or loading_time <= 0 or unloading_time <= 0 or hold_time < 0:
        raise InputError(
            f"max_{control}, loading_time and unloading_time must be positive and hold_time not negative",
            remedy="correct the protocol",
        )
    durations = [d for d in (loading_time, hold_time, unloading_time) if d > 0]
    ends = np.cumsum(durations)
    drive = np.array([0.0, *[largest] * (len(durations) - 1), 0.0])
    return Protocol(np.concatenate([[0.0], ends]), drive, sampled(ends, points), control, compliance)


def sampled(ends: Sequence[float] | np.ndarray, points: int) -> np.ndarray:
    """Return sampling times (points,) [s], even within each segment, for segments that end at `ends` [s].

    Raises
    ------
    InputError
        When there are fewer than two points for each segment.
    """
    durations = np.diff(ends, prepend=0.0)
    counts = np.maximum(2, np.round(durations / durations.sum() * points)).astype(int)
    counts[int(np.argmax(counts))] += points - counts.sum()
    if counts.min() < 2:
        raise InputError(f"points = {points} is too few", remedy="use at least two a segment", place="points")
    starts = np.concatenate([[0.0], ends[:-1]])
    return np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b, n in zip(starts, ends, counts, strict=True)])
