"""What the best Burgers solid leaves of other creep: the structure of a law's discrepancy, and its modulus' error.

The families, their seeds and their tests are reported by no trial: power, logarithmic and stretched-exponential creep,
without noise. Each candidate is a Gaussian process. Its standard deviation is the likeliest for each fit, the four
parameters integrated over to first order (restricted maximum likelihood), beside a noise of `NOISE` of the misfit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import least_squares
from scipy.special import gamma, gammainc

from palpate.inference.law_structure import HISTORIES, TIMES, Indentation, features, kernel
from palpate.mechanisms.draws import log_uniform
from palpate.study.protocol import Protocol, trapezoid
from studies.coverage.creep import POISSON_RATIO, HasIntegral, burgers, depth
from studies.coverage.solid import RANGES

SEED, COUNT = 7, 45
TESTS = [(10, 0, 1), (10, 1, 1), (20, 0, 0.5), (40, 2, 1), (80, 0, 1), (80, 1, 0.5)]  # loading [s], hold, unloading
NOISE = 0.03  # of the mean square that the fit leaves
OWN = 0.05  # of the variance, each test's own
SHARES = np.geomspace(0.15, 5.0, 18)  # of the root mean square that the fit leaves
WITHIN = (0.1, 0.2, 0.4)  # of a segment, lengths of the process that knows tests and segments alone
FACTORS = (0.5, 1.0, 2.0)  # times the lengths of the process over histories


@dataclass(frozen=True)
class Creep:
    """A compliance by the integral of its creep, which follows an elastic part [1/GPa]."""

    elastic: float
    creep: Callable[[np.ndarray], np.ndarray]

    def integral(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of M from 0 to times (n,) [s/GPa]; zero before."""
        time = np.maximum(time, 0.0)
        return self.elastic * time + self.creep(time)


@dataclass(frozen=True, eq=False)
class Left:
    """What the best Burgers solid leaves: relative residuals (n,), slopes (n, 4), and ln(E true / E fitted)."""

    residual: np.ndarray
    slopes: np.ndarray
    modulus: float
    family: str

    @property
    def rms(self) -> float:
        """Root mean square as a share of the depth."""
        return float(np.sqrt(np.mean(self.residual**2)))


def protocols() -> list[Protocol]:
    """Return the tests."""
    durations = [(t, t * hold, t * unloading) for t, hold, unloading in TESTS]
    return [trapezoid(1.0, *each, points=round(20 * sum(each) / each[0])) for each in durations]


def materials(rng: np.random.Generator, count: int) -> Iterator[tuple[str, Creep]]:
    """Yield kinds of creep that differ from the Burgers solid: 0.1 to 0.6 of the elastic part after a minute."""
    for number in range(count):
        elastic = (1.0 - POISSON_RATIO**2) / rng.uniform(2.0, 5.0)
        strength, family = elastic * rng.uniform(0.1, 0.6), ("power", "logarithmic", "stretched")[number % 3]
        yield family, Creep(elastic, _integral(family, strength, rng))


def left_by_burgers(family: str, material: HasIntegral, elastic: float) -> Left:
    """Return what the best Burgers solid leaves of the depths of a material."""
    tests = protocols()
    exact = np.concatenate([depth(material, test) for test in tests])
    largest = np.concatenate([np.maximum.accumulate(depth(material, test)) for test in tests])

    def left(x: np.ndarray) -> np.ndarray:
        return (np.concatenate([depth(burgers(*np.exp(x)), test) for test in tests]) - exact) / largest

    wide = np.log(np.array(list(RANGES.values())).T) + np.array([[-1.0], [1.0]]) * np.log(10.0)
    modulus = (1.0 - POISSON_RATIO**2) / elastic
    starts = [np.log([modulus, 1e-3, 0.1, time]) for time in (3.0, 20.0, 100.0)]
    best = min((least_squares(left, x, bounds=wide, xtol=1e-5) for x in starts), key=lambda found: found.cost)
    return Left(-best.fun, best.jac, float(np.log(modulus) - best.x[0]), family)


