r"""What the load reads while the tip is in air, learnt there and nowhere else.

A baseline is an offset, with or without a tilt in depth or a drift in time, with or without one wave in depth
(interference of light), plus noise: white, and either correlated over a short time (an Ornstein-Uhlenbeck process) or a
smooth curve along the depth (a Gaussian process of squared exponential covariance: virtual deflection, electrostatic
forces, a wave too slow to be known). The start of an approach may depart from it freely, as where a stage starts.

    P = B b + e,    b ~ N(0, D),    e ~ N(0, s^2 C)

The coefficients b have normal priors, s the prior 1/s; both are integrated out, so that richer baselines pay for
themselves. What remains is the evidence of each baseline, by which those on trial are weighed (D.J.C. MacKay, Neural
Computation 4 (1992) 415-447). A wave is on trial only where it repeats in the air.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from palpate.recordings.blocks import Blocks, correlated

# Prior standard deviations of the coefficients, in ranges of the load; an offset is free, and zero is held.
DEVIATIONS = {"zero": 1e-6, "offset": 1e3, "tilt": 0.5, "drift": 0.5, "cosine": 0.05, "sine": 0.05}
REPEATS = 2.0  # periods in the air, chosen, from which on a wave is believed
MOST_CYCLES = 60.0  # of a wave in the air
FOR_OFFSET, FOR_SLOPE, FOR_CURVE = 3, 6, 20  # blocks in air, chosen
STARTS = (0.0, 0.03, 0.1, 0.3)  # free starts on trial, shares of the air
# Noise on trial: correlated, in standard deviations of the white noise and shares of the air's duration; smooth, in
# ranges of the load and shares of the air's length.
AMPLITUDES, CORRELATION_TIMES = (0.5, 2.0, 8.0), (0.003, 0.015, 0.06, 0.2)
BENDS, LENGTHS = (0.003, 0.01, 0.03), (0.1, 0.25, 0.6)
MOST = 3  # baselines that are kept
LIKELY = 5.0  # nats below the best, within which they are
ROUNDING = 1e-10  # of the largest variance, added to all: equal covariances of noise-free points stay definite
Term = tuple[str, float]
ZERO: tuple[Term, ...] = (("zero", 0.0),)
STRAIGHT: tuple[tuple[Term, ...], ...] = ((), (("tilt", 0.0),), (("drift", 0.0),))


@dataclass(frozen=True)
class Noise:
    """What the covariance of the loads in air is made of, beside white noise.

    Attributes
    ----------
    kind
        ``white`` alone, ``correlated`` or ``smooth``.
    amplitude, reach
        Standard deviation, and time or depth over which it is correlated; time, depth and load run over a unit.
    start
        Depth up to which the load may depart from the baseline freely.
    """

    kind: str = "white"
    amplitude: float = 0.0
    reach: float = 1.0
    start: float = -np.inf

    def covariance(self, blocks: Blocks, white: float) -> np.ndarray:
        """Return C (n, n), for white noise of the standard deviation `white` of a point."""
        found = np.diag(white**2 / blocks.count)
        if self.kind == "correlated":
            found += self.amplitude**2 * correlated(blocks.begin, blocks.end, self.reach)
        elif self.kind == "smooth":
            apart = np.subtract.outer(blocks.depth, blocks.depth) / self.reach
            found += self.amplitude**2 * np.exp(-0.5 * apart**2)
        free = int(np.argmax(blocks.depth > self.start))
        found[np.diag_indices(free)] += 1.0
        found[np.diag_indices(len(found))] += ROUNDING * found.diagonal().max()
        return found


@dataclass(frozen=True)
class Baseline:
    """A baseline on trial: its terms, its noise, and how likely the air makes it.

    Attributes
    ----------
    terms
        Each a kind and a number, which is the frequency of a wave.
    noise
        About them.
    weight
        Probability, given the air; those of all baselines kept sum up to one.
    count, squares
        Blocks in the air, and the sum of their squared residuals over C: what is known of s there.
    """

    terms: tuple[Term, ...]
    noise: Noise
    weight: float = 1.0
    count: int = 0
    squares: float = 0.0

    @property
    def scale(self) -> float:
        """Estimate of s."""
        return float(np.sqrt(self.squares / self.count)) if self.count else 1.0

    def columns(self, blocks: Blocks) -> np.ndarray:
        """Return the terms (n, k)."""
        return np.column_stack([_values(term, blocks.time, blocks.depth) for term in self.terms])

    @property
    def deviations(self) -> np.ndarray:
        """Prior standard deviations (k,) of the coefficients."""
        return np.array([DEVIATIONS[name] for name, _ in self.terms])

    def forecast(self, air: Blocks, blocks: Blocks, white: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what the load reads at blocks (n,) without contact, by what it reads in the air, and how surely (n,).

        The second is the standard deviation of a block's load about the first.
        """
        known, joined = len(air), air.joined(blocks)
        noise = self.noise.covariance(joined, white)
        columns = self.columns(joined)
        factor = cholesky(noise[:known, :known], lower=True, check_finite=False)
        given = np.column_stack([air.load, columns[:known], noise[:known, known:]])
        whitened = solve_triangular(factor, given, lower=True, check_finite=False)
        width = columns.shape[1]
        load, terms, beside = whitened[:, 0], whitened[:, 1 : 1 + width], whitened[:, 1 + width :]
        inner = terms.T @ terms + np.diag(self.deviations**-2.0)
        coefficients = np.linalg.solve(inner, terms.T @ load)
        away = columns[known:] - beside.T @ terms
        left = noise.diagonal()[known:] - np.sum(beside**2, axis=0)
        variance = left + np.sum(away * np.linalg.solve(inner, away.T).T, axis=1)
        mean = columns[known:] @ coefficients + beside.T @ (load - terms @ coefficients)
        return mean, self.scale * np.sqrt(np.maximum(variance, 0.0))


