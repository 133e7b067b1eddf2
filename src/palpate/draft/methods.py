"""Groups of tests that one method has made, though they reach different loads.

Under depth or strain-rate control the specimen decides the load. Two signs tell such tests from those of several loads:
they end their loading at one depth, while the depths of unlike loads differ by the root of these; or they are many, and
their loads have no levels, but spread.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.recordings.recording import Recording

SHAPE = 0.05  # of the largest, root mean square, by which normalised histories of one method differ
LONGER = 1.5  # ratio of durations of one method
SAME_DEPTH = 0.25  # of what the loads would make the depths differ by, that they differ at most
SPREAD = 1.5  # ratio of the loads of one method, the largest to the least
MANY = 6  # tests that tell a spread from levels
LOOSE = 1 / 3  # of the tests, as many groups as which are no levels
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
    count, peaks = sum(map(len, groups)), [group[0].load.max() for group in groups]
    if len(groups) > 1 and count >= MANY and len(groups) > LOOSE * count and max(peaks) < SPREAD * min(peaks):
        return [[recording for group in groups for recording in group]]
    found: list[list[Recording]] = []
    for group in groups:
        same = next((members for members in found if _same_depth(members[0], group[0])), None)
        if same is None:
            found.append(group)
        else:
            found[found.index(same)] = [*same, *group]
    return found


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