def structures() -> dict[str, np.ndarray]:
    """Return the correlation (n, n) of each candidate, by name."""
    tests = protocols()
    lengths = [len(test.sample_time) for test in tests]
    same = np.equal.outer(*[np.repeat(np.arange(len(tests)), lengths)] * 2).astype(float)
    places = np.concatenate([_segment(test) for test in tests])[:, None]
    times = np.concatenate([np.full(n, np.log(test.knot_time[1])) for test, n in zip(tests, lengths, strict=True)])
    holds = np.concatenate([np.full(n, float(len(test.knot_time) > 3)) for test, n in zip(tests, lengths, strict=True)])
    found = {}
    for length in WITHIN:
        shared = np.exp(-0.5 * (np.subtract.outer(times, times) / 0.6) ** 2 - np.subtract.outer(holds, holds) ** 2 / 2)
        found[f"segments, length {length:g}"] = kernel(places / length) * shared
    for by_time in FACTORS:
        for by_history in FACTORS:
            parts = [features(Indentation(test)) for test in tests]
            scaled = np.vstack(parts) / np.append(by_time, np.full(parts[0].shape[1] - 1, by_history))
            found[f"histories, a {by_time * TIMES:g}, b {by_history * HISTORIES:g}"] = kernel(scaled)
    return {name: (1.0 - OWN) * of + OWN * of * same for name, of in found.items()}


def log_likelihood(correlation: np.ndarray, left: Left) -> float:
    """Return the restricted log-likelihood of a residual at its likeliest standard deviation."""
    values, vectors = np.linalg.eigh(correlation)
    residual, slopes, found = vectors.T @ left.residual / left.rms, vectors.T @ left.slopes, -np.inf
    for share in SHARES:
        weights = 1.0 / (share**2 * np.maximum(values, 0.0) + NOISE)
        information, pull = (slopes.T * weights) @ slopes, (slopes.T * weights) @ residual
        squares = weights @ residual**2 - pull @ np.linalg.solve(information, pull)
        found = max(found, 0.5 * (np.log(weights).sum() - squares - np.linalg.slogdet(information)[1]))
    return float(found)


def tables() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the mean log-likelihood of each structure by family, and the error of the modulus over the misfit."""
    drawn = materials(np.random.default_rng(SEED), COUNT)
    fits = [left_by_burgers(family, material, material.elastic) for family, material in drawn]
    rows = [
        {"structure": name, "family": fit.family, "log_likelihood": log_likelihood(correlation, fit)}
        for name, correlation in structures().items()
        for fit in fits
    ]
    moduli = pd.DataFrame(
        [{"family": f.family, "misfit": f.rms, "modulus_over_misfit": f.modulus / f.rms} for f in fits]
    )
    means = pd.DataFrame(rows).pivot_table("log_likelihood", "structure", "family", margins=True, margins_name="all")
    return means.drop("all").sort_values("all", ascending=False), moduli


def _integral(family: str, strength: float, rng: np.random.Generator) -> Callable[[np.ndarray], np.ndarray]:
    """Return the integral of a creep that reaches a strength [1/GPa] after a minute."""
    if family == "power":
        exponent = rng.uniform(0.15, 0.5)
        return lambda t: strength / 60.0**exponent * t ** (exponent + 1.0) / (exponent + 1.0)
    if family == "logarithmic":
        first = log_uniform(rng, 0.1, 10.0)
        return lambda t: strength / np.log1p(60.0 / first) * ((t + first) * np.log1p(t / first) - t)
    time, exponent = log_uniform(rng, 2.0, 100.0), rng.uniform(0.3, 0.7)
    whole, mean = strength / -np.expm1(-((60.0 / time) ** exponent)), time / exponent * gamma(1.0 / exponent)
    return lambda t: whole * (t - mean * gammainc(1.0 / exponent, (t / time) ** exponent))


def _segment(protocol: Protocol) -> np.ndarray:
    """Return the place (n_points,) within a test: loading from 0 to 1, a hold from 1 to 2, unloading from 2 to 3."""
    corners = [0.0, 1.0, 2.0, 3.0] if len(protocol.knot_time) > 3 else [0.0, 1.0, 2.0]
    place = np.interp(protocol.sample_time, protocol.knot_time, corners)
    return place if len(corners) > 3 else np.where(place > 1.0, place + 1.0, place)
