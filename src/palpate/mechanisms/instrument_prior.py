"""What an earlier study found of an instrument's effects: their prior in the next study on the same instrument.

With data D_1 of the earlier study, sets of effects S and their amplitudes a, the posterior

    p(S, a | D_1) = P(S | D_1) N(a; m_S, V_S)

is the prior of the next one: the probability of each set of the shared effects, and a normal density of the amplitudes
of each set, jointly, in the coordinates in which both studies search for them. The effects of one set may be exchanged
for those of another one, as of twins that the earlier study could not tell apart: so each set has a density of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

LEAST = 1e-9  # probability of a set that the earlier study excludes: chosen; none is impossible (D. V. Lindley 1985)


@dataclass(frozen=True)
class SearchedRange:
    """Where the earlier study searched a quantity, which gives its coordinate; see `palpate.mechanisms.Range`."""

    lower: float
    upper: float
    typical: float | None


@dataclass(frozen=True, eq=False)
class JointAmplitudes:
    """A normal density of the amplitudes of one set of effects.

    Parameters
    ----------
    names
        Quantities, ``key.name``, (d,).
    mean : ndarray, shape (d,)
    covariance : ndarray, shape (d, d)
        Both by their coordinates, in widths of the ranges.
    """

    names: tuple[str, ...]
    mean: np.ndarray
    covariance: np.ndarray

    def of(self, keys: Iterable[str]) -> JointAmplitudes:
        """Return the marginal density of the amplitudes of some mechanisms."""
        places = [k for k, name in enumerate(self.names) if name.split(".")[0] in keys]
        names = tuple(self.names[k] for k in places)
        return JointAmplitudes(names, self.mean[places], self.covariance[np.ix_(places, places)])

    @classmethod
    def pooled(cls, parts: Sequence[tuple[float, JointAmplitudes]]) -> JointAmplitudes:
        """Return the density with mean and covariance of a mixture of some of the same quantities, with weights."""
        weights = np.array([weight for weight, _ in parts]) / sum(weight for weight, _ in parts)
        means = np.array([part.mean for _, part in parts])
        mean = weights @ means
        within = sum(weight * part.covariance for weight, (_, part) in zip(weights, parts, strict=True))
        return cls(parts[0][1].names, mean, within + (weights[:, None] * (means - mean)).T @ (means - mean))


def pooled_by_shared(
    sets: Iterable[tuple[frozenset[str], float, JointAmplitudes | None]], keys: frozenset[str]
) -> tuple[dict[frozenset[str], float], dict[frozenset[str], JointAmplitudes]]:
    """Return the probability of each set of the shared mechanisms `keys`, and the density of its amplitudes if known.

    Each of the `sets` has its mechanisms, a probability and a density of amplitudes of shared mechanisms at least; None
    where it is not known. Those that differ in other mechanisms alone count together.
    """
    probabilities = dict[frozenset[str], float]()
    parts = dict[frozenset[str], list[tuple[float, JointAmplitudes]]]()
    for mechanisms, probability, amplitudes in sets:
        members = mechanisms & keys
        probabilities[members] = probabilities.get(members, 0.0) + probability
        if members and amplitudes is not None:
            parts.setdefault(members, []).append((probability, amplitudes.of(members)))
    return probabilities, {members: JointAmplitudes.pooled(found) for members, found in parts.items()}


@dataclass(frozen=True, eq=False)
class InstrumentPrior:
    """The posterior of an earlier study.

    Parameters
    ----------
    study
        Its name.
    ranges
        Of each quantity of each shared mechanism.
    probabilities
        Of each set of the shared mechanisms that it considered.
    amplitudes
        Of those sets that it fitted.
    """

    study: str
    ranges: Mapping[str, Mapping[str, SearchedRange]]
    probabilities: Mapping[frozenset[str], float]
    amplitudes: Mapping[frozenset[str], JointAmplitudes]

    @property
    def keys(self) -> frozenset[str]:
        """The shared mechanisms."""
        return frozenset(self.ranges)

    def log_probability(self, members: frozenset[str]) -> float:
        """Return the log probability of a set of mechanisms that those of it which are shared, and no others, act."""
        return math.log(max(self.probabilities.get(members & self.keys, 0.0), LEAST))

    def amplitudes_of(self, members: frozenset[str]) -> JointAmplitudes | None:
        """Return the density of the shared amplitudes of a set of mechanisms; None where it was not fitted."""
        return self.amplitudes.get(members & self.keys)
