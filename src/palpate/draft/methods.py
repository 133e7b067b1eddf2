"""Groups of tests that one method has made, though they reach different loads or displacements.

Under depth or strain-rate control the specimen decides the load; behind a cantilever the height at which it is touched
decides how far the piezo goes on. Two signs distinguish them from tests of several sizes: they end their loading at one
depth, while the depths of unlike loads differ by the root of these; or they are many, and their sizes form no levels,
but spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, pairwise

import numpy as np

from indentation_files.recording import Recording
from palpate.base.classes import classes_of
from palpate.data.recording_checks import LOAD_TOLERANCE
from palpate.draft.prescribed_drive import Drive
from palpate.study.protocol import LOAD

SHAPE = 0.05  # of the largest, root mean square, by which normalised histories of one method differ
LONGER = 1.5  # ratio of durations of one method
SAME_DEPTH = 0.25  # of what the loads would make the depths differ by, that they differ at most
SPREAD = 1.5  # ratio of the sizes of one condition, the largest to the least
MANY = 6  # tests that distinguish a spread from levels
GAP = 1.08  # ratio of neighbouring sizes from which on they are two levels
GRID = np.linspace(0.0, 1.0, 201)  # of the time of a test, where normalised histories are compared
LOADED = 0.98  # of the largest load or displacement, where loading ends: noise and overshoot move the maximum itself
Groups = list[list[Recording]]


def of_one_method(groups: Groups, drive: Drive) -> Groups:
    """Return groups of tests, each of one history of the drive, with those of one method joined."""
    joined = classes_of(groups, lambda one, other: _same_shape(one[0], other[0], drive))
    return [group for members in joined for group in _by_method(members, drive)]


def the_middle(recordings: Sequence[Recording], drive: Drive) -> Recording:
    """Return the recording whose size and duration lie nearest to the medians."""
    sizes = np.log([[drive.of(recording).max(), recording.time[-1]] for recording in recordings])
    return recordings[int(np.argmin(np.abs(sizes - np.median(sizes, axis=0)).sum(axis=1)))]


def end_of_loading(channel: np.ndarray) -> int:
    """Return the index at which a load or displacement (n,) has risen, to `LOADED` of its largest."""
    return int(np.argmax(channel >= LOADED * channel.max()))


def _by_method(groups: Groups, drive: Drive) -> Groups:
    """Return groups of one shape, joined where they differ as tests of one method do."""
    found = [group for level in _levels(groups, drive) for group in _spread(level, drive)]
    if drive.control != LOAD:
        return found
    to_one_depth = classes_of(found, lambda one, other: _same_depth(one[0], other[0]))
    return [same[0] if len(same) == 1 else list(chain.from_iterable(same)) for same in to_one_depth]


def _levels(groups: Groups, drive: Drive) -> list[Groups]:
    """Return the groups by size, cut where these leave a gap."""
    ordered = sorted(groups, key=lambda group: _size(group, drive))
    levels = [ordered[:1]]
    for before, after in pairwise(ordered):
        if min(_sizes(after, drive)) > GAP * max(_sizes(before, drive)):
            levels.append([])
        levels[-1].append(after)
    return levels


def _spread(level: Groups, drive: Drive) -> Groups:
    """Return the groups of one level as one, or a few, where they are many tests whose sizes spread."""
    least, largest = (_size(level[k], drive) for k in (0, -1))
    if largest <= (1.0 + LOAD_TOLERANCE) * least or sum(map(len, level)) < MANY:
        return level
    parts = int(np.ceil(np.log(largest / least) / np.log(SPREAD)))
    ends = np.geomspace(least, largest, parts + 1)[1:-1]
    found: Groups = [[] for _ in range(parts)]
    for group in level:
        found[int(np.searchsorted(ends, _size(group, drive)))].extend(group)
    return [group for group in found if group]


def _size(group: Sequence[Recording], drive: Drive) -> float:
    return float(np.median(_sizes(group, drive)))


def _sizes(group: Sequence[Recording], drive: Drive) -> list[float]:
    return [float(drive.of(recording).max()) for recording in group]


def _same_shape(one: Recording, other: Recording, drive: Drive) -> bool:
    """Return whether two drives agree once each is divided by its largest value and its duration."""
    if not 1.0 / LONGER < one.time[-1] / other.time[-1] < LONGER:
        return False
    first, second = (
        np.interp(GRID, test.time / test.time[-1], drive.of(test) / drive.of(test).max()) for test in (one, other)
    )
    return bool(np.sqrt(np.mean((first - second) ** 2)) < SHAPE)


def _same_depth(one: Recording, other: Recording) -> bool:
    """Return whether two tests end their loading at about one depth, although their loads differ."""
    loads, depths = (abs(np.log(_at_end_of_loading(one)[k] / _at_end_of_loading(other)[k])) for k in (0, 1))
    return bool(loads < np.log(SPREAD) and depths < SAME_DEPTH * 0.5 * loads)


def _at_end_of_loading(recording: Recording) -> tuple[float, float]:
    end = end_of_loading(recording.load)
    return float(recording.load[end]), float(recording.depth[end])
