r"""Where the indenter first touches, found in a recording with its approach.

That is not where the law of a sharp tip begins (`indentation_files.sharp_origin`): a blunt tip touches later, and dirt
or a film is touched long before the body beneath it. Baseline, law of contact and noise are fitted together
(`indentation_files.contact_search`); what the load does in air alone bounds the result
(`indentation_files.departure`).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import median_filter

from indentation_files.baseline import FOR_CURVE, FOR_OFFSET
from indentation_files.channel_noise import long_run_noise, noise_of
from indentation_files.contact_search import begins_in_air, earlier_touch, rise_in, rises_steadily, searched
from indentation_files.departure import departure, faint_rise
from indentation_files.errors import InputError

LOADED = 0.1  # of the rise of the load, that the tip has reached at least where a way in counts
TOUCHED, LEAST_CYCLE = 30.0, 1e-3  # standard deviations of the load, and part of its range and depth's, of a cycle
FEWEST = 6  # points of a search
CLEAR = 6.0  # standard deviations of the noise, beyond which a channel has moved
MOSTLY = 0.95  # of the largest load, where the loading ends
FAR = 8.0  # ways in, chosen: farther air adds nothing to the baseline, and steps along it would miss the test
STILL = 0.05  # of the load's range, chosen: within which the load in far air varies
THIN = 0.1  # of the way in, chosen: films, dirt and asperities are no thicker
LAYER = 2.0  # of the way into the body, chosen: soft layers whose load is faint are no thicker
BENT = 1e-3  # of the load's range, chosen: by as much the load of a sensor in air departs from a line
WIDER = 1.05  # times the posterior's width, chosen on development curves: baselines differ from all on trial
ROUNDING = 1e-6  # of the load's range, that a load without noise may differ by
BESIDE = 3  # points on either side of contact, chosen: their steps show how far apart points are there
MODEL_ERROR = 0.002  # of the way in, chosen on curves without noise: no law describes a body more closely

_FOUND: dict[str, ContactPoint] = {}  # by checksum: a test is read, surveyed and drawn, and searched once


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """A point of contact with its 95 % interval along the depth.

    `index` is the last recorded point before contact, `time` [s] and `depth` [nm] are its own, and `load` [mN] is what
    the load reads without contact; all in the recording's own counting. `lower` and `upper` end the interval of the
    depth [nm].

    The baseline is what the load reads without contact [mN] over time [s], both (n,); empty where contact was given.
    Its terms beside the offset are ``tilt``, ``drift``, ``sine`` (with ``cosine``), ``transient``.
    """

    index: int
    time: float
    load: float
    depth: float
    lower: float
    upper: float
    baseline_time: np.ndarray = field(default_factory=lambda: np.empty(0))
    baseline_load: np.ndarray = field(default_factory=lambda: np.empty(0))
    baseline_terms: frozenset[str] = frozenset()


def first_touch(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> ContactPoint:
    """Return the point of first touch: the median of its posterior, with the 95 % region of highest density.

    The interval covers what is not known of baseline, law and noise (`indentation_files.contact_evidence`), on either
    side the error of all laws or one standard deviation of the depth's noise, and an earlier touch than the law's. It
    reaches a step from one recorded point to the next at least. Where the load in air contradicts the law's contact,
    that is bounded by the air instead (`indentation_files.departure`).

    Time [s], load [mN] and depth [nm], each (n,), may have an approach or none. Where the load rises from the first
    point on as by a law, and the tip does not retreat, it is taken to be zero before contact.

    Raises `InputError` when fewer than six points lie between the start and the largest load, or load or depth does not
    change there.
    """
    key = hashlib.sha256(np.concatenate([time, load, depth]).tobytes()).hexdigest()
    if key not in _FOUND:
        _FOUND[key] = _first_touch(time, load, depth)
    return _FOUND[key]


def _first_touch(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> ContactPoint:
    """Return the point of first touch, sought anew."""
    first, last = loading(load, depth)
    if last + 1 - first < FEWEST:
        problem = f"only {last + 1 - first} points lie on the way in, too few to find the contact in"
        remedy = "export the approach too, or leave the vendor's contact (--contact file)"
        raise InputError(problem, remedy=remedy, place="load_mN")
    for channel, what, place in ((load, "load", "load_mN"), (depth, "depth", "depth_nm")):
        if not np.ptp(channel[first : last + 1]) > 0.0:
            problem = f"the {what} does not change on the way to the largest load: there is no contact to find"
            raise InputError(problem, remedy="check which column it is, or keep all (--contact none)", place=place)
    retreated = depth[: first + 1].max() - depth[first] > CLEAR * noise_of(depth[first : last + 1])
    instants, force, path = _without_far_air(*(channel[first : last + 1] for channel in (time, load, depth)))
    first = last + 1 - len(path)
    noise, error = max(noise_of(force), ROUNDING * float(np.ptp(load))), noise_of(path)
    duration, span, way = (float(np.ptp(channel)) for channel in (instants, force, path))
    clock, shares = (instants - instants[0]) / duration, (path - path[0]) / way
    for approach in (True, False) if retreated or begins_in_air(clock, force / span, shares) else (False,):
        zero = float(force[0]) if approach else 0.0
        levels = (noise / span, long_run_noise(path) / way)
        found = searched(clock, (force - zero) / span, shares, levels, approach)
        if retreated or found.in_air >= FOR_OFFSET:
            break
    contact, lower, upper = (path[0] + way * share for share in (found.contact, found.lower, found.upper))
    lower, upper = contact + WIDER * (lower - contact), contact + WIDER * (upper - contact)
    contact, lower = _before(contact, lower, instants, force, path)
    lower = _of_soft_layer(lower, force, path)
    left = departure(force, path)
    if left and upper > path[0]:
        contact, lower, upper = left.mended(contact, lower, upper)
    index, moment = _reached(contact, time, depth, first, last)
    baseline = instants[0] + duration * found.time, zero + span * found.baseline
    level = float(np.interp(moment, *baseline))
    error = max(error, MODEL_ERROR * float(path[-1] - contact))
    near = slice(max(index - first - BESIDE, 0), index - first + BESIDE)
    apart = float(np.median(np.abs(np.diff(path[near]))))
    beside = max(error, apart)
    lower, upper = min(lower - error, contact - beside), max(upper + error, contact + beside)
    return ContactPoint(index, moment, level, contact, lower, upper, *baseline, found.terms)


def _before(contact: float, lower: float, time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> tuple[float, float]:
    """Return contact and lower end of its interval, moved to where what was taken for air is left earlier.

    What is touched before the body is thin beside the test, unless the load rises from the first point on. Without six
    points in air, or where fewer than thirty rise all the way, the interval reaches the first point: a touch from there
    on and a tilted baseline are one.
    """
    air = int(np.argmax(depth > lower))
    least = lower - THIN * float(depth[-1] - lower)
    while air >= FEWEST and (earlier := earlier_touch(time[:air], load[:air], depth[:air])) is not None:
        whole = rises_steadily(load[:air]) and lower - depth[0] < depth[-1] - lower
        if earlier < least and not whole:
            break
        contact = earlier
        lower = min(earlier, lower) - float(np.median(np.abs(np.diff(depth[:air]))))
        air = int(np.argmax(depth > lower))
    if air < FEWEST or (air < FOR_CURVE and rises_steadily(load[:air])):
        lower = min(lower, float(depth[0]))
    return contact, lower


def _of_soft_layer(lower: float, load: np.ndarray, depth: np.ndarray) -> float:
    """Return the lower end of an interval, moved to where the load rises faintly before it, as under a soft layer."""
    air = int(np.argmax(depth > lower))
    noise = max(long_run_noise(load), ROUNDING * float(np.ptp(load)))
    begin = faint_rise(load[:air], depth[:air], noise, BENT * float(np.ptp(load)))
    thin = LAYER * float(depth[-1] - lower)
    return lower if begin is None or lower - begin > thin else min(lower, begin)


def _without_far_air(
    time: np.ndarray, load: np.ndarray, depth: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a loading (n,) less quiet air that is farther from a rough contact than eight times the way in."""
    while True:
        contact, _, _ = rise_in(time, load, depth)
        begin = int(np.argmax(depth > contact - FAR * (depth[-1] - contact)))
        if begin == 0 or len(depth) - begin < FEWEST or np.ptp(load[:begin]) > STILL * np.ptp(load):
            return time, load, depth
        time, load, depth = time[begin:], load[begin:], depth[begin:]


