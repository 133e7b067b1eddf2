r"""How the discrepancy of a law is correlated: what obeys the scaling law of a sharp tip, and four ways to breach it.

What obeys it is a smooth functional of the normalised history, see `palpate.inference.discrepancy`. What breaches it
belongs to each test alone, or has a length, or follows the clock, as a drift of the
instrument does, or begins where the load turns, as overshoots and backlashes do: there it changes with the logarithm of
the time since then, and fades over a segment. Each is a Gaussian process; here are columns whose products are its
correlation. What has a length is one function of few freedoms, see `crossovers`.

Tests with different tips share it as far as they strain the body alike. A strain is measured by the slope of the tip at
the edge of contact (D. Tabor, The Hardness of Metals, 1951): that of the flank under a cone or a pyramid at any load,
a / R under a sphere, whose cube grows with the load (Hertz). So the logarithm of that cube takes the place of the
logarithm of the load, and a cone and a sphere of one slope share what two loads on one sphere would share. What one
tip breaches, or what has a length, says nothing of another one but for the part in proportion to the depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import block_diag, lapack

from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol

TIMES = 0.8  # of the logarithm of time: fits of linear solids to power, logarithmic and stretched creep leave this
HISTORIES = 0.25  # of the root of the normalised load: the same
ROUGHER = 6.0  # times shorter than those of the law's discrepancy are the lengths of a mesh's ripple
APART = 1.2  # ratio of loads, or of durations, from which on tests tell a length from the law, or a clock from both
LOADS = 0.7  # of the logarithm of the load, where body or tip has a length: a factor of two
CROSSINGS = 4.0 / 5.0 ** np.arange(4)  # of the largest depth or load: lengths, or loads, of body, tip or instrument
AGO = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 24)])  # s, of the present time: the recent past counts most
CLOCK = 0.3  # of a test's duration, over which a drift forgets
SINCE = 0.8  # of the logarithm of the time since the load turned
SOONEST = 0.01  # of a segment, below which that time counts as one
DROPPED = 1e-4  # of the variance, below which columns are left out


@dataclass(frozen=True)
class Indentation:
    """What the discrepancy of a law depends on in a test.

    Parameters
    ----------
    protocol
        What is prescribed.
    tip
        Name of its tip among those of the study.
    grows
        Whether the slope of the tip at the edge of contact grows with the load.
    level
        Logarithm of that slope's cube; where it grows, less that of the load [mN] or displacement [nm].
    """

    protocol: Protocol
    tip: str = ""
    grows: bool = False
    level: float = 0.0

    @classmethod
    def under(
        cls, name: str, tip: Indenter, protocol: Protocol, tests: Sequence[Protocol], depths: Sequence[float]
    ) -> Indentation:
        """Return a test under a tip.

        Parameters
        ----------
        name, tip
            Of the tip, and the tip itself.
        protocol
            Of the test.
        tests, depths
            Tests with this tip (m,), and the largest depth of each [nm].
        """
        if tip.sharp:
            return cls(protocol, name, level=3.0 * float(np.log(tip.slope)))
        steepest = [np.sqrt(depth / tip.radius) if tip.radius else np.inf for depth in depths]
        cubes = 3.0 * np.log(np.minimum(tip.slope, steepest)) - np.log([test.largest_drive for test in tests])
        return cls(protocol, name, True, float(cubes.mean()))


Tests = tuple[Indentation, ...]


@lru_cache(maxsize=32)
def common(tests: Tests) -> np.ndarray:
    """Return columns (n, m) of what histories determine."""
    return correlation_factor(kernel(np.vstack([features(test) for test in tests])))


@lru_cache(maxsize=32)
def parts_of_tests(tests: Tests) -> np.ndarray:
    """Return columns (n, m) of the same within each test alone."""
    return block_diag(*(correlation_factor(kernel(features(test))) for test in tests))


def by_tip(tests: Tests) -> list[np.ndarray]:
    """Return which points (n,) belong to the tests of each tip."""
    of_points = np.repeat([test.tip for test in tests], [len(test.protocol.sample_time) for test in tests])
    return [of_points == tip for tip in dict.fromkeys(test.tip for test in tests)]


def of_several_loads(tests: Tests) -> list[np.ndarray]:
    """Return those of `by_tip` whose tests differ in load, so that a length breaches the scaling between them.

    Within one load it cannot be told from the law of the material.
    """
    loads: dict[str, list[float]] = {}
    for test in tests:
        loads.setdefault(test.tip, []).append(test.protocol.largest_drive)
    return [own for own, of in zip(by_tip(tests), loads.values(), strict=True) if max(of) > APART * min(of)]


def same_tip(tests: Tests) -> np.ndarray:
    """Return which pairs of points (n, n) belong to tests with one tip."""
    return np.add.reduce([np.outer(own, own) for own in by_tip(tests)])


def crossovers(measure: np.ndarray, relative: np.ndarray, tips: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return columns (n, 2 t + 1) of responses that cross over between neighbours of `CROSSINGS`, for each such pair.

    A body or tip with one length has one stiffness far below it and another one far above, and so has an instrument
    with a load of its own. To first order the depth h at a length l gains a share of h / (1 + h / l). The law may be
    that of the largest depth tested, where nothing is gained then, or that of the smallest: the last column is in
    proportion to the depth. What of the others is not, as a stiffness is, has a root mean square of one. Each of t tips
    has two columns of its own, since a length of the body acts under it by its own measure, and the law is one.

    Parameters
    ----------
    measure : ndarray, shape (n,)
        Depth or load, over which the response crosses over.
    relative : ndarray, shape (n,)
        Depth over the largest one so far.
    tips : sequence of ndarray, shape (n,)
        Which points belong to each tip.
    """
    pairs = range(len(CROSSINGS) - 1)
    columns, whole = zip(*(_gained(measure[own], relative[own]) for own in tips), strict=True)
    found = []
    for k in pairs:
        apart = np.zeros((len(measure), 2 * len(tips)))
        for number, (own, part) in enumerate(zip(tips, columns, strict=True)):
            apart[own, 2 * number : 2 * number + 2] = part[:, [k, k + 1]]
        found.append(np.column_stack([apart, np.mean(whole, axis=0)[[k, k + 1]].mean() * relative]))
    return found


