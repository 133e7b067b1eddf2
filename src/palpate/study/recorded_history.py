r"""A history of load or displacement taken from a recording: thinned to its corners, with its sampling times.

Douglas and Peucker's rule keeps the corners that hold the history within a tolerance everywhere. Noise or an
oscillation would be kept as corners, too. Where those become more than can be simulated, the drive is averaged over
more and more points until they are few, and the drives at the corners are then those of the piecewise linear history
of least squares, which runs through the middle of the oscillation.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.sparse import csr_array
from scipy.sparse.linalg import lsqr

from indentation_files.channel_noise import noise_of
from indentation_files.corners import corners
from palpate.errors import InputError
from palpate.study.protocol import DISPLACEMENT, LOAD, Protocol

MOST_KNOTS = 500  # chosen: a simulation takes at least a step for each
TOLERANCE = 1e-3  # of the largest drive, by which it may lie from its history
MOST_NOISE = 0.02  # of the largest drive, likewise where it is noisy
SHORTEST = 50  # averages at least, that a history is made of
WILDEST = 0.1  # of the largest drive, the standard deviation of what is averaged away: more is no noise
MARGIN = 4  # times as many points are averaged as just suffice
STEPS = 6.0  # standard deviations of the noise of a drive, or of its average, that the corners leave out
ONSET = {LOAD: 0.01, DISPLACEMENT: 0.1}  # of the largest drive: a sharp tip carries a hundredth of the load there
PLACES = {LOAD: "load_mN", DISPLACEMENT: "displacement_nm"}  # in messages


def recorded(
    time: np.ndarray,
    drive: np.ndarray,
    points: int = 100,
    control: str = LOAD,
    compliance: float = 0.0,
) -> Protocol:
    """History taken from a recording, sampled at `points` times.

    They are spread evenly in t/T + s/S, with s(t) the way that the drive has gone up and down by then; so that neither
    a hold of many minutes nor a load that grows exponentially is left without points. The first sample is where the
    load reaches a hundredth of its maximum, or the displacement a tenth: below, contact lies on too few elements to
    count.

    The history is thinned to the corners that keep it within a thousandth of the largest drive everywhere, so that a
    long recording costs no more steps than its shape deserves. Where the drive's own noise is larger, six of its
    standard deviations are allowed instead, up to 2 % of the largest drive; they are estimated from second differences,
    which a smooth history leaves near zero. Where 500 corners do not suffice for that, the drive is averaged first, see
    `averaged_over`.

    Parameters
    ----------
    time, drive : ndarray, shape (n,)
        Recorded times [s] and loads [mN] or displacements [nm] from contact on. Loads below zero (noise) count as zero,
        and so do displacements before the first that is not below it: the tip has not yet touched.
    control, compliance
        See `Protocol`.

    Raises
    ------
    InputError
        When the drive is never above zero, the history begins above zero (by more than that), or needs more than
        500 corners however far it is thinned.
    """
    time, (drive, allowed) = np.asarray(time, dtype=float) - time[0], _begun(drive, control)
    whole, over = drive, averaged_over(time, drive)
    if over > 1:
        keep = _corners_of_average(time, drive, over)
        time, drive = time[keep], _through(time, drive, keep)
    else:
        keep = corners(time, drive, allowed)
        time, drive = time[keep], drive[keep]
    if keep.sum() > MOST_KNOTS:
        raise InputError(
            f"the {control} history has {keep.sum()} corners, {MOST_KNOTS} at most can be simulated"
            + _why(whole, control),
            remedy=f"export the mean {control} without its oscillation or noise, or leave the test out",
            place=PLACES[control],
        )
    if control == LOAD:
        drive = np.maximum(drive, 0.0)
    return Protocol(time, drive, _sampled(time, drive, ONSET[control], points), control, compliance)


def _begun(drive: np.ndarray, control: str) -> tuple[np.ndarray, float]:
    """Return a drive (n,) that begins at zero, without noise below zero, and how far its history may lie from it."""
    drive = np.array(drive, dtype=float)
    if control == LOAD:
        drive = np.maximum(drive, 0.0)
    drive[np.logical_and.accumulate(drive < 0.0)] = 0.0
    if drive.max() <= 0.0:
        raise InputError(
            f"the {control} of the recording to follow is never above zero, as if its sign were wrong",
            remedy=f"turn it (`palpate read --columns ... --units {'load=-mN' if control == LOAD else 'depth=-nm'}`)",
            place=PLACES[control],
        )
    allowed = _allowed(drive)
    if abs(drive[0]) > allowed:
        raise InputError(
            f"the {control} history begins at {drive[0]:.4g} {PLACES[control].rpartition('_')[2]}",
            remedy=f"begin it at contact, at zero {control} (--contact auto finds it)",
            place=PLACES[control],
        )
    drive[0] = 0.0
    return drive, allowed


def _sampled(time: np.ndarray, drive: np.ndarray, onset: float, points: int) -> np.ndarray:
    """Return the times (points,) of the samples, from where a share `onset` of the largest drive is reached.

    They are even in the elapsed share of the time plus that of the way, see `recorded`.
    """
    way = np.append(0.0, np.cumsum(np.abs(np.diff(drive))))
    progress = 0.5 * (time / time[-1] + way / way[-1])
    first = onset * drive.max()
    rising = int(np.argmax(drive >= first))
    begin = np.interp(first, drive[: rising + 1], progress[: rising + 1])
    return np.interp(np.linspace(begin, 1.0, points), progress, time)


def averaged_over(time: np.ndarray, drive: np.ndarray) -> int:
    """Return over how many points a recorded drive (n,) is averaged before its corners are sought; 1 where it is not.

    The number is doubled until 500 corners suffice, with a margin, and is at most a fiftieth of all points.
    """
    if corners(time, drive, _allowed(drive)).sum() <= MOST_KNOTS:
        return 1
    most = _most_averaged(drive)
    over = min(MARGIN * _enough(time, drive, 2, most), most)
    over = _enough(time, drive, over, most)  # averages over few points may need fewer than over more
    return over if swing(drive, over) < WILDEST * drive.max() else 1


def _most_averaged(drive: np.ndarray) -> int:
    """Return over how many points a drive (n,) is averaged at most."""
    return max(len(drive) // SHORTEST, 2)


def _enough(time: np.ndarray, drive: np.ndarray, over: int, most: int) -> int:
    """Return over how many points, `over` or twice, four times ... as many, an average has 500 corners at most."""
    while over < most and _corners_of_average(time, drive, over).sum() > MOST_KNOTS:
        over = min(2 * over, most)
    return over


def averaged_noise(time: np.ndarray, drive: np.ndarray) -> float:
    """Return the standard deviation of what is averaged away of a recorded drive (n,); zero where nothing is."""
    over = averaged_over(time, drive)
    return swing(drive, over) if over > 1 else 0.0


def _why(drive: np.ndarray, control: str) -> str:
    """Return, for a message, by how much a drive (n,) swings where that is too much for its average to be followed."""
    share = swing(drive, _most_averaged(drive)) / float(drive.max())
    if share < WILDEST:
        return ""
    return (
        f": the {control} swings by {share:.0%} of its largest about its average, which is followed up to {WILDEST:.0%}"
    )


def swing(drive: np.ndarray, over: int) -> float:
    """Return the standard deviation of a drive (n,) about its average over so many points."""
    return float(np.std(drive - uniform_filter1d(drive, over, mode="nearest")))


def _allowed(drive: np.ndarray) -> float:
    """Return how far a drive may lie from its history, in its unit, see `recorded`."""
    return float(max(TOLERANCE * drive.max(), min(STEPS * noise_of(drive), MOST_NOISE * drive.max())))


def _corners_of_average(time: np.ndarray, drive: np.ndarray, over: int) -> np.ndarray:
    """Return which points (n,) an average must keep to stay within its own noise, at least a thousandth, everywhere."""
    average = uniform_filter1d(drive, over, mode="nearest")
    average[[0, -1]] = drive[[0, -1]]
    noise = swing(drive, over) / np.sqrt(over)
    return corners(time, average, max(TOLERANCE * average.max(), STEPS * noise))


def _through(time: np.ndarray, drive: np.ndarray, keep: np.ndarray) -> np.ndarray:
    """Return the drive at the corners (k,) of the piecewise linear history of least squares, zero at its beginning."""
    knots, count = time[keep], int(keep.sum())
    right = np.clip(np.searchsorted(knots, time, side="right"), 1, count - 1)
    share = (time - knots[right - 1]) / (knots[right] - knots[right - 1])
    rows, columns = np.tile(np.arange(len(time)), 2), np.concatenate([right - 1, right])
    hats = csr_array((np.concatenate([1.0 - share, share]), (rows, columns)), shape=(len(time), count))
    return np.append(0.0, lsqr(hats[:, 1:], drive, atol=1e-10, btol=1e-10)[0])