def _values(term: Term, time: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return a term (n,) over times and depths (n,) that run over a unit."""
    name, number = term
    if name in ("zero", "offset"):
        return np.ones_like(time)
    if name in ("tilt", "drift"):
        return depth if name == "tilt" else time
    phase = 2 * np.pi * number * depth
    return np.cos(phase) if name == "cosine" else np.sin(phase)


def learnt(air: Blocks, white: float) -> list[Baseline]:
    """Return the likely baselines of a load in air, the best first.

    Parameters
    ----------
    air
        Blocks before contact; time, depth and load run over a unit in the whole loading.
    white
        Standard deviation of the white noise of a point.
    """
    if len(air) < FOR_OFFSET:
        return [Baseline(ZERO, Noise())]
    duration, length = float(np.ptp(air.time)), float(np.ptp(air.depth))
    kinds = [Noise()]
    if len(air) >= FOR_SLOPE:
        kinds += [
            Noise("correlated", amplitude * white, share * duration)
            for amplitude, share in product(AMPLITUDES, CORRELATION_TIMES)
        ]
    if len(air) >= FOR_CURVE and length > 0.0:
        kinds += [Noise("smooth", bend, share * length) for bend, share in product(BENDS, LENGTHS)]
    sloped = STRAIGHT if len(air) >= FOR_SLOPE else STRAIGHT[:1]
    waves: list[tuple[Term, ...]] = [(), *_waves(air, white)]
    starts = [air.depth[0] + share * length if share else -np.inf for share in STARTS]
    tried: list[tuple[float, float, Baseline]] = []
    for kind, start in product(kinds, starts if len(air) >= FOR_CURVE else starts[:1]):
        noise = Noise(kind.kind, kind.amplitude, kind.reach, start)
        factor = cholesky(noise.covariance(air, white), lower=True, check_finite=False)
        for slope, wave in product(sloped, waves):
            one = Baseline((("offset", 0.0), *slope, *wave), noise)
            evidence, squares = _evidence(one, air, factor)
            tried.append((evidence - np.log(1 + 2 * (len(waves) - 1) * bool(wave)), squares, one))
    tried.sort(key=lambda each: -each[0])
    kept = [each for each in tried[:MOST] if each[0] > tried[0][0] - LIKELY]
    weights = np.exp([evidence - kept[0][0] for evidence, _, _ in kept])
    return [
        replace(one, weight=float(weight), count=len(air), squares=squares)
        for (_, squares, one), weight in zip(kept, weights / weights.sum(), strict=True)
    ]


def _evidence(baseline: Baseline, air: Blocks, factor: np.ndarray) -> tuple[float, float]:
    """Return the logarithm of a baseline's evidence in the air, less a constant, and its squared residuals over C."""
    whitened = solve_triangular(
        factor, np.column_stack([air.load, baseline.columns(air)]), lower=True, check_finite=False
    )
    load, terms = whitened[:, 0], whitened[:, 1:]
    spread = baseline.deviations
    inner = cholesky(terms.T @ terms + np.diag(spread**-2.0), lower=True)
    along = solve_triangular(inner, terms.T @ load, lower=True)
    left = max(float(load @ load - along @ along), 1e-12)
    half = np.log(np.diag(factor)).sum() + np.log(np.diag(inner)).sum() + np.log(spread).sum()
    return float(-half - 0.5 * len(air) * np.log(left)), left


def _waves(air: Blocks, white: float) -> Sequence[tuple[Term, ...]]:
    """Return the strongest wave of the air in depth, with neighbouring frequencies; none that does not repeat there.

    A least-squares periodogram (N.R. Lomb, Astrophys. Space Sci. 39 (1976) 447-462) beside a straight line.
    """
    span = float(np.ptp(air.depth))
    if len(air) < FOR_CURVE or span <= 0.0:
        return []
    frequency = np.arange(REPEATS, min(MOST_CYCLES, len(air) / 3), 0.1)
    if not len(frequency):
        return []
    along = (air.depth - air.depth[0]) / span
    straight = np.linalg.qr(np.column_stack([np.ones_like(along), along]))[0]
    phase = 2 * np.pi * along[:, None] * frequency
    cosine, sine = (_orthogonal(straight, wave(phase)) for wave in (np.cos, np.sin))
    rest = _orthogonal(straight, air.load[:, None])[:, 0]
    cc, ss, cs = (np.sum(a * b, axis=0) for a, b in ((cosine, cosine), (sine, sine), (cosine, sine)))
    c, s = rest @ cosine, rest @ sine
    power = (c**2 * ss + s**2 * cc - 2 * c * s * cs) / np.maximum(cc * ss - cs**2, 1e-12 * cc * ss)
    best = frequency[int(np.argmax(power))]
    near = [best + step for step in (-0.07, 0.0, 0.07) if best + step >= REPEATS]
    return [(("cosine", f / span), ("sine", f / span)) for f in near]


def _orthogonal(basis: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return columns (n, k) less their part along an orthonormal basis (n, p)."""
    return columns - basis @ (basis.T @ columns)