def _gained(measure: np.ndarray, relative: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what each of `CROSSINGS` gains under one tip (n, c), and the whole of it (c,), both in the same unit."""
    gained = 1.0 / (1.0 + measure[:, None] / (CROSSINGS * measure.max()))
    last = 1.0 / (1.0 + 1.0 / CROSSINGS)
    columns = relative[:, None] * (gained - last)
    beside = columns - np.outer(relative, relative @ columns / (relative @ relative))
    sizes = np.sqrt(np.mean(beside**2, axis=0))
    return columns / sizes, (1.0 - last) / sizes


@lru_cache(maxsize=32)
def clocks(tests: Tests) -> np.ndarray:
    """Return columns (n, m) of a walk with the clock in each test that begins at zero."""
    found = []
    for test in tests:
        time = test.protocol.sample_time / test.protocol.knot_time[-1]
        apart = np.subtract.outer(time, time) / CLOCK
        found.append(correlation_factor(np.outer(time, time) ** 0.5 * np.exp(-0.5 * apart**2)))
    return block_diag(*found)


@lru_cache(maxsize=32)
def reversals(tests: Tests) -> np.ndarray:
    """Return columns (n, m) of what begins in each test at a corner of the load, and fades after it."""
    found = []
    for test in tests:
        time, knots = test.protocol.sample_time, test.protocol.knot_time
        correlation = np.zeros((len(time),) * 2)
        for before, corner, after in zip(knots[:-2], knots[1:-1], knots[2:], strict=True):
            since = np.maximum(time - corner, 0.0) / min(corner - before, after - corner)
            place, fades = np.log(since + SOONEST) / SINCE, np.where(time > corner, np.exp(-since), 0.0)
            correlation += np.exp(-0.5 * np.subtract.outer(place, place) ** 2) * np.outer(fades, fades)
        found.append(correlation_factor(correlation))
    return block_diag(*found)


@lru_cache(maxsize=32)
def ripple(tests: Tests) -> np.ndarray:
    """Return the correlation (n, n) of what a mesh makes rough, by `features` that are `ROUGHER` times as short."""
    return kernel(ROUGHER * np.vstack([features(test) for test in tests]))


def features(test: Indentation) -> np.ndarray:
    """Return what the process depends on, (n_points, f), in units of the distances over which it forgets."""
    protocol, time = test.protocol, test.protocol.sample_time
    before = protocol.drive_at(np.outer(time, 1.0 - AGO).ravel()).reshape(len(time), -1)
    largest = _largest_so_far(protocol)
    history = np.sqrt(before / largest[:, None] / len(AGO))
    strain = test.level + (np.log(largest) if test.grows else np.zeros(len(time)))
    return np.column_stack([np.log(time) / TIMES, history / HISTORIES, strain / LOADS])


def _largest_so_far(protocol: Protocol) -> np.ndarray:
    """Return the largest drive (n_points,) up to each sample."""
    knots = np.interp(protocol.sample_time, protocol.knot_time, np.maximum.accumulate(protocol.knot_drive))
    return np.maximum(np.maximum(knots, protocol.sample_drive), 1e-9 * protocol.largest_drive)


def kernel(features: np.ndarray) -> np.ndarray:
    """Return the correlation (n, n) between points with these features (n, f)."""
    squares = np.sum(features**2, axis=1)
    distance = squares[:, None] + squares[None] - 2.0 * features @ features.T
    return np.exp(-0.5 * np.maximum(distance, 0.0))


def correlation_factor(correlation: np.ndarray) -> np.ndarray:
    """Return columns (n, m) whose products are a correlation (n, n) to within `DROPPED`: Cholesky's with pivots."""
    found, pivots, rank, _ = lapack.dpstrf(correlation, lower=1, tol=DROPPED)
    rows = np.empty_like(pivots)
    rows[pivots - 1] = np.arange(len(pivots))
    return np.tril(found)[rows, :rank]
