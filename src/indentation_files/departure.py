r"""Where the load leaves the air, by what it does in the air alone: no law of contact is used for that.

A straight line through the load in the first part of the air foretells the rest of it. How far the load lies apart
about that line is all that light, stage and electronics do to it. The load stands clear from where it exceeds the line
by twice as much, for good. From a depth that lies well inside the body the end of the air is moved up, as long as the
load there stands clear of what the part before foretells: :math:`x^m` with m > 1 does at every scale.

The load P beyond contact grows with the way x into the body as :math:`x^m`, with m up to 2.5: where P becomes four
times as large, x becomes at least 1.74 times as large. That bounds how long before it stands clear the load began to
rise.

Under a soft layer the load may rise by too little to stand clear. Where the air holds nothing but a straight line,
noise and such a rise at its end, that is found by least squares (`faint_rise`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from indentation_files.channel_noise import long_run_noise

MOST = 300  # averages of equally many points
BEGIN = (0.25, 0.5)  # shares of the load's range, chosen: such loads lie inside the body, unless the air is tilted more
LEARNT = 0.6  # of the air, chosen: so much of it at least foretells the rest
FREE = 0.1  # of the air, chosen: its start, where a stage may just have started
FEWEST = 8  # averages of air that determine a line and what lies apart about it, chosen
MORE = 2.0  # times what lies apart in air, by which a load stands clear, chosen
SPREAD = 4.0  # standard deviations of their noise, by which averages lie apart at least
FOURFOLD, BEYOND_DOUBT = 4.0, 20.0  # times what stands clear, chosen
LONG = 2.0  # times as long before the load stands clear as the steepest law begins, chosen: no contact lies farther
MATTERS = 0.03  # of the largest load, chosen: less may be a baseline that curves before contact
STEEPEST, USUAL = 2.5, 1.5  # largest exponent m, and a sphere's
AIR = 60  # averages of the air in which a faint rise is sought, chosen
BEGINS = np.linspace(0.02, 0.9, 45)  # shares of the air, from which on it may rise
SURELY = 40.0  # times the variance of what is left, by which the rise explains more than a line does, chosen
TALL = 6.0  # standard deviations of what is left, by which it rises at least, chosen
CLEAN = 2.0  # times the noise's variance, that is left at most: no wave, no transient, chosen
AS_LIKELY = 10.0  # times the variance of what is left, by which begins explain less that are possible too, chosen
ROUNDING = 1e-9  # of the variance of all depths: averages at one depth determine no slope


@dataclass(frozen=True)
class Departure:
    """Depths [nm] between which the load leaves the air.

    Laws with the exponents 2.5 and 1.5 that stand clear as the load does begin where it is `earliest` and `likely`.
    From `clear` on the load stands clear, from `loaded` on so far that it is no air.
    """

    earliest: float
    likely: float
    clear: float
    loaded: float

    def mended(self, contact: float, lower: float, upper: float) -> tuple[float, float, float]:
        """Return a contact and its interval [nm]: these, or others where the load in air contradicts them.

        It does where contact lies beyond air, or the whole interval long before the load leaves the air. The interval
        then holds both.
        """
        farthest = self.clear - LONG * (self.clear - self.earliest)
        if contact > self.loaded or upper < farthest:
            return self.likely, min(farthest, self.likely, lower), max(self.loaded, upper)
        return contact, lower, upper


def departure(load: np.ndarray, depth: np.ndarray) -> Departure | None:
    """Return where the load of a loading (n,) [mN] leaves the air over the depth [nm]; None where that is not seen.

    It is not where a load rises along a straight line from its first point on.
    """
    size = min(len(load), MOST)
    if size < 2 * FEWEST:
        return None
    edges, force, way = _averages(load, depth, size)
    noise = long_run_noise(load)
    excess, least = _beyond_lines(force, way, noise / (len(load) / size) ** 0.5)
    rising = _for_good(force) - force.min()
    inside = (int(np.argmax(rising > share * np.ptp(force))) for share in BEGIN)
    found = next((end for begin in inside if (end := _end_of_air(excess, least, begin))), None)
    if found is None:
        return None
    learnt, first = found
    near = slice(edges[first - 1], edges[first + 1])
    beside = slice(first - 1, first + 1)
    points = _for_good(load[near] - np.interp(depth[near], way[beside], (force - excess[learnt])[beside]))
    rises, reached = _for_good(excess[learnt]), np.maximum.accumulate(way)
    last, clear, stands = reached[first - 1], reached[first], rises[first]
    if index := int(np.argmax(points > max(least[learnt], MORE * SPREAD * noise))):
        (last, clear), stands = depth[near][index - 1 : index + 1], points[index]
    four, loaded = (
        reached[np.argmax(rises > level) if rises[-1] > level else -1]
        for level in (FOURFOLD * stands, max(FOURFOLD * stands, min(MATTERS * rises[-1], BEYOND_DOUBT * least[learnt])))
    )
    earliest, likely = (min(clear - (four - clear) / (FOURFOLD ** (1 / m) - 1), last) for m in (STEEPEST, USUAL))
    if first < 2 * FEWEST:
        likely = depth[0]
    return Departure(*(float(end) for end in (min(earliest, 2 * last - clear), likely, clear, loaded)))


def faint_rise(load: np.ndarray, depth: np.ndarray, noise: float, smallest: float = 0.0) -> float | None:
    """Return the least depth [nm] from which the load in air (n,) [mN] may rise as under a sphere; None if it does not.

    `load` and `depth` are those of what was taken for air, and `noise` [mN] is that of a load over many points. A
    body's rise exceeds the `smallest` one [mN], which the bend of a sensor's line may reach.
    """
    size = min(len(load), AIR)
    if size < 2 * FEWEST or np.ptp(depth) == 0.0:
        return None
    _, force, way = _averages(load, depth, size)
    way = (way - depth[0]) / np.ptp(depth)
    line = np.linalg.qr(np.column_stack([np.ones(size), way]))[0]
    rises = np.clip(way[:, None] - BEGINS, 0.0, None) ** USUAL
    beside, rest = rises - line @ (line.T @ rises), force - line @ (line.T @ force)
    power = np.maximum(np.sum(beside**2, axis=0), ROUNDING)
    height = rest @ beside / power
    left = np.where(height > 0, np.maximum(rest @ rest - height**2 * power, 0.0), np.inf) / size
    best = int(np.argmin(left))
    least = max(float(left[best]), 1e-300)
    gained = rest @ rest / least - size
    tall = float(height[best] * rises[-1, best]) > max(TALL * least**0.5, smallest)
    if not (tall and gained > SURELY and least < CLEAN * noise**2 * size / len(load)):
        return None
    begin = BEGINS[np.argmax(size * (left / least - 1) < AS_LIKELY)]
    return float(depth[0] + np.ptp(depth) * begin)


def _averages(load: np.ndarray, depth: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where groups of points begin and end (size + 1,), and the mean load and depth of each (size,)."""
    edges = np.linspace(0, len(load), size + 1).round().astype(int)
    force, way = (np.add.reduceat(channel, edges[:-1]) / np.diff(edges) for channel in (load, depth))
    return edges, force, way