def touch_at(contact: float, time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> ContactPoint:
    """Return the point of contact at a depth that the user gives; the load there is the median of ten points before.

    The depth of the `contact` is in nm, and the recording's `time`, `load` and `depth`, each (n,), are in s, mN and nm.
    Raises `InputError` when the tip is not on its way in at that depth.
    """
    first, last = way_in(load, depth)
    if not depth[first] <= contact < depth[last]:
        problem = f"contact at {contact:g} nm lies outside the way in, {depth[first]:.4g} to {depth[last]:.4g} nm"
        raise InputError(problem, remedy="give a depth in the file's own counting", place="contact")
    index, moment = _reached(contact, time, depth, first, last)
    level = float(np.median(load[max(first, index - 9) : index + 1]))
    return ContactPoint(index, moment, level, contact, contact, contact)


def _reached(contact: float, time: np.ndarray, depth: np.ndarray, first: int, last: int) -> tuple[int, float]:
    """Return the last point on the way in at or before a depth, and when it is reached after that point [s]."""
    before = np.flatnonzero(depth[first:last] <= contact)
    index = first + (int(before[-1]) if len(before) else 0)
    moved = depth[index + 1] - depth[index]
    share = float(np.clip((contact - depth[index]) / moved, -1.0, 1.0)) if moved > 0 else 0.0
    return index, float(time[index] + share * (time[index + 1] - time[index]))


def loading(load: np.ndarray, depth: np.ndarray) -> tuple[int, int]:
    """Return the first and last index of the first loading of loads and depths (n,) [mN], [nm].

    It leads from the farthest retreat to nearly the largest load.
    """
    risen, peak = _rise(load, depth)
    last = int(np.argmax(risen >= MOSTLY * risen[peak]))
    return int(np.argmin(depth[: last + 1])), last


def way_in(load: np.ndarray, depth: np.ndarray) -> tuple[int, int]:
    """Return the first and last index of the way in of loads and depths (n,) [mN], [nm].

    It leads from the farthest retreat to a tenth of the first cycle's load.

    Loads count from the least one before the peak, whatever the load reads without contact, and single points that
    stick out do not count. Where fewer than ten points lie between, as in coarse recordings, ten are taken, up to half
    of that load.
    """
    risen, peak = _rise(load, depth)
    last = int(np.argmax(risen > LOADED * risen[peak]))
    first = int(np.argmin(depth[: last + 1]))
    return first, max(last, min(first + 10, int(np.argmax(risen > 0.5 * risen[peak]))))


def _rise(load: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the loads of the first cycle (k,) above the least one before its peak, and the index of the peak."""
    smooth = median_filter(load, 5, mode="nearest")
    smooth = smooth[: _first_cycle(smooth, depth, noise_of(load))]
    peak = int(np.argmax(smooth))
    return smooth - smooth[: peak + 1].min(), peak


def _first_cycle(load: np.ndarray, depth: np.ndarray, noise: float) -> int:
    """Return where the first cycle ends: the tip has retreated, and the load fallen to half of what it had gained.

    Springs that push less on the way in are no cycle: there the tip does not retreat.
    """
    top = np.maximum.accumulate(load)
    turned = np.maximum.accumulate(np.where(load == top, np.arange(len(load)), 0))
    gained = top - np.minimum.accumulate(load)[turned]
    loaded = gained > max(TOUCHED * noise, LEAST_CYCLE * np.ptp(load))
    path, least = median_filter(depth, 5, mode="nearest"), max(CLEAR * noise_of(depth), LEAST_CYCLE * np.ptp(depth))
    ended = loaded & (top - load > 0.5 * gained) & (path[: len(load)] < path[turned] - least)
    return int(np.argmax(ended)) if ended.any() else len(load)
