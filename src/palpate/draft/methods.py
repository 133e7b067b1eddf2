"""Groups of tests that one method has made, though they reach different loads.

Under depth or strain-rate control the specimen decides the load. Two signs tell such tests from those of several loads:
they end their loading at one depth, while the depths of unlike loads differ by the root of these; or they are many, and
their loads have no levels, but spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from palpate.inference.study_recordings import LOAD_TOLERANCE
from palpate.recordings.recording import Recording

SHAPE = 0.05  # of the largest, root mean square, by which normalised histories of one method differ
LONGER = 1.5  # ratio of durations of one method
SAME_DEPTH = 0.25  # of what the loads would make the depths differ by, that they differ at most
SPREAD = 1.5  # ratio of the loads of one method, the largest to the least
MANY = 6  # tests that tell a spread from levels
GAP = 1.08  # ratio of neighbouring loads from which on they are two levels
GRID = np.linspace(0.0, 1.0, 201)
LOADED = 0.98


def of_one_method(groups: Sequence[list[Recording]]) -> list[list[Recording]]:
    """Return the groups of load-controlled tests, each of one load history, with those of one method joined."""
    joined: list[list[list[Recording]]] = []
    for group in groups:
        same = next((members for members in joined if _same_shape(members[0][0], group[0])), None)
        if same is None:
            joined.append(same := [])
        same.append(group)
    return [group for members in joined for group in _by_method(members)]


def with_the_middle_first(recordings: Sequence[Recording]) -> list[Recording]:
    """Return recordings with that first whose largest load and duration lie nearest to the medians."""
    sizes = np.log([[recording.load.max(), recording.time[-1]] for recording in recordings])
    middle = int(np.argmin(np.abs(sizes - np.median(sizes, axis=0)).sum(axis=1)))
    return [recordings[middle], *recordings[:middle], *recordings[middle + 1 :]]


def _by_method(groups: list[list[Recording]]) -> list[list[Recording]]:
    """Return groups of one shape, joined where they differ as tests of one method do."""
    found: list[list[Recording]] = []
    for group in [joined for level in _levels(groups) for joined in _spread(level)]:
        same = next((members for members in found if _same_depth(members[0], group[0])), None)
        if same is None:
            found.append(group)
        else:
            found[found.index(same)] = [*same, *group]
    return found


def _levels(groups: list[list[Recording]]) -> list[list[list[Recording]]]:
    """Return the groups by largest load, cut where these leave a gap."""
    ordered = sorted(groups, key=_largest)
    levels = [ordered[:1]]
    for before, after in pairwise(ordered):
        if _largest(after) > GAP * _largest(before):
            levels.append([])
        levels[-1].append(after)
    return levels


def _spread(level: list[list[Recording]]) -> list[list[Recording]]:
    """Return the groups of one level as one, where they are many tests whose loads spread."""
    wide = _largest(level[-1]) > (1.0 + LOAD_TOLERANCE) * _largest(level[0])
    if wide and sum(map(len, level)) >= MANY and _largest(level[-1]) < SPREAD * _largest(level[0]):
        return [[recording for group in level for recording in group]]
    return level


def _largest(group: list[Recording]) -> float:
    return float(np.median([recording.load.max() for recording in group]))


def _same_shape(one: Recording, other: Recording) -> bool:
    """Return whether two loads agree when each counts in its largest and its duration."""
    if not 1.0 / LONGER < one.time[-1] / other.time[-1] < LONGER:
        return False
    first, second = (np.interp(GRID, test.time / test.time[-1], test.load / test.load.max()) for test in (one, other))
    return bool(np.sqrt(np.mean((first - second) ** 2)) < SHAPE)


def _same_depth(one: Recording, other: Recording) -> bool:
    """Return whether two tests are as deep at the end of loading, other than their loads would make them."""
    loads, depths = (abs(np.log(_at_end_of_loading(one)[k] / _at_end_of_loading(other)[k])) for k in (0, 1))
    return bool(loads < np.log(SPREAD) and depths < SAME_DEPTH * 0.5 * loads)


def _at_end_of_loading(recording: Recording) -> tuple[float, float]:
    end = int(np.argmax(recording.load >= LOADED * recording.load.max()))
    return float(recording.load[end]), float(recording.depth[end])