def _beyond_lines(force: np.ndarray, way: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Return by how much loads (n,) exceed a line through those before each of them (n, n), and what stands clear (n,).

    Lines go on for as long as the air behind them, then stay level.
    """
    ends = np.arange(len(force))
    begins = (FREE * ends).astype(int)
    x, y = way - way.mean(), force - force.mean()
    sums = [np.append(0.0, np.cumsum(values)) for values in (x, y, x * x, x * y)]
    mean_x, mean_y, square, product = ((total[ends] - total[begins]) / np.maximum(ends - begins, 1) for total in sums)
    variance = square - mean_x**2
    slope = np.where(variance > ROUNDING * np.var(x), product - mean_x * mean_y, 0.0) / np.maximum(variance, 1e-300)
    farthest = np.minimum(2 * x[ends - 1] - x[begins], x.max())
    excess = y - mean_y[:, None] - slope[:, None] * (np.minimum(x, farthest[:, None]) - mean_x[:, None])
    air = (ends >= begins[:, None]) & (ends < ends[:, None])
    apart = np.max(excess, axis=1, where=air, initial=-np.inf) - np.min(excess, axis=1, where=air, initial=np.inf)
    return excess, MORE * np.where(ends < FEWEST, np.inf, np.maximum(apart, SPREAD * noise))


def _end_of_air(excess: np.ndarray, least: np.ndarray, end: int) -> tuple[int, int] | None:
    """Return how many averages foretell the rest of the air, and how many the air has: moved up from `end`."""
    beyond = np.triu(_for_good(excess) > least[:, None])
    clear = np.where(beyond.any(axis=1), np.argmax(beyond, axis=1), len(least))
    learnt = None
    while (low := max(int(LEARNT * end), FEWEST)) < end and clear[low:end].min() < end:
        learnt = low + int(np.argmin(clear[low:end]))
        end = int(clear[learnt])
    return None if learnt is None else (learnt, end)


def _for_good(values: np.ndarray) -> np.ndarray:
    """Return the least of values (..., n) from each of them on."""
    return np.minimum.accumulate(values[..., ::-1], axis=-1)[..., ::-1]
