"""Where a vendor's test is made to begin: at the file's own contact, at the one found in it, or nowhere."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from pathlib import Path

import numpy as np

from indentation_files.borne_load import LEAST_RISE, check_borne
from indentation_files.channel_noise import noise_of
from indentation_files.contact_interval import VAGUE, interval_note
from indentation_files.contact_point import CLEAR, ContactPoint, first_touch, touch_at
from indentation_files.errors import InputError, located_in
from indentation_files.readers import in_air
from indentation_files.readers.source import numbers_of
from indentation_files.readers.units import CHANNELS, to_turn
from indentation_files.readers.vendor import Unreadable, VendorTest, read_or_report, unless_all_fail
from indentation_files.recording import BARELY_LOADED, Recording

Contact = str | float | Mapping[str, float]
CONTACTS = ("file", "auto", "none")
FOUND, GIVEN = "found by palpate", "given by the user"
DECIDED = re.compile(rf"contact ({FOUND}|{GIVEN}): at (\S+) nm")
WORDS = {"tilt": "a tilt", "drift": "a drift", "sine": "a wave", "transient": "the stage's start"}
OFF_ZERO = 0.05  # of the way to the largest load
NEGATIVE = 0.01  # of the load's range, chosen: a negative load where a test begins is told from there on
COUNTED = 0.005  # of the test's depth, chosen: a zero that lies farther from where a test begins is told
LAST_FREE = 10  # points of an approach from which the load without contact is taken


def zeroed(test: VendorTest, contact: str | float) -> VendorTest:
    """Return a test whose time, load and depth are zero at contact; it begins there and ends when the tip has left.

    The `test` has its approach, and its time is zero at the file's contact. `contact` is ``file``: the approach is cut
    off, nothing else is touched; where the file marks no contact and the test begins in air, contact is found.
    ``auto``: contact is found (`first_touch`). ``none``: the test stays whole. A number: contact is where the tip first
    comes to this depth [nm].

    Whatever is odd about a contact gets a warning: air after the file's, a load that is not zero before it, a wide
    interval, or one far from the file's own.

    Raises `InputError` when the contact is neither of these, load or depth has the wrong sign or never changes, the tip
    never comes to the depth given, or too few points are left to find contact in.
    """
    r = test.recording
    if contact not in CONTACTS if isinstance(contact, str) else not isinstance(contact, Real):
        raise InputError(f"contact {contact!r} is not known", remedy=f"give a depth or one of: {', '.join(CONTACTS)}")
    if contact == "none":
        return test
    _check_signs(test.name, r)
    try:
        check_borne(r)
    except InputError as error:
        test = replace(test, warnings=(*test.warnings, error.problem))
    if contact == "file":
        return _from_the_file_s(test)
    with located_in(place=test.name):
        found = first_touch(r.time, r.load, r.depth) if contact == "auto" else None
        point = found or touch_at(float(contact), r.time, r.load, r.depth)
    messages = () if found is None else (*_vague(r, found), *_far_from_the_file_s(test, found))
    messages = (*_subtracted(r, point), *messages)
    begins = begun(r, point, FOUND if found else GIVEN)
    look = in_air.retreats_at_start if found else in_air.air_at_start
    air = look(begins, remedy="--contact NM puts contact elsewhere")
    return _ended(test, begins, (*messages, *air, *in_air.sloping(r, point.index)))


def _from_the_file_s(test: VendorTest) -> VendorTest:
    """Return a test that begins at the file's contact; where it marks none and begins in air, at the one found."""
    r = test.recording
    begin = int(np.argmax(r.time >= 0))
    moving, rested = in_air.without_rest(r.at(slice(begin, None)))
    sought, air = (moving, None) if test.marked else _sought(r, moving)
    if air is None:
        if rested:
            moving = replace(moving, time=moving.time - moving.time[0])
        moving, counted = (moving, ()) if test.marked else _counted_from_the_start(moving, _level(r.load, begin))
        if begins_off_contact(moving):
            counted = (*counted, f"begins at a depth of {moving.depth[0]:.4g} nm, not at contact ({in_air.FINDS})")
        messages = (
            *rested,
            *counted,
            *((test.marked and in_air.risen_before(r, begin)) or _loaded_before(r.load, begin) or _under_load(moving)),
            *(in_air.air_at_start if test.marked else in_air.retreats_at_start)(moving),
            *in_air.sloping(r, begin),
        )
        return _ended(test, moving, messages)
    share = 100 * in_air.share_in_air(sought, air)
    message = f"the file marks no contact, the load does not rise over the first {share:.2g} % of the depth"
    retreat = in_air.retreat_before(sought, air)
    if retreat > in_air.SHARE * (float(sought.depth.max()) - air.depth):
        message += f", and the tip retreats by {retreat:.3g} nm before contact"
    message += f": begins at the contact found, {_place(air)} (--contact none keeps all)"
    messages = (message, *_subtracted(sought, air), *_vague(sought, air), *in_air.sloping(sought, air.index))
    return _ended(test, begun(sought, air, FOUND), messages)


