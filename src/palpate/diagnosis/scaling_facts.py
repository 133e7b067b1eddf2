r"""What the scaling law of a sharp tip shows without a model: lengths and the instrument, whatever the material's law.

A sharp tip on a homogeneous body has no length, so tests whose loads are proportional at all times, P_2(t) = k P_1(t),
have h_2(t) = sqrt(k) h_1(t). So in tests of one normalised history and duration

    depth / sqrt(load)                         is the same at every load,
    the change of d(depth)/d(sqrt(load)) along loading     is the same (and zero without creep), zero points apart,
    C sqrt(P), C the slope dh/dP of the unloading,         is the same; a frame adds its compliance times sqrt(P).

Each is one number of each recording, compared by what replicates scatter. The site, a factor of the depth, cancels in
the second.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from indentation_files.recording import Recording
from palpate.base import small_samples
from palpate.classical.frame import FEWEST, SPAN
from palpate.configuration.condition import Condition
from palpate.diagnosis.fact import Fact
from palpate.mechanisms import Assumption, breaking
from palpate.study.protocol import Protocol

Test = tuple[Condition, Sequence[Recording]]
LENGTHS = ("tip_rounding", "film_on_substrate", "size_effect", "adhesion", "skin")
INSTRUMENT = ("frame_compliance", "mount_compliance", "thermal_drift", "nonsteady_drift")
OF_LEVELS = ("zero_offset", *INSTRUMENT, *LENGTHS)
OF_TOPS = ("frame_compliance", *breaking(Assumption.UNIFORM, Assumption.ONE_COMPLIANCE, Assumption.NO_DRIFT))
ALIKE = 0.02  # of the largest load, and of the duration, by which histories of one shape differ; chosen
APART = 1.5  # least ratio of loads that are compared
GRID = 200  # times at which histories are compared, and loads at which a rise is taken
LOADED = 0.3  # of the largest load, from which depth / sqrt(load) is averaged
RISE = 0.1  # of the largest load, from which a slope is taken
TOP = (0.95, 0.5)  # of the load, the part of an unloading that gives its slope
POINTS = 5  # of an unloading there, at least


def facts(tests: Sequence[Test], site_scatter: float, creeping: bool) -> list[Fact]:
    """Return what tests under a sharp tip show: conditions under load control with recordings from contact on.

    Where a test was not repeated, `site_scatter` is assumed for the depth [-]. The slope of a `creeping` material
    changes along loading without any effect.
    """
    found = []
    for group in alike(tests):
        low, high = group[0], group[-1]
        if high[0].protocol.max_load >= APART * low[0].protocol.max_load:
            found += _of_pair(low, high, site_scatter)
        found += _frame(group)
    if tests:
        found += _along_loading(max(tests, key=lambda test: test[0].protocol.max_load), creeping)
    return found


def alike(tests: Sequence[Test]) -> list[list[Test]]:
    """Return tests in groups of one normalised load history and duration, each by increasing load."""
    groups: list[list[Test]] = []
    for test in tests:
        if not test[0].observable.is_depth:
            continue
        known = [group for group in groups if proportional(group[0][0].protocol, test[0].protocol)]
        if not known:
            groups.append([])
        (known or groups[-1:])[0].append(test)
    return [sorted(group, key=lambda test: test[0].protocol.max_load) for group in groups]


def proportional(one: Protocol, two: Protocol) -> bool:
    """Return whether two load histories differ by a factor alone, to within `ALIKE`."""
    ends = one.knot_time[-1], two.knot_time[-1]
    shares = np.linspace(0.0, 1.0, GRID)
    loads = [protocol.load_at(shares * end) / protocol.max_load for protocol, end in zip((one, two), ends, strict=True)]
    return abs(ends[1] - ends[0]) <= ALIKE * ends[0] and float(np.abs(loads[1] - loads[0]).max()) <= ALIKE


def level(protocol: Protocol, recording: Recording) -> float:
    """Return the logarithm of the mean of depth / sqrt(load) until unloading; NaN where there is none."""
    last = protocol.knot_time[protocol.knot_drive >= (1.0 - 1e-6) * protocol.largest_drive].max()
    time = np.linspace(0.0, last, GRID)[1:]
    load, depth = (np.interp(time, recording.time, channel) for channel in (recording.load, recording.depth))
    kept = load >= LOADED * load.max()
    mean = float(np.mean(depth[kept] / np.sqrt(load[kept])))
    return float(np.log(mean)) if mean > 0.0 else np.nan


def slope_change(protocol: Protocol, recording: Recording) -> float:
    """Return by what share d(depth)/d(sqrt(load)) changes from a tenth of the largest load to the largest one."""
    largest = np.maximum.accumulate(recording.load)
    chosen = np.unique(np.searchsorted(largest, np.linspace(RISE, 1.0, GRID) * largest[-1]))
    if len(chosen) < POINTS:
        return np.nan
    share = recording.load[chosen] / largest[-1]
    terms = np.column_stack([np.ones_like(share), np.sqrt(share), share])
    _, steady, growing = np.linalg.lstsq(terms, recording.depth[chosen], rcond=None)[0]
    first, last = (steady + 2.0 * growing * root for root in (np.sqrt(RISE), 1.0))
    return float((last - first) / (0.5 * (first + last)))


def unloading_compliance(protocol: Protocol, recording: Recording) -> float:
    """Return dh/dP [nm/mN] of the first unloading from the largest load; NaN where it has too few points."""
    time, load = protocol.knot_time, protocol.knot_drive
    last = int(np.flatnonzero(load >= (1.0 - 1e-6) * protocol.largest_drive)[-1])
    below = np.flatnonzero(load[last:] < TOP[1] * protocol.largest_drive)
    if not len(below):
        return np.nan
    ends = np.interp([-level * protocol.largest_drive for level in TOP], -load[last:], time[last:])
    inside = (recording.time >= ends[0]) & (recording.time <= ends[1])
    if inside.sum() < POINTS:
        return np.nan
    return float(np.polyfit(recording.load[inside], recording.depth[inside], 1)[0])


def of_each(measure: Callable[[Protocol, Recording], float], test: Test) -> np.ndarray:
    """Return a number of each recording (m,) that gives it."""
    values = np.array([measure(test[0].protocol, recording) for recording in test[1]])
    return values[np.isfinite(values)]


def _of_pair(low: Test, high: Test, site_scatter: float) -> list[Fact]:
    names, found = f"{high[0].name} over {low[0].name}", []
    first, second = of_each(level, low), of_each(level, high)
    if len(first) and len(second):
        value, lower, upper = np.exp(small_samples.difference(first, second, site_scatter)).tolist()
        found.append(Fact(f"depth / sqrt(load) of {names}", value, lower, upper, "-", OF_LEVELS, 1.0))
    first, second = of_each(slope_change, low), of_each(slope_change, high)
    if min(len(first), len(second)) > 1:
        change = small_samples.difference(first, second, site_scatter)
        text = f"change of d(depth)/d(sqrt(load)) along loading, {names}"
        found.append(Fact(text, *change, "-", (*INSTRUMENT, *LENGTHS)))
    return found


def _along_loading(test: Test, creeping: bool) -> list[Fact]:
    values = of_each(slope_change, test)
    if len(values) < 2:
        return []
    text = f"change of d(depth)/d(sqrt(load)) along the loading of {test[0].name}"
    return [Fact(text, *small_samples.mean(values), "-", (*INSTRUMENT, *LENGTHS), None if creeping else 0.0)]


def _frame(group: Sequence[Test]) -> list[Fact]:
    """Return the compliance of a frame from unloadings at several loads: the slope of C sqrt(P) over sqrt(P)."""
    values = [(test[0].protocol.max_load, value) for test in group for value in of_each(unloading_compliance, test)]
    if len(values) < FEWEST:
        return []
    load, compliance = np.array(values).T
    if load.max() < SPAN * load.min():
        return []
    root = np.sqrt(load)
    found = small_samples.slope(root, compliance * root, np.ones((len(root), 1)))
    text = f"compliance in series, from unloadings at {load.min():.3g} to {load.max():.3g} mN"
    return [Fact(text, *found, "nm/mN", OF_TOPS)] if found else []
