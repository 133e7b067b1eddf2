"""The search for contact: from a coarse fit to the whole loading to the evidence in ever finer ranges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product, starmap

import numpy as np
import pandas as pd

from indentation_files.baseline import Baselines, waves_in
from indentation_files.contact_evidence import (
    AMPLITUDES,
    CORRELATION_TIMES,
    Blocks,
    ContactGuess,
    Evidence,
    ResidualNoise,
    slopes_of,
)
from indentation_files.contact_law import Laws

CONTACTS = 32  # on trial in each step
STEPS = 4  # at most
LEVEL = 0.95  # probability of the interval
ANYWHERE = 1e-5  # of the largest posterior weight, from which on a contact stays on trial
MUCH_WORSE = 2.0  # ratio of mean squares
WELL = 0.003  # of the load's range, chosen: a law that fits as well as this needs no baseline, or a straight one alone
SERIES = 5e-4  # of the load's range, chosen: so closely a drift and a tilt together are the load of a spring in series
FEWEST_IN_AIR = 6  # points
CLEARLY = 6.0  # root mean squares of what a fit leaves, by which a law rises that is no accident, chosen
LITTLE = 4.0  # times what a law leaves, that a line leaves where the law explains more than it, chosen
MORE = 1.5  # times what the load does before, chosen on the XP's tests in fused silica
STEADY = 0.9  # rank correlation of a load that rises from point to point, chosen
ENDS = 20  # averages that a stretch is made of, to compare its end with its least
MOST_BEFORE = 7  # stretches before, that the last one is compared with
UNSURE = 0.05  # of the law's load, which is no part of a wave
AGAIN = 15.0  # nats below the best, with which correlated noise is tried again in the next step
UPPER = 0.5  # share of the law's largest load up to which it is fitted
IN_AIR, NEAR, BEYOND = 60, 90, 50  # blocks before, about and beyond the contacts on trial
EVERY_NOISE = (ResidualNoise(), *starmap(ResidualNoise, product(AMPLITUDES, CORRELATION_TIMES)))


@dataclass(frozen=True)
class Found:
    """What a search found; depth, time and load run over a unit.

    The contact is the median of the posterior, between the ends of its interval of highest density. The best `baseline`
    (n,) over `time` (n,) has terms of the kinds `terms`; `in_air` points lie before contact.
    """

    contact: float
    lower: float
    upper: float
    time: np.ndarray
    baseline: np.ndarray
    terms: frozenset[str]
    in_air: int


def searched(
    time: np.ndarray, load: np.ndarray, depth: np.ndarray, noise: tuple[float, float], approach: bool
) -> Found:
    """Search the contact of a loading.

    It leads from the start of the approach to nearly the largest load; `time`, `load` and `depth`, each (n,), run over
    a unit. The `noise` is the white one of load and of depth. Without an `approach` contact may lie before the first
    point, where the load is zero.
    """
    guess, contact, left = coarse(time, load, depth, approach)
    reach = float(np.ptp(depth))
    lowest = depth.min() - (0.0 if approach else 0.5 * reach)
    low, high = lowest, depth.min() + 0.98 * reach
    laws, baselines = Laws(), Baselines(together=left > WELL**2 or not _in_series(time, load, depth))
    noises = [replace(noise, of_depth=not approach) for noise in EVERY_NOISE]
    for step in range(STEPS):
        count = _counting(guess, max(contact, high) if step else contact, depth)
        blocks = Blocks.of(_edges(depth[:count], low, high, contact if step == 0 else None), time, depth, load)
        end = float(blocks.depth.max())
        high = min(high, end - 0.02 * (end - low))
        contacts = np.linspace(low, high, CONTACTS)
        in_air = int(np.argmax(depth > contact)) if approach else 0
        baselines = replace(baselines, in_air=in_air)
        order = np.argsort(guess[0])
        loads = np.interp(blocks.depth, guess[0][order], guess[1][order])
        near = ContactGuess(contact, loads, slopes_of(blocks.depth, loads))
        if step == 0:
            baselines = _with_waves(baselines, blocks, near.loads, noise[0])
        evidence = Evidence(blocks, near, baselines, laws, contacts, *noise)
        best = evidence.search(noises)
        posterior = evidence.posterior()
        baseline, fitted = evidence.fitted(best)
        guess, contact = (blocks.depth, fitted.loads), fitted.contact
        weight = posterior.sum(axis=1)
        apart = contacts[1] - contacts[0]
        found = _interval(contacts, weight)
        if step < 2:
            baselines = _with_waves(baselines, blocks, fitted.loads, noise[0])
        inside = contacts[weight > ANYWHERE * weight.max()]
        before = high - low
        low, high = max(inside[0] - 2 * apart, low), min(inside[-1] + 2 * apart, high)
        if step > 1 and high - low > 0.7 * before:
            break
        laws = laws.narrowed(posterior.sum(axis=0))
        likely = [noise for noise, _ in evidence.near(AGAIN)]
        noises = [ResidualNoise(n.amplitude, n.correlation_time, of_depth=not approach) for n in likely]
        noises = list(dict.fromkeys(noises))
    kinds = frozenset(name.split()[0] for name, _ in best[1])
    return Found(*found, blocks.time, baseline, kinds, int(np.argmax(depth > found[0])))


def _in_series(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> bool:
    """Return whether a drift and a tilt together are the load, as of a spring in series that is driven evenly."""
    columns = np.column_stack([np.ones(len(time)), time, depth])
    left = load - columns @ np.linalg.lstsq(columns, load, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2))) < SERIES * np.ptp(load)


def _with_waves(baselines: Baselines, blocks: Blocks, loads: np.ndarray, white: float) -> Baselines:
    """Return baselines with the waves that a law's loads (n,) leave in the blocks."""
    deviation = np.sqrt(white**2 / blocks.count + (UNSURE * loads) ** 2)
    return replace(baselines, waves=waves_in(blocks.load - loads, 1 / deviation, blocks.time, blocks.depth))


