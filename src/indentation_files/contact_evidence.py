r"""How well each contact on trial explains a test: the evidence for contact, law, baseline and noise together.

The loads of a test, averaged over blocks, are

    P = B b + k L(h; h_0, m) + e,        e ~ N(0, s^2 C),

with a baseline B (`indentation_files.baseline`), a law L of the contact (`indentation_files.contact_law`) and the
covariance

    C = white noise / block size + (slope of the law x noise of the depth)^2 + correlated noise
        + (delta L)^2 smooth over a factor e of the way into the body + a free start.

The term in delta represents what every law leaves out; it makes deep points count less, so that no end of the fit has
to be chosen. The coefficients b have normal priors, k a uniform one about what the load rises by, s the prior 1/s; all
are integrated out, so that baselines with more terms pay for them. What remains is the evidence of h_0, of law,
baseline and C, and the posterior of h_0 is its sum over all the others: the interval includes their uncertainty.

Sources: D.J.C. MacKay, Neural Computation 4 (1992) 415-447 (evidence); M.C. Kennedy and A. O'Hagan, J. R. Stat. Soc. B
63 (2001) 425-464 (a law's discrepancy as a Gaussian process).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TypeVar

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.linalg.lapack import dtrtrs
from scipy.special import ndtr

from indentation_files.baseline import DEVIATIONS, Baselines, Term, correlated, values
from indentation_files.contact_law import Laws

DISCREPANCIES = (0.001, 0.01, 0.05, 0.2)  # of the law from the body, on trial; shares of its load
STARTS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.35)  # free starts on trial, shares of the approach
# Of correlated noise on trial: in standard deviations of the white noise, and as shares of the duration.
AMPLITUDES, CORRELATION_TIMES = (0.1, 0.3, 1.0, 3.0, 10.0), (0.0005, 0.0015, 0.005, 0.015, 0.05, 0.2)
LIKELY, POSSIBLE, COUNTS = 4.0, 10.0, 12.0  # nats below the best: combined with one another, tried again, counted
EVEN = 400  # points, over which slopes are taken
MOST = 6  # baselines, and kinds of correlated noise, that are combined
ROUNDING = 1e-10  # of the largest variance, added to all: equal covariances of noise-free points stay definite
Value = TypeVar("Value")


@dataclass(frozen=True)
class Blocks:
    """Averages over blocks of points, all (n,); time, depth and load run over a unit.

    A block has `count` points, and lies between the times `begin` and `end`.
    """

    time: np.ndarray
    depth: np.ndarray
    load: np.ndarray
    count: np.ndarray
    begin: np.ndarray
    end: np.ndarray

    @classmethod
    def of(cls, edges: np.ndarray, time: np.ndarray, depth: np.ndarray, load: np.ndarray) -> Blocks:
        """Average channels (n,) between the indices `edges` (b + 1,), from 0 to the number of points that count."""
        count = np.diff(edges)
        clock, way, force = (np.add.reduceat(c[: edges[-1]], edges[:-1]) / count for c in (time, depth, load))
        between = 0.5 * (time[:-1] + time[1:])[edges[1:-1] - 1]
        before, behind = (0.5 * float(time[k + 1] - time[k]) for k in (0, edges[-1] - 2))
        begin, end = np.append(time[0] - before, between), np.append(between, time[edges[-1] - 1] + behind)
        return cls(clock, way, force, count, begin, end)


@dataclass(frozen=True)
class ResidualNoise:
    """What the covariance of the residuals is made of.

    Correlated noise has an `amplitude`, its standard deviation over that of the white noise of a point, and a
    `correlation_time`; it is the load's, or, by the slope of the law, that `of_depth`. `discrepancy` is delta. The
    share `start` of the approach, from its start, may depart from the baseline freely.
    """

    amplitude: float = 0.0
    correlation_time: float = 0.0
    discrepancy: float = 0.01
    start: float = 0.0
    of_depth: bool = False


@dataclass(frozen=True)
class ContactGuess:
    """A contact, the law beyond it (loads (n,) and slopes (n,) at the blocks), and its load at the last of them."""

    contact: float
    loads: np.ndarray
    slopes: np.ndarray

    @property
    def rise(self) -> float:
        """Load at the end of the fit."""
        return float(self.loads.max())


Setting = tuple[ResidualNoise, tuple[Term, ...]]


class Evidence:
    """Evidence for contacts (k,) and laws, under every noise and baseline that is asked for.

    The `guess` is a contact near the right one, by which deep points of the `blocks` are known to be deep; `white` and
    `depth_noise` are standard deviations of the white noise of a point.
    """

    def __init__(
        self,
        blocks: Blocks,
        guess: ContactGuess,
        baselines: Baselines,
        laws: Laws,
        contacts: np.ndarray,
        white: float,
        depth_noise: float,
    ) -> None:
        self.blocks, self.guess, self.baselines, self.laws, self.contacts = blocks, guess, baselines, laws, contacts
        self.white, self.depth_noise = white, depth_noise
        self.variance = (white**2 + (guess.slopes * depth_noise) ** 2) / blocks.count
        self.free = int(np.argmax(blocks.depth > guess.contact))
        self.prior = np.tile(laws.log_prior, len(contacts))
        self.terms = sorted({term for terms in baselines.combinations() for term in terms})
        self.found: dict[Setting, tuple[float, np.ndarray, np.ndarray]] = {}
        self._products: dict[ResidualNoise, tuple[float, np.ndarray, np.ndarray, np.ndarray]] = {}
        self._correlated: dict[float, np.ndarray] = {}
        self._baselines: dict[tuple[Term, ...], tuple[np.ndarray, np.ndarray, float]] = {}

    @cached_property
    def columns(self) -> np.ndarray:
        """Loads, terms and laws (n, 1 + terms + contacts x laws)."""
        blocks, end = self.blocks, float(self.blocks.depth.max())
        laws = self.laws.loads(blocks.depth, self.contacts, end).reshape(len(blocks.load), -1)
        terms = [values(term, blocks.time, blocks.depth) for term in self.terms]
        return np.column_stack([blocks.load, *terms, laws])

    @cached_property
    def discrepancy(self) -> np.ndarray:
        """Covariance (n, n) of a law's discrepancy, for delta one."""
        way = np.maximum(self.blocks.depth - self.guess.contact, 0.0) / np.ptp(self.blocks.depth)
        apart = np.subtract.outer(*2 * [np.log(np.maximum(way, 1e-6))])
        return np.outer(self.guess.loads, self.guess.loads) * np.exp(-0.5 * apart**2)

    def covariance(self, noise: ResidualNoise) -> np.ndarray:
        """Return C (n, n)."""
        found = np.diag(self.variance) + noise.discrepancy**2 * self.discrepancy
        if noise.amplitude:
            time = noise.correlation_time
            if time not in self._correlated:
                self._correlated[time] = correlated(self.blocks.begin, self.blocks.end, time)
            level = self.guess.slopes * self.depth_noise if noise.of_depth else np.full(len(found), self.white)
            found += noise.amplitude**2 * np.outer(level, level) * self._correlated[time]
        start = int(noise.start * self.free)
        if start:
            found[np.diag_indices(start)] += max(float(np.ptp(self.blocks.load[:start])), self.white) ** 2
        return found

    def products(self, noise: ResidualNoise) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """Return half of log |C|, and products over C.

        Of load and terms with each other (1 + terms, 1 + terms) and with load and laws (1 + terms, 1 + columns), and of
        each law with itself (columns,).
        """
        if noise not in self._products:
            covariance = self.covariance(noise)
            covariance[np.diag_indices(len(covariance))] += ROUNDING * covariance.diagonal().max()
            factor = cholesky(covariance, lower=True, check_finite=False)
            whitened = solve_triangular(factor, self.columns, lower=True, check_finite=False)
            linear, laws = np.split(whitened, [1 + len(self.terms)], axis=1)
            half = float(np.log(np.diag(factor)).sum())
            beside = linear.T @ np.column_stack([linear[:, 0], laws])
            self._products[noise] = half, linear.T @ linear, beside, np.einsum("ij,ij->j", laws, laws)
        return self._products[noise]

    def try_out(self, noises: Iterable[ResidualNoise], baselines: Iterable[tuple[Term, ...]]) -> Setting:
        """Try every noise with every baseline; return the best setting found so far."""
        baselines = list(baselines)
        for noise in noises:
            for terms in baselines:
                if (noise, terms) not in self.found:
                    self.found[noise, terms] = self._evidence(noise, terms)
        return max(self.found, key=lambda setting: self.found[setting][0])

    def _evidence(self, noise: ResidualNoise, terms: tuple[Term, ...]) -> tuple[float, np.ndarray, np.ndarray]:
        """Return the logarithms of the evidence of a setting, and of each contact and law in it, and k (columns,)."""
        half, linear, mixed, laws = self.products(noise)
        chosen, precision, prior = self._baseline(terms)
        factor = np.linalg.cholesky(linear[chosen[:, None], chosen] + precision)
        along, _ = dtrtrs(factor, mixed[chosen], lower=1)
        of_load, of_law = along[:, 0], along[:, 1:]
        load = max(linear[0, 0] - of_load @ of_load, 1e-12)
        law = np.maximum(laws - np.einsum("ij,ij->j", of_law, of_law), 1e-10 * laws + 1e-12)
        amplitude = (mixed[0, 1:] - of_load @ of_law) / law
        left = np.maximum(load - amplitude**2 * law, 1e-9 * load)
        degrees = len(self.blocks.load) - 2
        error, rise = np.sqrt(left / degrees / law), self.guess.rise
        within = ndtr((2 * rise - amplitude) / error) - ndtr((0.5 * rise - amplitude) / error)
        even = prior - half - float(np.log(factor.diagonal()).sum())
        score = self.prior + even - 0.5 * (degrees * np.log(left) + np.log(law)) + np.log(np.maximum(within, 1e-300))
        most = float(score.max())
        return most + float(np.log(np.exp(score - most).sum())), score, amplitude

    def _baseline(self, terms: tuple[Term, ...]) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the columns of a baseline's terms, the prior precision of their coefficients and the log of its prior.

        To the last the normalisation of the coefficients' prior is added.
        """
        if terms not in self._baselines:
            spread = np.array([DEVIATIONS[name.split()[0]] for name, _ in terms])
            prior = self.baselines.log_prior(terms) - float(np.log(spread).sum())
            chosen = np.array([1 + self.terms.index(term) for term in terms])
            self._baselines[terms] = chosen, np.diag(spread**-2.0), prior
        return self._baselines[terms]

    def near(self, nats: float) -> list[Setting]:
        """Return the settings whose evidence lies within `nats` of the best, best first."""
        ordered = sorted(self.found, key=lambda setting: -self.found[setting][0])
        least = self.found[ordered[0]][0] - nats
        return [setting for setting in ordered if self.found[setting][0] >= least]

    def search(self, noises: Sequence[ResidualNoise]) -> Setting:
        """Try baselines, correlated noise, free starts and discrepancies; return the best setting.

        Each is varied by itself about the best of the others; then what is likely is combined.
        """
        first = [ResidualNoise(), ResidualNoise(1.0, 0.03, of_depth=noises[-1].of_depth)]
        self.try_out(first, self.baselines.combinations())
        best = self.try_out(noises, _first(MOST, (terms for _, terms in self.near(POSSIBLE))))
        likely = _first(MOST, (terms for _, terms in self.near(POSSIBLE)))
        best = self.try_out([replace(best[0], start=start) for start in STARTS], likely)
        best = self.try_out([replace(best[0], discrepancy=delta) for delta in DISCREPANCIES], likely)
        kept = self.near(LIKELY)
        processes = _first(MOST, (replace(noise, discrepancy=0.0, start=0.0) for noise, _ in self.near(POSSIBLE)))
        deltas = _first(len(DISCREPANCIES), (noise.discrepancy for noise, _ in kept))
        starts = _first(MOST // 2, (noise.start for noise, _ in kept))
        combined = [
            replace(noise, discrepancy=delta, start=start) for noise, delta, start in product(processes, deltas, starts)
        ]
        return self.try_out(combined, _first(MOST, (terms for _, terms in kept)))

    def posterior(self) -> np.ndarray:
        """Return the posterior weights of contacts and laws (k, laws), which sum up to one."""
        best = max(found[0] for found in self.found.values())
        total = np.sum([np.exp(self.found[setting][1] - best) for setting in self.near(COUNTS)], axis=0)
        return (total / total.sum()).reshape(len(self.contacts), -1)

    def fitted(self, setting: Setting) -> tuple[np.ndarray, ContactGuess]:
        """Return the baseline (n,) of a setting, with its best contact and law as a guess for the next search."""
        noise, terms = setting
        _, score, amplitude = self.found[setting]
        best = int(np.argmax(score))
        _, linear, mixed, _ = self.products(noise)
        chosen, precision, _ = self._baseline(terms)
        rest = linear[chosen, 0] - amplitude[best] * mixed[chosen, 1 + best]
        coefficients = np.linalg.solve(linear[chosen[:, None], chosen] + precision, rest)
        loads = amplitude[best] * self.columns[:, 1 + len(self.terms) + best]
        contact = float(self.contacts[best // len(self.laws)])
        return self.columns[:, chosen] @ coefficients, ContactGuess(contact, loads, slopes_of(self.blocks.depth, loads))


def _first(most: int, found: Iterable[Value]) -> list[Value]:
    """Return the first few different values."""
    return list(dict.fromkeys(found))[:most]


def slopes_of(depth: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Return the slope (n,) of a law's loads (n,) over noisy depths (n,), by even steps of the depth."""
    order = np.argsort(depth)
    even = np.linspace(depth.min(), depth.max(), EVEN)
    return np.interp(depth, even, np.gradient(np.interp(even, depth[order], loads[order]), even))