def _sought(whole: Recording, moving: Recording) -> tuple[Recording, ContactPoint | None]:
    """Return the recording in which contact was sought, and the one found; None where the test begins at contact.

    The part from where the reader begins is searched first. Where that begins off contact or in air, or leaves contact
    vague, the retreat before it shows the load without contact.
    """
    air = in_air.air_before(moving)
    if len(whole) == len(moving) or (air and not _is_vague(moving, air)):
        return moving, air
    if air or begins_off_contact(moving) or in_air.seems_in_air(moving):
        before = in_air.air_before(whole)
        return (whole, before) if before or not air else (moving, air)
    return moving, None


def _ended(test: VendorTest, recording: Recording, messages: tuple[str, ...]) -> VendorTest:
    """Return the test with a recording from contact on, up to the tip's retreat, and messages on it."""
    ended, of_end = in_air.until_retreat(recording)
    return replace(test, recording=ended, warnings=(*test.warnings, *messages, *of_end))


def _is_vague(recording: Recording, point: ContactPoint) -> bool:
    """Return whether the interval of a contact that was found is wide."""
    return point.upper - point.lower > VAGUE * (float(recording.depth.max()) - point.depth)


def _vague(recording: Recording, point: ContactPoint) -> tuple[str, ...]:
    """Return a warning where the interval of a contact that was found is wide, or its baseline not level."""
    if not _is_vague(recording, point):
        return ()
    depth, wide = float(recording.depth.max()) - point.depth, point.upper - point.lower
    bent = [WORDS[term] for term in WORDS if term in point.baseline_terms]
    because = f" (the load in air shows {', '.join(bent)})" if bent else ""
    return (
        f"contact is known to {point.lower:.4g} to {point.upper:.4g} nm only, {wide / max(depth, 0.01 * wide):.0%} of "
        f"the test's depth{because}: a diagnosis tries every zero of the depth within it",
    )


def _subtracted(recording: Recording, point: ContactPoint) -> tuple[str, ...]:
    """Return a message where what the load reads at contact, and is subtracted from all of it, is not within noise."""
    largest = float(recording.load.max()) - point.load
    if abs(point.load) <= max(CLEAR * noise_of(recording.load), BARELY_LOADED * largest):
        return ()
    return (f"the load reads {point.load:.3g} mN at contact, which is subtracted from all of it",)


def _far_from_the_file_s(test: VendorTest, point: ContactPoint) -> tuple[str, ...]:
    """Return a warning where a contact that was found lies further from the file's mark than the test is deep."""
    r = test.recording
    if not test.marked:
        return ()
    own = float(np.interp(0.0, r.time, r.depth))
    if abs(point.depth - own) <= float(r.depth.max()) - max(own, point.depth):
        return ()
    return (
        f"the contact found, {point.depth:.4g} nm, lies {abs(point.depth - own):.4g} nm from the file's own, more than "
        "the test is deep: look at both (--survey)",
    )


def zeroed_each(
    path: Path, tests: Sequence[VendorTest | Unreadable], contact: Contact
) -> list[VendorTest | Unreadable]:
    """Return the tests of a file as `zeroed` makes them; raises the first one's `InputError` when none can begin.

    Depths for single tests are given by the tests' names or numbers; the others begin at the file's contact. Raises
    `InputError` when a test is named that the file does not hold.
    """
    chosen = chosen_contacts([test.name for test in tests], contact)
    return unless_all_fail(
        [
            read_or_report(path, test.name, zeroed, test, where) if isinstance(test, VendorTest) else test
            for test, where in zip(tests, chosen, strict=True)
        ]
    )


def chosen_contacts(names: Sequence[str], contact: Contact) -> list[str | float]:
    """Return the contact of each test; raises `InputError` when one is named that is none of them."""
    if not isinstance(contact, Mapping):
        return [contact] * len(names)
    numbers = list(map(str, numbers_of(names)))
    for named in map(str, contact):
        if named not in names and named not in numbers:
            problem, remedy = f"has no test {named!r}", f"use a number or one of: {', '.join(names)}"
            raise InputError(problem, remedy=remedy, place="source.contact")
    given = {str(key): depth for key, depth in contact.items()}
    return [given.get(name, given.get(number, "file")) for name, number in zip(names, numbers, strict=True)]


def decision(whole: Recording, begun_at: Recording) -> tuple[str, float]:
    """Return whose decision the contact of a recording is, in words, and its depth in the whole recording [nm]."""
    for note in begun_at.notes:
        found = DECIDED.match(note)
        if found:
            return found[1], float(found[2])
    peak, kept = int(np.argmax(whole.load)), int(np.argmax(begun_at.load))
    return "the file's own", float(whole.depth[peak] - begun_at.depth[kept])


