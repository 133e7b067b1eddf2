"""The search for contact: the baseline is learnt in the air, contact is where the load leaves it.

The air is taken to end early at first. What is learnt in it gives a posterior of the contact, whose lower end bounds
the air that the next baseline is learnt in, until that end stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.recordings.baseline import FOR_OFFSET, FOR_SLOPE, ZERO, Baseline, Noise, learnt
from palpate.recordings.blocks import Blocks
from palpate.recordings.coarse_fit import coarse
from palpate.recordings.contact_posterior import Rise, log_posterior, weighed

AIR_FIRST = (0.35, 0.7)  # of the way to a rough contact, chosen: airs that are believed at first; both count alike
DEPARTS = 5.0  # standard deviations, chosen: a load that departs so far from what was foretold has left the air
MORE = 1.5  # times all that the load does before, chosen: likewise, so that no wave and no start of a stage counts
ROUNDS = 3  # of learning the baseline, at most
IN_AIR, NEAR, BEYOND = 50, 50, 30  # blocks in the air before the contacts on trial, about them, and beyond
CONTACTS = 32  # on trial in each step
UPPER = 0.5  # share of the largest load up to which the loading is explained
HIGHEST = 0.3  # of the largest load, chosen: contact lies below
EVEN = 100  # steps, over which slopes are taken
LEVEL = 0.95  # probability of the interval
ANYWHERE = 1e-5  # of the largest posterior weight, from which on a contact stays on trial
ZOOMS = 2  # into the range of likely contacts
CLEAR = 3.0  # standard deviations of the noise about a baseline, beyond which a load stands clear of it
SETTLED = 0.1  # of the interval, chosen: a lower end that moves by less stays
ALONE = ((0.0, 1.0), (1.0, 0.02), (1.0, 0.1), (4.0, 0.02), (4.0, 0.1))  # noise without air: white ones, duration


@dataclass(frozen=True)
class Found:
    """What a search found; depth, time and load run over a unit.

    Attributes
    ----------
    contact, lower, upper
        Median of the posterior and ends of its interval of highest density.
    time, baseline : ndarray, shape (n,)
        The likeliest baseline, learnt in the air.
    terms
        Kinds of its terms, and of its noise.
    """

    contact: float
    lower: float
    upper: float
    time: np.ndarray
    baseline: np.ndarray
    terms: frozenset[str]


@dataclass(frozen=True)
class Loading:
    """A loading from the start of the approach to nearly the largest load; time, load and depth (n,) run over a unit.

    Attributes
    ----------
    white, depth_noise
        Standard deviations of the white noise of a point of load and depth.
    approach
        Whether there is one; without, contact may lie before the first point, where the load is zero.
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    white: float
    depth_noise: float
    approach: bool

    def learnt_before(self, depth: float) -> tuple[list[Baseline], Blocks | None]:
        """Return the baselines that the air before a depth makes likely, and the air; without any, noise alone."""
        count = int(np.argmax(self.depth > depth))
        if not self.approach or count < FOR_OFFSET:
            return [Baseline(ZERO, Noise("correlated", a * self.white, t) if a else Noise()) for a, t in ALONE], None
        air = Blocks.even(IN_AIR, self.time[:count], self.depth[:count], self.load[:count])
        return learnt(air, self.white), air

    def blocks(self, low: float, high: float, end: float) -> Blocks:
        """Return blocks up to the depth `end`, finer between the depths `low` and `high`."""
        size = max(_last_up_to(self.depth, end), 1)
        first = int(np.argmax(self.depth >= low))
        last = _last_up_to(self.depth, high)
        last = min(max(last + (last - first) // 2 + 3, first + 8), size)
        way = np.maximum.accumulate(self.depth[last:size])
        deeper = high + (way[-1] - high) * np.linspace(0, 1, BEYOND) ** 2 if len(way) else np.empty(0)
        edges = [
            np.linspace(0, first, min(first, IN_AIR) + 1),
            np.linspace(first, last, min(last - first, NEAR) + 1),
            (last + np.searchsorted(way, deeper)).astype(float),
        ]
        found = np.unique(np.clip(np.concatenate([[0], *edges, [size]]).round().astype(int), 0, size))
        return Blocks.of(found, self.time, self.depth, self.load)


@dataclass(frozen=True)
class Learnt:
    """The air before a depth, the baselines that it makes likely, and what follows from them for the whole loading.

    Attributes
    ----------
    air
        Blocks; None without an approach.
    baselines
        The best first.
    clear
        Depth from which on the load stands clear of the best, allowing for how surely that is known there.
    top, end
        Depths where it has risen to the shares `HIGHEST` and `UPPER` of its largest.
    """

    air: Blocks | None
    baselines: list[Baseline]
    clear: float
    top: float
    end: float


def _last_up_to(depth: np.ndarray, end: float) -> int:
    """Return the number of points (n,) up to the last one that lies no deeper than `end`."""
    found = np.flatnonzero(depth <= end)
    return int(found[-1]) + 1 if len(found) else 0


def searched(loading: Loading) -> Found:
    """Search the contact of a loading."""
    start = float(loading.depth[0])
    rough = max(coarse(loading.time, loading.load, loading.depth, loading.approach)[0], start)
    ends = [_checked_air(loading, start + share * (rough - start)) for share in AIR_FIRST]
    low = 0.5 * (start + min(ends)) if loading.approach else start - 0.5 * float(np.ptp(loading.depth))
    airs = [_grown(loading, end, low) for end in (ends if loading.approach else ends[:1])]
    grid = np.unique(np.concatenate([np.array([start]), *(_whole_range(low, each) for each in airs)]))
    for _ in range(1 + ZOOMS):
        weight, blocks, base = _posterior(loading, airs, grid)
        found = _interval(grid, weight)
        inside = np.flatnonzero(weight > ANYWHERE * weight.max())
        first, last = grid[max(inside[0] - 1, 0)], grid[min(inside[-1] + 1, len(grid) - 1)]
        grid = np.linspace(first, last, CONTACTS)
    if loading.approach and found[1] <= low:
        found = found[0], start, found[2]
    best = airs[0].baselines[0]
    return Found(*found, blocks.time, base, frozenset([*(name for name, _ in best.terms), best.noise.kind]))


def _grown(loading: Loading, air_end: float, low: float) -> Learnt:
    """Return what the air teaches that begins with the part up to `air_end` and grows to contact."""
    for _ in range(ROUNDS):
        found = _learnt(loading, air_end)
        grid = _whole_range(low, found)
        _, lower, upper = _interval(grid, _posterior(loading, [found], grid)[0])
        further = min(lower, found.clear)
        if found.air is None or further < air_end + SETTLED * (upper - lower):
            break
        air_end = further
    return found


def _learnt(loading: Loading, air_end: float) -> Learnt:
    """Return what the air before a depth teaches."""
    baselines, air = loading.learnt_before(air_end)
    even = Blocks.even(150, loading.time, loading.depth, loading.load)
    reached = np.maximum.accumulate(even.depth)
    base, sure = _without_contact(loading, baselines[0], air, even)
    clear = _for_good(even.load - base - CLEAR * sure) > 0.0
    risen = _risen(even, base, baselines[0], air, loading.white)
    depths = [float(reached[int(np.argmax(risen >= share * risen.max()))]) for share in (HIGHEST, UPPER)]
    return Learnt(air, baselines, float(reached[int(np.argmax(clear))] if clear.any() else reached[-1]), *depths)


def _checked_air(loading: Loading, air_end: float) -> float:
    """Return up to which depth the load stays near what the first half of the air foretells: halved until it does."""
    start = float(loading.depth[0])
    while loading.approach:
        half = 0.5 * (start + air_end)
        first, last = (int(np.argmax(loading.depth > depth)) for depth in (half, air_end))
        if first < FOR_SLOPE or last - first < FOR_SLOPE:
            break
        baselines, air = loading.learnt_before(half)
        rest = Blocks.even(FOR_SLOPE, *(channel[first:last] for channel in (loading.time, loading.depth, loading.load)))
        base, sure = _without_contact(loading, baselines[0], air, rest)
        rise = float((rest.load - base)[-1])
        if rise < max(DEPARTS * sure[-1], MORE * (float(np.ptp(air.load)) if air else 0.0)):
            break
        air_end = half
    return air_end


def _posterior(loading: Loading, airs: Sequence[Learnt], grid: np.ndarray) -> tuple[np.ndarray, Blocks, np.ndarray]:
    """Return the weights (k,) of contacts (k,), each air counting alike, and the blocks and baseline of the first."""
    total, shown = np.zeros(len(grid)), []
    for each in airs:
        blocks = loading.blocks(float(grid[0]), float(grid[-1]), max(each.end, float(grid[-1])))
        base, _ = _without_contact(loading, each.baselines[0], each.air, blocks)
        risen = _risen(blocks, base, each.baselines[0], each.air, loading.white)
        rise = Rise(risen, _slopes(blocks.depth, risen) * loading.depth_noise)
        parts = [log_posterior(blocks, rise, one, grid, loading.white) for one in each.baselines]
        weights = np.array([one.weight for one in each.baselines])
        if each.air is None:
            evidence = np.array([np.logaddexp.reduce(part, axis=None) for part in parts])
            weights = np.exp(evidence - evidence.max())
        weight = weighed(parts, list(weights / weights.sum())).sum(axis=(1, 2)) * _widths(grid)
        if not weight.sum() > 0.0:  # nothing rises anywhere: each place is as likely
            weight = np.ones(len(grid))
        total += weight / weight.sum() / len(airs)
        shown.append((blocks, base))
    return total, *shown[0]


def _without_contact(
    loading: Loading, baseline: Baseline, air: Blocks | None, blocks: Blocks
) -> tuple[np.ndarray, np.ndarray]:
    """Return what the load reads at blocks (n,) without contact, and the standard deviation of that."""
    if air is None:
        return np.zeros(len(blocks)), loading.white / np.sqrt(blocks.count)
    return baseline.forecast(air, blocks, loading.white)


def _risen(blocks: Blocks, base: np.ndarray, baseline: Baseline, air: Blocks | None, white: float) -> np.ndarray:
    """Return by how much the load stands clear of its noise about a baseline (n,) for good.

    Far from the air a slope that is badly known would lead anywhere: there the baseline stays among the loads in air.
    """
    rough = baseline.noise.amplitude if baseline.noise.kind == "correlated" else 0.0
    noise = baseline.scale * np.sqrt(white**2 / blocks.count + rough**2)
    within = base if air is None else np.clip(base, air.load.min(), air.load.max())
    return _for_good(blocks.load - within - CLEAR * noise)


def _whole_range(low: float, learnt: Learnt) -> np.ndarray:
    """Return contacts on trial over all depths where one may lie, closest where the load leaves its baseline."""
    way = max(learnt.end - learnt.clear, learnt.top - learnt.clear, 0.05 * (learnt.end - low))
    near = learnt.clear + way * np.concatenate([-np.geomspace(1.0, 4e-3, 18), [0.0], np.geomspace(4e-3, 1.0, 9)])
    low = min(low, learnt.top - way)
    grid = np.unique(np.concatenate([np.linspace(low, learnt.top, 12), near]))
    return grid[(grid >= low) & (grid <= learnt.top)]


def _for_good(excess: np.ndarray) -> np.ndarray:
    """Return the least of an excess (n,) of the load from a point on, above zero."""
    return np.maximum(np.minimum.accumulate(excess[::-1])[::-1], 0.0)


def _slopes(depth: np.ndarray, risen: np.ndarray) -> np.ndarray:
    """Return the slope (n,) of a load that has risen for good, over noisy depths (n,), by even steps of the depth."""
    even = np.linspace(depth.min(), depth.max(), EVEN)
    return np.interp(depth, even, np.gradient(np.interp(even, np.sort(depth), risen), even))


def _widths(values: np.ndarray) -> np.ndarray:
    """Return the width of the cell about each value (n,)."""
    between = 0.5 * (values[1:] + values[:-1])
    return np.diff(np.concatenate([values[:1], between, values[-1:]]))


def _interval(contacts: np.ndarray, weight: np.ndarray) -> tuple[float, float, float]:
    """Return the median, and the ends of the region of highest density, of weights (k,) at contacts (k,)."""
    edges = np.concatenate([contacts[:1], 0.5 * (contacts[1:] + contacts[:-1]), contacts[-1:]])
    share = np.concatenate([[0.0], np.cumsum(weight)])
    median = float(np.interp(0.5, share, edges))
    order = np.argsort(weight / np.maximum(_widths(contacts), 1e-300))[::-1]
    inside = order[: int(np.searchsorted(np.cumsum(weight[order]), LEVEL)) + 1]
    return median, float(edges[inside.min()]), float(edges[inside.max() + 1])
