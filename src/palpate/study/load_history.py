"""The prescribed history from the keys of a configuration: a trapezoid, a constant strain rate, or cycles.

- ``max_load, loading_time, hold_time, unloading_time``: linear loading, hold, linear unloading.
- ``max_load, strain_rate, hold_time, unloading_time``: loading at a constant indentation strain rate. Under a sharp
  indenter the load of a body without a length grows like h^2, so that (dh/dt) / h = r needs

      P = P_0 exp(2 r (t - t_0)).

  The load rises to P_0 = `start_fraction` of the largest along the tangent of that curve, which begins at zero load
  t_0 = 1 / (2 r) earlier. Source: B. N. Lucas and W. C. Oliver, Metall. Mater. Trans. A 30 (1999) 601-610.
- ``times, loads``: corners of any piecewise linear history, such as several cycles; it begins at zero time and load,
  whether that corner is listed or not.

With ``drive: displacement`` the same keys describe the displacement of a transducer, with ``max_displacement`` in place
of ``max_load`` and ``displacements`` in place of ``loads``; ``spring`` is the transducer's stiffness, and it is rigid
without.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palpate.base.parameters import Parameter, check_values, is_finite_number
from palpate.errors import InputError
from palpate.study.protocol import DISPLACEMENT, LOAD, Protocol, sampled, trapezoid

MAX_LOAD = Parameter("max_load", "P", "mN", 1e-9, 1e6, "largest load")
HOLD_TIME = Parameter("hold_time", "t_h", "s", 0.0, 1e9, "duration of the hold at the largest load", default=0.0)
UNLOADING_TIME = Parameter("unloading_time", "t_u", "s", 1e-6, 1e9, "duration of unloading")
POINTS = Parameter("points", "n", "-", 4, 100000, "number of points on the curve", default=100.0, whole=True)
LOADING_TIME = Parameter("loading_time", "t_l", "s", 1e-6, 1e9, "duration of loading")
STRAIN_RATE = Parameter("strain_rate", "r", "1/s", 1e-9, 1e6, "indentation strain rate (dh/dt) / h of loading")
START_FRACTION = Parameter(
    "start_fraction", "P_0/P", "-", 1e-4, 0.5, "part of the largest load at which constant strain rate sets in",
    default=0.01,
)  # fmt: skip
MAX_DISPLACEMENT = Parameter("max_displacement", "z", "nm", 1e-6, 1e9, "largest displacement of the transducer")
SPRING = Parameter("spring", "k", "mN/nm", 1e-12, 1e6, "stiffness of the transducer")
TRAPEZOID = (MAX_LOAD, LOADING_TIME, HOLD_TIME, UNLOADING_TIME, POINTS)
RAMP = (MAX_DISPLACEMENT, LOADING_TIME, HOLD_TIME, UNLOADING_TIME, POINTS)
EXPONENTIAL = (MAX_LOAD, STRAIN_RATE, START_FRACTION, HOLD_TIME, UNLOADING_TIME, POINTS)
SHAPES = (
    "max_load", "max_displacement", "loading_time", "hold_time", "unloading_time", "strain_rate", "start_fraction",
    "times", "loads", "displacements",
)  # fmt: skip
KEYS = ("drive", "spring", *SHAPES)
CHORD = 1e-3  # of the load, by which an exponential may lie below its chord


def protocol_from(values: Mapping[str, Any]) -> Protocol:
    """Build the history that the keys describe.

    Raises
    ------
    InputError
        When a key is unknown, missing, out of range, or belongs to another kind of history.
    """
    control, compliance, values = control_from(values)
    if {"times", "loads", "displacements"} & set(values):
        points = int(POINTS.check(values.get("points", POINTS.default)))
        return cycles(*_corners(values, f"{control}s"), points, control, compliance)
    if "strain_rate" in values and control == LOAD:
        checked = check_values(EXPONENTIAL, values, "protocol")
        points = int(checked.pop("points"))
        return constant_strain_rate(**checked, points=points)
    ramp = check_values(TRAPEZOID if control == LOAD else RAMP, values, "protocol")
    largest, loading_time, hold_time, unloading_time, given = ramp.values()
    return trapezoid(largest, loading_time, hold_time, unloading_time, int(given), control, compliance)


def control_from(values: Mapping[str, Any]) -> tuple[str, float, dict[str, Any]]:
    """Return what is prescribed, the compliance of the transducer [nm/mN], and the keys that say neither.

    Raises
    ------
    InputError
        When a load is asked for through a spring, or the spring is out of range.
    """
    rest = {key: value for key, value in values.items() if key not in ("drive", "spring")}
    control = values.get("drive", LOAD)
    if control not in (LOAD, DISPLACEMENT):
        raise InputError(f"drive is {control!r}", remedy=f"use one of: {LOAD}, {DISPLACEMENT}", place="drive")
    if control == LOAD:
        for key in ("spring", "max_displacement", "displacements"):
            if key in values:
                raise InputError(
                    f"{key} is given, but the load is prescribed", remedy="add drive: displacement", place=key
                )
        return control, 0.0, rest
    spring = SPRING.check(values["spring"]) if "spring" in values else np.inf
    return control, 1.0 / spring, rest


def constant_strain_rate(
    max_load: float,
    strain_rate: float,
    start_fraction: float,
    hold_time: float,
    unloading_time: float,
    points: int = 100,
) -> Protocol:
    """Load exponentially in time, hold, and unload linearly to zero; see the module.

    The exponential is followed by chords that stay within 0.1 % of it.

    Parameters
    ----------
    max_load
        [mN]
    strain_rate
        [1/s]
    start_fraction
        Load at which the exponential begins, as a part of the largest.
    hold_time, unloading_time
        [s]; `hold_time` may be zero.
    points
        Number of samples, spread evenly in time within each segment; time zero is not one of them.
    """
    rise = 0.5 / strain_rate
    growth = -np.log(start_fraction)
    logarithm = np.linspace(-growth, 0.0, int(np.ceil(growth / np.sqrt(8 * CHORD))) + 1)
    time = rise * (1.0 + growth + logarithm)
    load = max_load * np.exp(logarithm)
    ends = [time[-1]] + [time[-1] + hold_time] * (hold_time > 0) + [time[-1] + hold_time + unloading_time]
    knot_time = np.concatenate([[0.0], time, ends[1:]])
    knot_drive = np.concatenate([[0.0], load, [max_load] * (hold_time > 0), [0.0]])
    return Protocol(knot_time, knot_drive, sampled(ends, points))


def cycles(
    times: Sequence[float],
    drive: Sequence[float],
    points: int = 100,
    control: str = LOAD,
    compliance: float = 0.0,
) -> Protocol:
    """Follow straight lines through corners, from zero at time zero.

    Parameters
    ----------
    times, drive
        Corners [s], [mN] or [nm], in order; all are sampled.
    points
        Number of samples, shared among the segments as in `palpate.study.protocol.trapezoid`.
    control, compliance
        See `palpate.study.protocol.Protocol`.
    """
    return Protocol(np.append(0.0, times), np.append(0.0, drive), sampled(times, points), control, compliance)


def _corners(values: Mapping[str, Any], drives: str) -> tuple[list[float], list[float]]:
    for key in values:
        if key not in ("times", drives, "points"):
            raise InputError(f"times and {drives} exclude {key}", remedy="keep one kind of history", place=str(key))
    found = []
    for key in ("times", drives):
        given = values.get(key)
        if not isinstance(given, list) or not given or not all(map(is_finite_number, given)):
            raise InputError(f"{key} is {given!r}, expected a list of numbers", remedy="list the corners", place=key)
        found.append([float(number) for number in given])
    times, drive = found
    one = drives.removesuffix("s")
    if len(times) != len(drive):
        raise InputError(
            f"{len(times)} times and {len(drive)} {drives} are given",
            remedy=f"give a {one} for each time",
            place=drives,
        )
    if times[0] == 0.0:
        if drive[0] != 0.0:
            raise InputError(
                f"the {one} at time zero is {drive[0]:g}", remedy=f"begin at contact, at zero {one}", place=drives
            )
        times, drive = times[1:], drive[1:]
    if not times or not np.all(np.diff([0.0, *times]) > 0.0):
        raise InputError("the times do not increase from zero", remedy="give times after contact in s", place="times")
    return times, drive
