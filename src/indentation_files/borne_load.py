"""Whether a test bears load at all, or was made in air; and the pull of a surface on the tip that leaves it."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from indentation_files.channel_noise import noise_of
from indentation_files.errors import InputError
from indentation_files.recording import Recording

LEAST_RISE = 0.05  # of its fall, by which a load of the right sign rises
AVERAGES = 50  # of which a test is made where it has enough points
FEW = 4  # points in an average, below which single points are looked at
BORNE = 10.0  # standard deviations of its average's noise by which a load that is borne rises
FALLS = 0.3  # of its rise, by which a load that is borne falls at least while the tip comes back
DRIFTS = 2.0  # times what the load reaches on the first way in, that one which drifts within its noise may rise
FIRST_WAY = 0.3  # of the largest depth
NEAR_START = 10  # points that give the load without contact
OUTLIER = 5  # points, chosen: the median of so many passes over one or two that stand out
FEWEST = 20  # points that determine the noise of a load
PULLED = 0.02  # of the largest load, chosen: a pull on the tip that is reported
CLEAR = 10.0  # standard deviations of the load's noise, likewise


def check_borne(recording: Recording) -> None:
    """Refuse a test that never bears load: its load stays within its noise, or drifts.

    A load of the wrong sign is borne; what begins a test refuses it with the true reason. It drifts where it stays near
    the noise and rises hardly more than on the first way in, or where it does not fall while the tip comes back, which
    no body's does. Raises `InputError` with the rise and the noise, or with a point that stands out and hides what the
    others bear.
    """
    load, depth = recording.load, recording.depth
    if len(load) < FEWEST or _borne(load, depth):
        return
    smooth, _, noise = _averaged(load)
    rise = float(smooth.max() - np.median(load[: max(min(NEAR_START, len(load) // AVERAGES), 1)]))
    if rise < LEAST_RISE * float(np.ptp(smooth)) and (_borne(-load, depth) or _borne(-load, -depth)):
        return
    without = median_filter(load, OUTLIER, mode="nearest")
    if _borne(without, depth):
        odd = int(np.argmax(np.abs(load - without)))
        raise InputError(
            f"its load jumps to {load[odd]:.4g} mN at {recording.time[odd]:.4g} s, where the points beside it read "
            f"{without[odd]:.4g} mN",
            remedy="remove the points that stand out, or leave the test out",
        )
    raise InputError(
        f"never bears load: over {np.ptp(depth):.4g} nm its load rises by {rise:.3g} mN, its noise is {noise:.3g} mN",
        remedy="leave it out: the tip made no contact, or the load is in another column",
    )


def _borne(load: np.ndarray, depth: np.ndarray) -> bool:
    """Return whether a load (n,) leaves its noise, does not drift, and falls while the tip comes back.

    Where it is applied at once, its noise is that of what follows.
    """
    applied = _applied_at_once(load)
    before, load, depth = load[: applied or NEAR_START], load[applied:], depth[applied:]
    smooth, of_average, noise = _averaged(load)
    rise = float(smooth.max() - np.median(before))
    deepest, part = int(np.argmax(depth)), depth[0] + FIRST_WAY * (depth.max() - depth[0])
    early = float(np.abs(smooth[: max(int(np.argmax(depth >= part)), 1)] - smooth[0]).max())
    drifts = rise < BORNE * noise and rise < DRIFTS * early
    back = smooth[deepest:][depth[deepest:] < part]
    stays = len(back) > 0 and float(smooth[deepest] - back.min()) < FALLS * rise
    return not (rise < BORNE * of_average or drifts or stays)


def _applied_at_once(load: np.ndarray) -> int:
    """Return after how many first points a load (n,) leaves the first one for good, by half its range; 0 if never."""
    left = load[: 2 * NEAR_START] - load[0] > np.ptp(load) / 2
    first = int(np.argmax(left[:NEAR_START]))
    return first if first and left[first:].all() else 0


def _averaged(load: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Return averages of a load (n,), the standard deviation of their noise, and that of single points."""
    over = len(load) // AVERAGES
    if over < FEW:
        noise = noise_of(load)
        return median_filter(load, OUTLIER, mode="nearest"), noise, noise
    smooth = uniform_filter1d(load, over, mode="nearest")
    noise = float(np.std(load - smooth))
    return smooth, noise / np.sqrt(over), noise


def pull_off(recording: Recording) -> float:
    """Return how far the load falls below that without contact, after its largest [mN]; 0 where little or within noise.

    What the load reads without contact is taken from an approach, and is zero where a recording begins at contact.
    """
    load, peak = recording.load, int(np.argmax(recording.load))
    free = float(np.median(load[:NEAR_START])) if recording.time[0] < 0.0 else 0.0
    pull = free - float(median_filter(load, 3, mode="nearest")[peak:].min())
    return pull if pull > max(PULLED * (load[peak] - free), CLEAR * noise_of(load)) else 0.0
