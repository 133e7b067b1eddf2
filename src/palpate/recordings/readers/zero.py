"""Where a vendor's test is made to begin: at the file's own contact, at the one found in it, or nowhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.recordings.contact_point import ContactPoint, first_touch, noise_of, touch_at
from palpate.recordings.readers.units import CHANNELS, to_turn
from palpate.recordings.readers.vendor import Unreadable, VendorTest, attempt, unless_all_fail
from palpate.recordings.recording import BARELY_LOADED, Recording

CONTACTS = ("file", "auto", "none")
LEAST_RISE = 0.05
OFF_ZERO = 0.05  # of the way to the largest load
LAST_FREE = 10  # points of an approach that tell what the load reads without contact


def zeroed(test: VendorTest, contact: str | float) -> VendorTest:
    """Return a test whose time, load and depth are zero at contact; it begins there and ends when the tip has left.

    Parameters
    ----------
    test
        With its approach; time is zero at the file's contact.
    contact
        ``file``: the approach is cut off, nothing else is touched. ``auto``: contact is found (`first_touch`).
        ``none``: the test stays whole. A number: contact is where the tip first comes to this depth [nm].

    A test that begins at the file's contact but not at zero depth, or whose load is not zero before, gets a warning.

    Raises
    ------
    InputError
        When load or depth has the wrong sign or never changes, the tip never comes to the depth given, or too few
        points are left to find contact in.
    """
    r = test.recording
    if contact == "none":
        return test
    _check_signs(test.name, r)
    if contact == "file":
        begin = int(np.argmax(r.time >= 0))
        begun_by_file = until_retreat(r.at(slice(begin, None)))
        told = (*_off_zero(begun_by_file), *_loaded_before(r.load, begin))
        return replace(test, recording=begun_by_file, warnings=(*test.warnings, *told))
    if isinstance(contact, str) and contact not in CONTACTS:
        raise InputError(f"contact {contact!r} is not known", remedy=f"give a depth or one of: {', '.join(CONTACTS)}")
    try:
        if contact == "auto":
            point = first_touch(r.time, r.load, r.depth)
        else:
            point = touch_at(float(contact), r.time, r.load, r.depth)
    except InputError as error:
        raise error.located(place=test.name) from None
    return replace(test, recording=until_retreat(begun(r, point)))


def zeroed_each(
    path: Path, tests: Sequence[VendorTest | Unreadable], contact: str | float
) -> list[VendorTest | Unreadable]:
    """Return the tests of a file as `zeroed` makes them; raises the first one's `InputError` when none can begin."""
    return unless_all_fail(
        [attempt(path, test.name, zeroed, test, contact) if isinstance(test, VendorTest) else test for test in tests]
    )


def _check_signs(name: str, recording: Recording) -> None:
    """Refuse a test whose load or depth never changes, or falls where the tip presses."""
    load, depth, peak = recording.load, recording.depth, int(np.argmax(recording.load))
    for channel, recorded in (("load", load), ("depth", depth)):
        if np.ptp(recorded) == 0.0:
            raise InputError(
                f"the {channel} is {recorded[0]:.4g} {CHANNELS[channel]} at all {len(recorded)} points",
                remedy=f"check which column holds the {channel}, or leave this test out",
                place=name,
            )
    for channel, wrong, values in (
        ("load", load[peak] - load[0] < LEAST_RISE * (load[0] - load.min()), (load[0], load.min())),
        ("depth", depth[peak] < depth[0], (depth[0], depth[peak])),
    ):
        if wrong:
            unit = CHANNELS[channel]
            raise InputError(
                f"the {channel} falls from {values[0]:.4g} to {values[1]:.4g} {unit} where the tip presses",
                remedy=f"{to_turn(channel)}, or export the loading too",
                place=name,
            )


def _off_zero(recording: Recording) -> tuple[str, ...]:
    """Return a warning where contact is elsewhere than where a test begins."""
    if not begins_off_contact(recording):
        return ()
    return (f"begins at a depth of {recording.depth[0]:.4g} nm, not at contact (--contact auto finds the touch)",)


def begins_off_contact(recording: Recording) -> bool:
    """Return whether a test begins before zero depth, or beyond it without load."""
    load, depth, peak = recording.load, recording.depth, int(np.argmax(recording.load))
    far = OFF_ZERO * (depth[peak] - depth[0])
    return bool(depth[0] < -far or (depth[0] > far and load[0] <= BARELY_LOADED * load[peak]))


def _loaded_before(load: np.ndarray, begin: int) -> tuple[str, ...]:
    """Return a warning where the last points of an approach that ends at point `begin` read a load."""
    level = float(np.median(load[max(0, begin - LAST_FREE + 1) : begin + 1]))
    if not begin or abs(level) <= BARELY_LOADED * load.max():
        return ()
    return (f"the load reads {level:.3g} mN before contact (--contact auto counts it from there)",)


def begun(recording: Recording, point: ContactPoint) -> Recording:
    """Return the recording from contact on, zero there in time, load and depth, with what was found as a note."""
    later = recording.time > point.time
    time, load, depth = (
        np.append(0.0, channel[later] - zero)
        for channel, zero in (
            (recording.time, point.time), (recording.load, point.load), (recording.depth, point.depth)
        )
    )  # fmt: skip
    note = (
        f"contact at {point.depth:.4g} nm (95 % interval {point.lower:.4g} to {point.upper:.4g}) and "
        f"{point.time:.4g} s of the file, where the load read {point.load:.3g} mN"
    )
    stiffness = None if recording.stiffness is None else np.append(np.nan, recording.stiffness[later])
    notes = (*recording.notes, note)
    return replace(recording, time=time, load=load, depth=depth, notes=notes, stiffness=stiffness)


def until_retreat(recording: Recording) -> Recording:
    """Return the recording up to where its load falls below zero for good: there the tip hangs free."""
    loaded = np.flatnonzero(recording.load > 6 * noise_of(recording.load))
    last = int(loaded[-1]) if len(loaded) else len(recording) - 1
    free = np.flatnonzero(recording.load[last:] < 0)
    return recording.at(slice(last + int(free[0]) if len(free) else None))
