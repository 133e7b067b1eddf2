r"""Where the indenter first touches, found in a recording with its approach.

That is not where the law of a sharp tip begins (`palpate.recordings.sharp_origin`): a blunt tip touches later, and dirt
or a film is touched long before the body beneath it.

The touch is found as a change of law along the depth (the usual way with force curves; Gavara, Sci. Rep. 6 (2016)
21267, compares such ways): before it the load is a straight line in depth, whatever the springs leave, beyond it

    P = a + b h + k (h - h_0)_+^m ,     1 <= m <= 2,

from a flat or fully plastic contact (1) over Hertz's sphere (3/2) to the cone (2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.ndimage import median_filter

from palpate.errors import InputError

EXPONENTS = np.linspace(1.0, 2.0, 11)
WINDOWS = (30.0, 100.0, 300.0, 1000.0)
LOADED = 0.1
TOUCHED, LEAST_CYCLE = 30.0, 1e-3  # standard deviations of the load, and part of its range, that a cycle gains
FEWEST = 6
CLEAR = 6.0  # standard deviations of the noise, beyond which a channel has moved
TELLING = 3.0
LEVEL = 0.95


@dataclass(frozen=True)
class ContactPoint:
    """A point of contact with its 95 % interval along the depth.

    Attributes
    ----------
    index
        Last recorded point before contact.
    time, load, depth
        [s], what the load reads without contact [mN], [nm]; all in the recording's own counting.
    lower, upper
        Ends of the interval of the depth [nm].
    """

    index: int
    time: float
    load: float
    depth: float
    lower: float
    upper: float


def noise_of(values: np.ndarray) -> float:
    """Return the standard deviation of a channel's noise (n,), from second differences, small where it is smooth."""
    return float(np.median(np.abs(np.diff(values, 2))) / (0.6745 * np.sqrt(6))) if len(values) > 4 else 0.0


