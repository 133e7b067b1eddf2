"""What of a test is none: rest before the instrument moves, air before the tip touches, and air after it has left."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from indentation_files.borne_load import OUTLIER
from indentation_files.channel_noise import noise_of
from indentation_files.contact_point import CLEAR, ContactPoint, first_touch, loading
from indentation_files.departure import Departure, departure
from indentation_files.errors import InputError
from indentation_files.recording import BARELY_LOADED, Recording

SHARE = 0.05  # of the test's depth beyond contact, chosen: air that is reported
PRESSED = 0.05  # of the largest load: what is above is no air
FIRST = 5  # points, chosen: the median of their loads is what the load in air is compared with
NEAR = 0.1  # of the way in, chosen: there the surface may pull on the tip
ENOUGH = 20  # points of an approach, chosen, that show how the load changes in air
STEPS_AT_REST = 3  # sampling steps, chosen: the first sample or two are where a test begins
LEAST_REST = 0.01  # of the time from the first movement to the largest load, chosen: a shorter rest is no matter
MOVES_LATE = 0.8  # of the time until a channel leaves its noise, chosen: what moves from the start rests for less
AVERAGES = 50  # of which a rest, or the loading after it, is made, chosen
ROUNDING = 1e-6  # of a channel's range: what a channel without noise may differ by
FINDS = "--contact auto finds the contact"


def air_before(recording: Recording) -> ContactPoint | None:
    """Return the contact of a recording that begins in air; None where it does not begin there.

    It does where the contact lies deeper than its first point by more than a share of the test's depth with its whole
    95 % interval, or by twice as much by the load in air alone, or where the tip retreats by as much before it touches.
    The search is made only where a load that stays in its noise, or leaves the air late, gives reason to.
    """
    left = _left(recording)
    rests = resting(recording.load, recording.depth) > SHARE
    if not (rests or _leaves_late(recording, left) or _retreats(recording)):
        return None
    try:
        point = first_touch(recording.time, recording.load, recording.depth)
    except InputError:
        return None
    far = SHARE * (float(recording.depth.max()) - point.depth)
    retreated = retreat_before(recording, point) > max(far, CLEAR * noise_of(recording.depth))
    surely = point.lower
    if left is not None and "zero" not in point.baseline_terms:
        surely = max(surely, min(point.depth, left.likely) - far)
    return point if retreated or surely > recording.depth[0] + far else None


def seems_in_air(r: Recording) -> bool:
    """Return whether the tip retreats at first, or a load shows air that stays in its noise and leaves the air late."""
    return _retreats(r) or (resting(r.load, r.depth) > SHARE and _leaves_late(r, _left(r)))


def retreat_before(recording: Recording, point: ContactPoint) -> float:
    """Return by how much the tip retreats between the first point and contact [nm]."""
    first = float(recording.depth[0])
    return first - float(recording.depth[: point.index + 1].min())


def share_in_air(recording: Recording, point: ContactPoint) -> float:
    """Return which share of the way to the largest depth, from where the tip retreats to, lies in air."""
    lowest = float(recording.depth[0]) - retreat_before(recording, point)
    return (point.depth - lowest) / max(float(recording.depth.max()) - lowest, 1e-300)


def resting(load: np.ndarray, depth: np.ndarray) -> float:
    """Return by which share of its largest the depth (n,) grows before the load (n,) leaves its noise.

    Where it leaves the level of its first points within these, it does not rest, and the share is zero.
    """
    smooth = median_filter(load, 5, mode="nearest")
    risen = smooth > np.median(smooth[:FIRST]) + CLEAR * max(noise_of(load), 1e-4 * float(np.ptp(load)))
    left = int(np.argmax(risen)) if risen.any() else len(load) - 1
    return 0.0 if left < FIRST else float(depth[left] - depth[0]) / max(float(np.ptp(depth)), 1e-300)


def _left(r: Recording) -> Departure | None:
    """Return where the load of the loading leaves the air; None where that is not seen."""
    first, last = loading(r.load, r.depth)
    return departure(r.load[first : last + 1], r.depth[first : last + 1])


def _leaves_late(r: Recording, left: Departure | None) -> bool:
    """Return whether the depth grows by much before the load stands clear of what it does in air."""
    return left is not None and left.clear - float(r.depth[0]) > SHARE * float(np.ptp(r.depth))


def _retreats(r: Recording) -> bool:
    """Return whether the tip moves away from where it begins before the load is largest."""
    retreat = _first_retreat(r)
    return retreat > SHARE * float(np.ptp(r.depth)) and retreat > CLEAR * noise_of(r.depth)


def _first_retreat(r: Recording) -> float:
    """Return by how much the tip moves away from where it begins, under no load to speak of [nm]."""
    before = slice(int(np.argmax(r.load)) + 1)
    free = r.depth[before][r.load[before] <= PRESSED * r.load.max()]
    return float(r.depth[0] - free.min(initial=r.depth[0]))


def suspects(tests: Sequence[Recording]) -> list[Recording]:
    """Return the tests that `air_at_start` has to look at: their load rests at the start, or their tip retreats."""
    return [
        test
        for test in tests
        if _first_retreat(test) > SHARE * np.ptp(test.depth) or resting(test.load, test.depth) > SHARE
    ]


def retreats_at_start(r: Recording, remedy: str = FINDS) -> tuple[str, ...]:
    """Return a warning where the tip of a recording that should begin at contact retreats before the load rises."""
    if not _retreats(r):
        return ()
    retreat = _first_retreat(r)
    return (f"the tip retreats by {retreat:.3g} nm after contact, before the load rises ({remedy})",)


def air_at_start(r: Recording, remedy: str = FINDS) -> tuple[str, ...]:
    """Return a warning where a recording that should begin at contact begins in air, by the search for contact."""
    told = retreats_at_start(r, remedy)
    if told or not seems_in_air(r) or (point := air_before(r)) is None:
        return told
    share = 100 * share_in_air(r, point)
    return (f"the load does not rise over the first {share:.2g} % of the depth: the test begins in air ({remedy})",)


def risen_before(r: Recording, begin: int) -> tuple[str, ...]:
    """Return a warning where the load rises well before point `begin`, which the file marks as contact.

    It rises above the line through the loads in the farther half of the approach, of which no more than the test's
    depth counts.
    """
    way, first = float(r.depth.max() - r.depth[begin]), int(np.argmin(r.depth[: begin + 1]))
    near = first + np.flatnonzero(r.depth[first : begin + 1] >= r.depth[begin] - way)
    air = near[r.depth[near] < (r.depth[near].min() + r.depth[begin]) / 2]
    if len(air) < ENOUGH:
        return ()
    line = np.polynomial.Polynomial.fit(r.depth[air], r.load[air], 1)
    rest = r.load[near] - line(r.depth[near])
    clear = max(CLEAR * float(np.std(rest[np.isin(near, air)])), BARELY_LOADED * float(np.ptp(r.load)))
    free = np.flatnonzero(rest <= clear)
    early = float(r.depth[begin] - r.depth[near[free[-1]]])
    if early <= SHARE * way:
        return ()
    return (
        f"the load rises by {rest[-1]:.3g} mN over the last {early:.3g} nm before the file's contact, "
        f"which may be marked too late ({FINDS})",
    )


def sloping(r: Recording, touch: int) -> tuple[str, ...]:
    """Return a warning where the load changes with the depth in air, and so adds to the load of the test.

    The slope is that of the way in up to point `touch`, but for its last tenth, where the surface may already pull.
    """
    first = int(np.argmin(r.depth[: touch + 1]))
    way = float(r.depth[touch] - r.depth[first])
    air = first + np.flatnonzero(r.depth[first:touch] < r.depth[touch] - NEAR * way)
    if len(air) < ENOUGH:
        return ()
    depth, load = r.depth[air] - r.depth[air].mean(), r.load[air] - r.load[air].mean()
    slope = float(depth @ load / (depth @ depth))
    uncertain = float(np.std(load - slope * depth) / np.sqrt(depth @ depth))
    share = slope * float(r.depth.max() - r.depth[touch]) / float(r.load.max() - r.load[touch])
    if abs(slope) <= CLEAR * uncertain or abs(share) <= SHARE:
        return ()
    return (
        f"the load in air changes by {1e3 * slope:.3g} mN/um of depth; what that makes up to the largest depth, "
        f"{share:.0%} of the largest load, is left in the load, as air alone does not show whether it acts in contact",
    )


def until_retreat(recording: Recording) -> tuple[Recording, tuple[str, ...]]:
    """Return a recording that begins at contact up to where the tip has left, and messages on the rest.

    It has left where the load falls below zero for good, or where the depth comes back through contact for good; or
    before that, where the load has fallen to what it reads in air beyond, which may have drifted. A load that is less
    than zero where the test begins is counted from there.
    """
    depth, noise = recording.depth, noise_of(recording.load)
    load = recording.load - (recording.load[0] if recording.load[0] < -CLEAR * noise else 0.0)
    loaded = np.flatnonzero(load > CLEAR * noise)
    last = int(loaded[-1]) if len(loaded) else len(recording) - 1
    below = np.flatnonzero(load[last:] < 0)
    ends = [len(recording), *(last + below[:1])]
    back = int(np.flatnonzero(depth >= 0)[-1]) + 1 if (depth >= 0).any() else len(recording)
    if depth[back:].min(initial=0.0) < -SHARE * depth.max():
        ends += [back, _in_air_again(load, back, noise)]
    end = int(min(ends))
    rest = recording.depth[end:]
    if rest.min(initial=0.0) >= -SHARE * max(depth.max(), 0.0):
        return recording.at(slice(end)), _after_zero_load(recording, end)
    left = recording.load[end:]
    return recording.at(slice(end)), (
        f"ends at {recording.time[end]:.4g} s, where the tip has left: {len(rest)} points of its retreat to "
        f"{rest.min():.4g} nm, at {left.min():.3g} to {left.max():.3g} mN, are left out",
    )


def _after_zero_load(r: Recording, end: int) -> tuple[str, ...]:
    """Return a message where much of a recording follows the point `end`, from which the load is zero or below."""
    lasts = float(r.time[-1] - r.time[min(end, len(r) - 1)])
    if lasts <= SHARE * float(np.ptp(r.time)):
        return ()
    rest = r.depth[end:]
    return (
        f"ends at {r.time[end]:.4g} s, where the load is zero: {len(rest)} points over {lasts:.4g} s, "
        f"at {rest.min():.4g} to {rest.max():.4g} nm, are left out: the tip may have left (--contact none keeps all)",
    )


def _in_air_again(load: np.ndarray, back: int, noise: float) -> int:
    """Return the point, before `back`, where the load has come down to its level in air from there on."""
    if not load.max() > 0.0:
        return back
    level = float(np.median(load[back:]))
    pressed = int(np.flatnonzero(load > PRESSED * load.max())[-1])
    fallen = np.flatnonzero(load[pressed:back] <= level + CLEAR * noise)
    return pressed + int(fallen[0]) if len(fallen) else back


def without_rest(r: Recording) -> tuple[Recording, tuple[str, ...]]:
    """Return a recording that begins at its first movement, and a message where a rest before it is left out.

    During a rest load and depth stay at their first level, to their noise, and the level of the load is zero. A hold
    without load after unloading is recovery, and stays. The zeros of time and depth stay as they are.
    """
    peak = int(np.argmax(r.load))
    last = _last_at_rest(r.load[:peak], r.depth[:peak], float(r.load[peak])) if peak > FIRST else 0
    rest = float(r.time[last] - r.time[0])
    if last < STEPS_AT_REST or rest <= LEAST_REST * float(r.time[peak] - r.time[last]):
        return r, ()
    message = f"the instrument rests without load for the first {rest:.4g} s: these {last} points are left out"
    return r.at(slice(last, None)), (message,)


def _last_at_rest(load: np.ndarray, depth: np.ndarray, largest: float) -> int:
    """Return the last point at rest of channels (n,) up to the `largest` load; 0 where there is no rest.

    Its average is the last at or below its level before load or depth leaves the noise, whichever does first: no part
    of the movement is lost. Where the depth stands still, the load's noise does not matter.
    """
    moved = np.zeros(len(load), dtype=bool)
    for channel in (load, depth):
        clear = max(CLEAR * noise_of(channel), BARELY_LOADED * float(np.ptp(channel)))
        moved |= np.abs(median_filter(channel, OUTLIER, mode="nearest") - np.median(channel[:FIRST])) > clear
    still = int(np.argmax(moved))
    if not still or abs(np.median(load[:still])) > max(CLEAR * noise_of(load), BARELY_LOADED * largest):
        return 0
    if np.ptp(depth[:still]) <= ROUNDING * np.ptp(depth):
        return still - 1
    ends = []
    for channel in (load[:still], depth[:still]):
        smooth = uniform_filter1d(channel, max(min(still, len(moved) - still) // AVERAGES, 1))
        at_level = smooth <= np.median(channel[: still // 2 + 1]) + ROUNDING * np.ptp(channel)
        ends.append(int(np.flatnonzero(at_level)[-1]) if at_level.any() else 0)
    return min(ends) if min(ends) > MOVES_LATE * still else 0