def begins_in_air(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> bool:
    """Return whether a loading (n,) needs a baseline.

    Without one the law begins some points later than the recording, or fits much worse.
    """
    _, contact, alone = coarse(time, load, depth, approach=False)
    if np.sum(depth[: len(depth) // 2] < contact) >= FEWEST_IN_AIR:
        return True
    return alone > max(MUCH_WORSE * coarse(time, load, depth, approach=True)[2], WELL**2)


def earlier_touch(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> float | None:
    """Return from which depth on what was taken for air (n,) rises at its end as by a law of contact; None where not.

    A film, dirt or an asperity is touched before the body, whose law the whole loading follows. The last half is
    tried, the last quarter and so on, and the whole where the load rises over all of it: the rise at the end has to be
    far above noise, and above all that the load does in seven stretches as long before, so that no wave counts. The
    clearest of them gives the depth.
    """
    clearest, found = 0.0, None
    length = len(load) if rises_steadily(load) else len(load) // 2
    while length >= FEWEST_IN_AIR:
        begin = len(load) - length
        contact, height, ratio = rise_in(time[begin:], load[begin:], depth[begin:])
        before = slice(max(begin - MOST_BEFORE * length, 0), begin)
        if height > MORE * _excursion(time[before], load[before], length) and ratio > max(clearest, CLEARLY):
            clearest, found = ratio, contact
        length //= 2
    return found


def rises_steadily(load: np.ndarray) -> bool:
    """Return whether a load (n,) rises over all its points, by its rank correlation with their order."""
    if len(load) < 3 or np.ptp(load) == 0.0:
        return False
    return bool(np.corrcoef(np.arange(len(load)), pd.Series(load).rank())[0, 1] > STEADY)


def _excursion(time: np.ndarray, load: np.ndarray, length: int) -> float:
    """Return how far averages of a load (n,) lie apart about a straight line in time, 20 of them over a `length`."""
    if len(load) < FEWEST_IN_AIR:
        return 0.0
    edges = np.arange(0, len(load), max(length // ENDS, 1))
    means, clock = (np.add.reduceat(channel, edges) / np.diff([*edges, len(load)]) for channel in (load, time))
    return float(np.ptp(means - np.polyval(np.polyfit(clock, means, 1), clock))) if len(means) > 2 else 0.0


def rise_in(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> tuple[float, float, float]:
    """Return where a law of contact on a straight line begins in a load (n,), its height, and that over what is left.

    The height is zero where the law explains little that the line does not, or the load does not end above its least:
    so starts a stage, or drifts a load.
    """
    duration, span, way = (float(np.ptp(channel)) for channel in (time, load, depth))
    if span <= 0.0 or way <= 0.0:
        return float(depth[0]), 0.0, 0.0
    clock, force, shares = (time - time[0]) / duration, load / span, (depth - depth[0]) / way
    (_, law), contact, left = coarse(clock, force, shares, approach=True)
    blocks = _even(clock, force, shares)
    line = np.mean((blocks.load - np.polyval(np.polyfit(blocks.depth, blocks.load, 1), blocks.depth)) ** 2)
    edges = np.unique(np.linspace(0, len(load), min(len(load), ENDS) + 1).round().astype(int))[:-1]
    means = np.add.reduceat(force, edges) / np.diff([*edges, len(load)])
    height = min(float(np.ptp(law)), float(means[-1] - means.min())) * bool(line > LITTLE * left)
    return float(depth[0] + way * contact), span * height, height / np.sqrt(max(left, 1e-12))


def _even(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> Blocks:
    """Return at most 200 averages of equally many points."""
    size = len(load)
    return Blocks.of(np.unique(np.linspace(0, size, min(size, 200) + 1).round().astype(int)), time, depth, load)


def coarse(
    time: np.ndarray, load: np.ndarray, depth: np.ndarray, approach: bool
) -> tuple[tuple[np.ndarray, np.ndarray], float, float]:
    """Return depths and loads (n,) of the law, and the contact, that fit the loading best on a straight baseline.

    The last value is the mean square of the residual. The arguments `time`, `load`, `depth` and `approach` are as for
    `searched`; without an approach the baseline is zero.
    """
    blocks = _even(time, load, depth)
    end, start = float(blocks.depth.max()), float(blocks.depth.min())
    contacts = np.unique([*np.linspace(start, end, 60), *blocks.depth[::3]])
    contacts = contacts[contacts < start + 0.97 * (end - start)]
    laws = Laws().loads(blocks.depth, contacts, end).reshape(len(blocks.load), -1)
    straight = np.linalg.qr(np.column_stack([np.ones_like(blocks.depth), blocks.depth]))[0][:, : 2 if approach else 0]
    force = blocks.load - straight @ (straight.T @ blocks.load)
    beside = laws - straight @ (straight.T @ laws)
    power = np.maximum(np.sum(beside**2, axis=0), 1e-12)
    amplitude = force @ beside / power
    gained = np.where(amplitude > 0, amplitude**2 * power, -np.inf)
    best = int(np.argmax(gained))
    contact = float(contacts[best // len(Laws())])
    return (blocks.depth, amplitude[best] * laws[:, best]), contact, float(force @ force - gained[best]) / len(force)


def _counting(guess: tuple[np.ndarray, np.ndarray], contact: float, depth: np.ndarray) -> int:
    """Return how many points count: twelve at least, up to half of the law's largest load, all contacts within.

    All of them count where the depth does not change among these.
    """
    depths, loads = guess
    reached = max(depths[int(np.argmax(loads >= UPPER * loads.max()))], contact + 0.1 * (depth.max() - contact))
    beyond = np.flatnonzero(np.maximum.accumulate(depth) > reached)
    count = max(int(beyond[0]) if len(beyond) else len(depth), min(len(depth), 12))
    return count if np.ptp(depth[:count]) > 0.0 else len(depth)


def _edges(depth: np.ndarray, low: float, high: float, contact: float | None) -> np.ndarray:
    """Return the edges of blocks: even before the contacts on trial, fine about them, in growing steps beyond."""
    size = len(depth)
    if contact is not None:
        parted = int(np.argmax(depth > contact))
        parts = [np.linspace(0, parted, min(parted, 90) + 1), np.linspace(parted, size, min(size - parted, 70) + 1)]
    else:
        first = int(np.argmax(depth >= low))
        below = np.flatnonzero(depth <= high)
        last = int(below[-1]) + 1 if len(below) else first + 1
        last = min(max(last + (last - first) // 2 + 3, first + 8), size)
        way = np.maximum.accumulate(depth[last:])
        deeper = high + (way[-1] - high) * np.linspace(0, 1, BEYOND) ** 2 if len(way) else np.empty(0)
        parts = [
            np.linspace(0, first, min(first, IN_AIR) + 1),
            np.linspace(first, last, min(last - first, NEAR) + 1),
            (last + np.searchsorted(way, deeper)).astype(float),
        ]
    return np.unique(np.clip(np.concatenate([[0], *parts, [size]]).round().astype(int), 0, size))


def _interval(contacts: np.ndarray, weight: np.ndarray) -> tuple[float, float, float]:
    """Return the median, and the ends of the region of highest density, of weights (k,) at even contacts (k,)."""
    half = 0.5 * (contacts[1] - contacts[0])
    share = np.cumsum(weight)
    median = float(np.interp(0.5, share - 0.5 * weight, contacts))
    order = np.argsort(weight)[::-1]
    inside = order[: int(np.searchsorted(np.cumsum(weight[order]), LEVEL)) + 1]
    return median, float(contacts[inside].min() - half), float(contacts[inside].max() + half)
