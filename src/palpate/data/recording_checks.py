"""Whether a recording can be one of a condition: its points, signs, drive, duration and depth."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np

from indentation_files.readers.units import CHANNELS, to_turn
from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.observation import WHOLE
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.study.alignment import aligned, stretched
from palpate.study.indenter import Indenter
from palpate.study.protocol import LOAD, Protocol
from palpate.study.recorded_history import averaged_noise

LOAD_TOLERANCE = 0.05  # of the largest drive, by which it may differ from its condition's
LEAST_POSITIVE = 0.05  # of what a channel falls below zero: less above it means the wrong sign
SHALLOWEST = 0.2  # elastic depths of the stiffest modulus; see `_check_one`
DEEPEST = 30.0  # elastic depths of the softest; likewise
OWN_SIZE = 0.5  # by which the largest loads of tests with loads of their own may differ from their condition's
OWN_COURSE = 0.1  # and the courses of these, each in its largest
OWN_DURATION = 3.0  # ratio of their durations, chosen: half a load at one rate takes half as long, a minute is 60 s
NOISE_PEAK = 4.0  # standard deviations by which noise lets a largest value stick out
DEEPEST_IN_SPHERE = 3.0  # radii; a zero point that is off by a radius is not a mistaken unit
UNITS_OF_TIME = {1e3: "in ms", 60.0: "in s, not min", 1 / 60: "in min", 1e-3: "in s, not ms"}  # by ratios of durations
ELSEWHERE = "give the test a condition of its own, or remove it"
NEAR = 1.5  # of such a ratio: tests of one condition end a little earlier or later


def checked_recording(study: Study, condition: Condition, recording: Recording) -> Recording:
    """Return the recording from contact on, on the clock of its condition where that follows a recorded load, checked.

    Raises
    ------
    InputError
        When points are too few, load or depth is negative, or the recording is not one of the condition.
    """
    count = len(study.free_parameters)
    if len(recording) <= count:
        raise InputError(f"has {len(recording)} points for {count} free parameters", remedy="export the whole curve")
    for channel, values in (("load", recording.load), ("depth", recording.depth)):
        if values.max() < LEAST_POSITIVE * -values.min():
            unit = CHANNELS[channel]
            raise InputError(
                f"the {channel} is negative, down to {values.min():.4g} {unit}: its sign is wrong",
                remedy=to_turn(channel),
                place=f"{channel}_{unit}",
            )
    if recording.test_number is None:
        for key in [key for key in study.diagnosis.mechanisms if MECHANISMS[key].by_test_order]:
            raise InputError(
                f"does not say when it was made, which diagnosis.mechanisms: {key} needs",
                remedy="write a line such as '# test_number: 7' above its header, in the order of the tests",
                place="test_number",
            )
    begun = recording.from_contact(condition.protocol.drive_of(recording.load, recording.depth))
    if condition.follows and not condition.own_loads:
        begun = aligned(begun, condition.protocol)
    _check_one(study, condition, begun)
    return begun


def _check_one(study: Study, condition: Condition, recording: Recording) -> None:
    """Check drive, duration and depth.

    No body is shallower than an elastic one of its modulus, and soft metals in long creep lie within about ten times
    that depth; a unit mistaken by 1000 moves the depth at a given load by 1000, and that load's elastic depth by 30 or
    more. Depths outside 1/5 to 30 elastic depths of the grid's moduli are therefore taken for a mistaken unit.
    """
    check_drive(condition.protocol, recording, condition.own_loads, bool(condition.follows))
    tip, depth = study.tip_of(condition), recording.depth.max()
    low, high = tip.holds_between
    if not low < depth < high:
        raise InputError(
            f"the largest depth is {depth:.4g} nm, the tip's area function is positive and grows from {low:.4g} to "
            f"{high:.4g} nm",
            remedy="use an area function that was calibrated at the depths of the test",
            place="depth_nm",
        )
    if tip.shape == "sphere" and depth > DEEPEST_IN_SPHERE * tip.radius:
        raise InputError(
            f"the largest depth is {depth:.4g} nm, under a sphere of {tip.radius:g} nm; is the radius in um?",
            remedy="write indenter.radius in nm",
            place="depth_nm",
        )
    elastic = [depth for modulus in _moduli(study) for depth in elastic_depths(tip, recording.load.max(), modulus)]
    for wrong, question in (
        (depth < SHALLOWEST * min(elastic), "are depths in micrometres, or loads in uN?"),
        (depth > DEEPEST * max(elastic), "are depths in pm, or loads in N?"),
    ):
        if wrong:
            raise InputError(
                f"the largest depth is {depth:.4g} nm, where elastic bodies of the study's moduli give "
                f"{min(elastic):.4g} to {max(elastic):.4g} nm; {question}",
                remedy="write depths in nm and loads in mN, or correct the moduli",
                place="depth_nm",
            )


def check_drive(protocol: Protocol, recording: Recording, own_loads: bool = False, followed: bool = False) -> None:
    """Check that what was prescribed in a recording is what a protocol prescribes, to a twentieth of the largest.

    Where tests have loads of their own, their course is compared; their size may differ by a half, and their duration
    by `OWN_DURATION`.

    Parameters
    ----------
    protocol, recording
    own_loads
        Whether tests have loads of their own.
    followed
        Whether the protocol follows a recorded load, so that a study states no times that could be corrected.

    Raises
    ------
    InputError
        When the largest load or displacement, the duration, or the history differs.
    """
    control, unit = protocol.control, protocol.unit
    drive = protocol.drive_of(recording.load, recording.depth)
    peak, expected = drive.max(), protocol.largest_drive
    place = "load_mN" if control == LOAD else "depth_nm"
    noise = partial(averaged_noise, recording.time, drive)  # it takes long, and counts only where a test differs
    apart, allowed = abs(peak / expected - 1), OWN_SIZE if own_loads else LOAD_TOLERANCE
    if apart > allowed and apart > allowed + NOISE_PEAK * noise() / expected:
        wrong = ("loads in uN", "loads in N") if control == LOAD else ("depths in pm", "depths in um")
        hint = f"; are {wrong[0]}?" if peak > 100 * expected else f"; are {wrong[1]}?" if peak < expected / 100 else ""
        raise InputError(
            f"the largest {control} is {peak:.4g} {unit}, the condition's is {expected:.4g} {unit}{hint}",
            remedy=f"correct the unit{'' if control == LOAD else ', the spring'} or max_{control}",
            place=place,
        )
    duration, times = recording.time[-1], protocol.sample_time
    _check_duration(duration, times[-1], own_loads, followed)
    if own_loads:
        recording, drive = stretched(protocol, recording), drive * (expected / peak)
    departure = np.interp(times, np.append(0.0, recording.time), np.append(0.0, drive))
    departure -= protocol.sample_drive
    allowed = (OWN_COURSE if own_loads else LOAD_TOLERANCE) * expected
    course = float(np.sqrt(np.mean(departure**2)))
    if course > allowed and course > np.hypot(allowed, noise()):
        worst = int(np.argmax(np.abs(departure)))
        question = _unit_of_time(duration / times[-1])
        hint = f"; it lasts {duration:.4g} s, {question}" if question else ""
        raise InputError(
            f"the {control} departs from the condition's, by {departure[worst]:.3g} {unit} at {times[worst]:.4g} "
            f"s{hint}",
            remedy=ELSEWHERE if followed else "correct the times of the condition, or give it `load_history: recorded`",
            place=place,
        )


def _check_duration(duration: float, expected: float, own_loads: bool, followed: bool) -> None:
    """Check the duration [s] of a recording against that of its condition, as `check_drive` does."""
    question = _unit_of_time(duration / expected)
    hint = f"; {question}" if question else ""
    if duration < (1 / OWN_DURATION if own_loads else WHOLE) * expected:
        raise InputError(
            f"ends after {duration:.4g} s, the condition lasts {expected:.4g} s{hint}",
            remedy=f"export the whole test or {ELSEWHERE if followed else 'correct the times'}",
            place="time_s",
        )
    if own_loads and duration > OWN_DURATION * expected:
        raise InputError(
            f"lasts {duration:.4g} s, the condition {expected:.4g} s{hint}",
            remedy=f"correct the unit of time, or {ELSEWHERE}",
            place="time_s",
        )


def _unit_of_time(ratio: float) -> str:
    """Return the question which unit of time was mistaken, where the ratio of two durations suggests it."""
    found = (unit for factor, unit in UNITS_OF_TIME.items() if 1 / NEAR < ratio / factor < NEAR)
    return next((f"are times {unit}?" for unit in found), "")


def _moduli(study: Study) -> Iterable[float]:
    return study.levels.get("youngs_modulus") or (study.fixed["youngs_modulus"],)


def elastic_depths(indenter: Indenter, load: float, modulus: float) -> list[float]:
    """Return the depth [nm] of an elastic, incompressible body under the cone (Sneddon) and the sphere (Hertz).

    A rounded cone has both, and its true depth lies between them.

    Parameters
    ----------
    load, modulus
        [mN], [GPa]; the effective modulus is 4/3 of Young's.
    """
    reduced, depths = 4 / 3 * modulus, []
    if np.isfinite(indenter.slope):
        depths.append(1e3 * float(np.sqrt(0.5 * np.pi * load / reduced * indenter.slope)))
    if indenter.radius:
        depths.append(1e3 * float((9 / 16 * (load / reduced) ** 2 / (indenter.radius * 1e-3)) ** (1 / 3)))
    return depths