def _check_signs(name: str, recording: Recording) -> None:
    """Refuse a test whose load or depth never changes, or falls where the tip presses."""
    load, depth, peak = recording.load, recording.depth, int(np.argmax(recording.load))
    for channel, recorded in (("load", load), ("depth", depth)):
        if np.ptp(recorded) == 0.0:
            problem = f"the {channel} is {recorded[0]:.4g} {CHANNELS[channel]} at all {len(recorded)} points"
            remedy = f"check which column holds the {channel}, or leave this test out"
            raise InputError(problem, remedy=remedy, place=name)
    for channel, wrong, values in (
        ("load", load[peak] - load[0] < LEAST_RISE * (load[0] - load.min()), (load[0], load.min())),
        ("depth", depth[peak] < depth[0], (depth[0], depth[peak])),
    ):
        if wrong:
            unit = CHANNELS[channel]
            problem = f"the {channel} falls from {values[0]:.4g} to {values[1]:.4g} {unit} where the tip presses"
            raise InputError(problem, remedy=f"{to_turn(channel)}, or export the loading too", place=name)


def _counted_from_the_start(r: Recording, level: float) -> tuple[Recording, tuple[str, ...]]:
    """Return a test of a file without a mark, its depth zero where it begins without load, and a message on that.

    Such a file counts its depth from elsewhere, as from where the load reaches a preload. Without load it reads the
    `level` [mN].
    """
    first, largest = float(r.depth[0]), float(np.ptp(r.depth))
    clear = max(CLEAR * noise_of(r.depth), COUNTED * largest)
    loaded = abs(r.load[0] - level) > max(CLEAR * noise_of(r.load), BARELY_LOADED * float(np.ptp(r.load)))
    if loaded or abs(first) <= clear:
        return r, ()
    said = f"the depth is counted from where the test begins, {first:.4g} nm of the file ({in_air.FINDS})"
    return replace(r, depth=r.depth - first), (said,)


def _under_load(r: Recording) -> tuple[str, ...]:
    """Return a warning where a test begins under load at zero depth: one of them is not counted from contact.

    A load that reads less than zero there is counted from elsewhere, too, be it by little.
    """
    peak, first = int(np.argmax(r.load)), float(r.load[0])
    little = max(NEGATIVE * float(np.ptp(r.load)), CLEAR * noise_of(r.load)) if first < 0 else OFF_ZERO * r.load[peak]
    if abs(first) <= little or abs(r.depth[0]) > OFF_ZERO * r.depth[peak]:
        return ()
    return (
        f"begins under {r.load[0]:.4g} of {r.load[peak]:.4g} mN at a depth of {r.depth[0]:.4g} nm: the load, or the "
        "depth, is not counted from contact",
    )


def begins_off_contact(recording: Recording) -> bool:
    """Return whether a test begins before zero depth, or beyond it without load."""
    load, depth, peak = recording.load, recording.depth, int(np.argmax(recording.load))
    far = OFF_ZERO * (depth[peak] - depth[0])
    return bool(depth[0] < -far or (depth[0] > far and load[0] <= BARELY_LOADED * load[peak]))


def _level(load: np.ndarray, begin: int) -> float:
    """Return what the load (n,) reads at the end of an approach that ends at point `begin`; zero without one [mN]."""
    return float(np.median(load[max(0, begin - LAST_FREE + 1) : begin + 1])) if begin else 0.0


def _loaded_before(load: np.ndarray, begin: int) -> tuple[str, ...]:
    """Return a warning where the last points of an approach that ends at point `begin` read a load."""
    level = _level(load, begin)
    noise = CLEAR * noise_of(load) / LAST_FREE**0.5
    if not begin or abs(level) <= max(BARELY_LOADED * load.max(), noise):
        return ()
    return (f"the load reads {level:.3g} mN before contact (--contact auto counts it from there)",)


def begun(recording: Recording, point: ContactPoint, by: str) -> Recording:
    """Return the recording from contact on, zero there in time, load and depth, with what was found as notes."""
    later = recording.time > point.time
    time, load, depth = (
        np.append(0.0, channel[later] - zero)
        for channel, zero in (
            (recording.time, point.time), (recording.load, point.load), (recording.depth, point.depth)
        )
    )  # fmt: skip
    stiffness = None if recording.stiffness is None else np.append(np.nan, recording.stiffness[later])
    notes = (
        *recording.notes,
        f"contact {by}: {_place(point)}, where the load read {point.load:.3g} mN, which is subtracted",
    )
    notes += (interval_note(point),) if by == FOUND else ()
    return replace(recording, time=time, load=load, depth=depth, notes=notes, stiffness=stiffness)


def _place(point: ContactPoint) -> str:
    """Return where in the file a contact is."""
    interval = f" (95 % interval {point.lower:.4g} to {point.upper:.4g})" if point.upper > point.lower else ""
    return f"at {point.depth:.6g} nm{interval} and {point.time:.4g} s of the file"