def first_touch(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> ContactPoint:
    """Return the point of first touch.

    The law is fitted over several spans of load beyond the touch (30 to 1000 standard deviations of the load); the span
    with the narrowest interval is taken, and the interval widened by those of the spans that tell nearly as much (whose
    intervals are at most three times as wide), and to one standard deviation of the depth's noise on either side.

    Parameters
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm]; with or without approach. Without six points of one, and without a retreat, the load is taken
        to be zero before contact.

    Raises
    ------
    InputError
        When fewer than six points lie between the start and half the largest load.
    """
    first, last = way_in(load, depth)
    force, path = load[first : last + 1], depth[first : last + 1]
    if len(force) < FEWEST:
        raise InputError(
            f"only {len(force)} points lie on the way in, too few to find the contact in",
            remedy="export the approach too, or leave the vendor's contact (--contact file)",
            place="load_mN",
        )
    retreated = depth[: first + 1].max() - path[0] > CLEAR * noise_of(depth)
    smooth, noise = median_filter(force, 5, mode="nearest"), max(noise_of(force), 1e-6 * np.ptp(load))
    rough = int(np.flatnonzero(smooth <= smooth.min() + CLEAR * noise)[-1])
    fits = []
    for window in WINDOWS:
        beyond = np.flatnonzero(force[rough:] > smooth.min() + window * noise)
        end = min(rough + max(int(beyond[0]) if len(beyond) else len(force), FEWEST), len(force))
        start = max(0, rough - max(30, 2 * (end - rough)))
        if end - start >= FEWEST:
            approach = rough - start >= FEWEST or retreated
            fits.append(_interval(force[start:end], path[start:end], approach, noise_of(depth) / noise))
    best = min(fits, key=lambda fit: fit[2] - fit[1])
    contact, width = best[0], best[2] - best[1]
    telling = [fit for fit in fits if fit[2] - fit[1] <= TELLING * width]
    error = noise_of(depth)
    lower = min(contact - error, *(fit[1] for fit in telling))
    upper = max(contact + error, *(fit[2] for fit in telling))
    index, moment = _reached(contact, time, depth, first, last)
    return ContactPoint(index, moment, best[3], contact, lower, upper)


def touch_at(contact: float, time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> ContactPoint:
    """Return the point of contact at a depth that the user gives; the load there is the median of ten points before.

    Parameters
    ----------
    contact
        Depth of the contact [nm].
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm].

    Raises
    ------
    InputError
        When the tip is not on its way in at that depth.
    """
    first, last = way_in(load, depth)
    if not depth[first] <= contact < depth[last]:
        raise InputError(
            f"contact at {contact:g} nm lies outside the way in, {depth[first]:.4g} to {depth[last]:.4g} nm",
            remedy="give a depth in the file's own counting",
            place="contact",
        )
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


def way_in(load: np.ndarray, depth: np.ndarray) -> tuple[int, int]:
    """Return the first and last index of the way in: from the farthest retreat to a tenth of the first cycle's load.

    Loads count from the least one before the peak, whatever the load reads without contact, and single points that
    stick out do not count. Where fewer than ten points lie between, as in coarse recordings, ten are taken, up to half
    of that load.
    """
    smooth = median_filter(load, 5, mode="nearest")
    smooth = smooth[: _first_cycle(smooth, depth, noise_of(load))]
    peak = int(np.argmax(smooth))
    risen = smooth - smooth[: peak + 1].min()
    last = int(np.argmax(risen > LOADED * risen[peak]))
    first = int(np.argmin(depth[: last + 1]))
    return first, max(last, min(first + 10, int(np.argmax(risen > 0.5 * risen[peak]))))


def _first_cycle(load: np.ndarray, depth: np.ndarray, noise: float) -> int:
    """Return where the first cycle ends: the tip has retreated, and the load fallen to half of what it had gained.

    Springs that push less on the way in are no cycle: there the tip does not retreat.
    """
    top = np.maximum.accumulate(load)
    turned = np.maximum.accumulate(np.where(load == top, np.arange(len(load)), 0))
    gained = top - np.minimum.accumulate(load)[turned]
    loaded = gained > max(TOUCHED * noise, LEAST_CYCLE * np.ptp(load))
    ended = loaded & (top - load > 0.5 * gained) & (depth < depth[turned] - TELLING * noise_of(depth))
    return int(np.argmax(ended)) if ended.any() else len(load)


def _interval(
    load: np.ndarray, depth: np.ndarray, approach: bool, noise_ratio: float
) -> tuple[float, float, float, float]:
    """Return contact depth, ends of its interval and the load there, for the points (n,) of one span.

    The profile of the sum of squares over the contact depth is cut where an F test with the residuals' effective number
    of points (their correlation of first order) would reject. Noise in depth counts as noise in load by the slope of
    the law found before, so points on the steep side weigh less.

    Parameters
    ----------
    noise_ratio
        Noise in depth over noise in load [nm/mN].
    """
    low = depth.min() if approach else 2 * depth.min() - depth.max()
    trial = np.linspace(low, low + 0.95 * (depth.max() - low), 400)
    weight = np.ones_like(load)
    for step in range(3):
        squares, exponent = _profile(load, depth, weight, trial, approach)
        best = int(np.argmin(squares))
        rest, slope, level = _residuals(load, depth, weight, trial[best], exponent[best], approach)
        if step == 0:
            weight = 1 / np.hypot(1.0, noise_ratio * slope)
            continue
        power = float(rest @ rest)
        correlation = float(np.clip(rest[1:] @ rest[:-1] / power, 0.0, 0.98)) if power > 0 else 0.0
        freedom = max(len(load) * (1 - correlation) / (1 + correlation) - (4 + approach), 1.0)
        allowed = squares[best] * (1 + stats.f.ppf(LEVEL, 1, freedom) / freedom)
        inside = trial[squares <= allowed]
        contact, lower, upper = trial[best], inside[0], inside[-1]
        margin = 2 * (trial[1] - trial[0])
        trial = np.linspace(max(lower - margin, trial[0]), min(upper + margin, trial[-1]), 400)
    return float(contact), float(lower), float(upper), level


def _straight(depth: np.ndarray, weight: np.ndarray, approach: bool) -> np.ndarray:
    """Return an orthonormal basis (n, 2) of weighted straight lines in depth, or an empty one without an approach."""
    columns = weight[:, None] * np.column_stack([np.ones_like(depth), depth - depth.mean()])
    return np.linalg.qr(columns[:, : 2 if approach else 0])[0]


def _profile(
    load: np.ndarray, depth: np.ndarray, weight: np.ndarray, trial: np.ndarray, approach: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return the least weighted sum of squares, and its exponent, for each contact depth on trial (k,)."""
    basis = _straight(depth, weight, approach)
    force = weight * load
    force -= basis @ (basis.T @ force)
    squares, exponents = np.full(len(trial), np.inf), np.ones(len(trial))
    for exponent in EXPONENTS:
        law = weight[:, None] * np.clip(depth[:, None] - trial, 0.0, None) ** exponent
        law -= basis @ (basis.T @ law)
        along = force @ law
        left = np.where(along > 0, force @ force - along**2 / np.maximum(np.sum(law**2, axis=0), 1e-300), np.inf)
        left = np.maximum(left, 0.0)
        better = left < squares
        squares[better], exponents[better] = left[better], exponent
    return squares, exponents


def _residuals(
    load: np.ndarray, depth: np.ndarray, weight: np.ndarray, contact: float, exponent: float, approach: bool
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return what the best law leaves, weighted (n,), its slope (n,) [mN/nm] and its load at contact [mN]."""
    beyond = np.clip(depth - contact, 0.0, None)
    columns = np.column_stack([beyond**exponent, np.ones_like(depth), depth - contact])[:, : 3 if approach else 1]
    solution = np.linalg.lstsq(weight[:, None] * columns, weight * load, rcond=None)[0]
    slope = np.where(beyond > 0, solution[0] * exponent * beyond ** (exponent - 1), 0.0)
    return weight * (load - columns @ solution), slope, float(solution[1]) if approach else 0.0
