r"""Parameters, the coordinates in which they are searched for, and their prior.

A quantity with a unit that cannot be negative is scaled by its logarithm, an exponent or another pure number linearly:
laws of creep and flow are products of powers, whose valleys are straight in such coordinates. Where the range of a
quantity begins at zero, a hundredth of its largest value is added first,

    g(x) = ln(x + s),    u = (g(x) - g(lower)) / (g(upper) - g(lower)).

In the coordinate u the range of a parameter is 0 to 1. The prior is uniform within the range, and falls off outside as
a Gaussian whose standard deviation is the range itself: a range is what is thought plausible, not a limit. Only the
limits of the law are never exceeded.

Errors of instruments are mostly small and sometimes large. Where a mechanism states a typical size, the prior of its
amplitude is Cauchy's distribution about the middle of the range, as a mixture of normal ones (`CAUCHY`).

Amplitudes of which an earlier study on the same instrument gave the posterior have that as their prior, jointly normal.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2, norm

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.mechanisms import Mechanism, Range, Scale
from palpate.mechanisms.instrument_prior import JointAmplitudes

BEYOND_ZERO = 0.01  # of the upper end of a range that begins at zero, below which the scale is about linear
AT_LIMIT = 1e-3  # of the range, within which an estimate lies on a limit

# Standard deviations over the typical size, and their weights: 1 / sqrt(x), x of a chi-square distribution with one
# degree of freedom, in parts between its quantiles.
_PARTS = np.array([0.0, 0.3, 0.6, 0.8, 0.9, 0.96, 1.0])
CAUCHY_WEIGHTS = np.diff(_PARTS)
CAUCHY = 1.0 / np.sqrt(chi2.isf(0.5 * (_PARTS[1:] + _PARTS[:-1]), 1))

EVEN = 1e6  # variance of a density that is even beside a normal prior, in squared widths of the range


@dataclass(frozen=True, eq=False)
class Coordinate:
    """One free parameter.

    Parameters
    ----------
    name
    lower, upper
        Its range, in its unit.
    least, largest
        Its limits, in its unit.
    logarithmic
        Whether its logarithm is scaled.
    typical
        Distance from the middle of the range within which half of its prior lies, in its unit; none where the prior is
        even over the range.
    """

    name: str
    lower: float
    upper: float
    least: float
    largest: float
    logarithmic: bool = False
    typical: float | None = None

    @classmethod
    def of(cls, parameter: Parameter, lower: float, upper: float) -> Coordinate:
        """Return the coordinate of a declared parameter with a range from `lower` to `upper`."""
        logarithmic = parameter.unit != "-" and parameter.lower >= 0.0
        return cls(parameter.name, lower, upper, parameter.lower, parameter.upper, logarithmic)

    @classmethod
    def of_amplitude(cls, mechanism: Mechanism, name: str, searched: Range) -> Coordinate:
        """Return the coordinate of a quantity of a mechanism; it is called ``key.name``."""
        limits = mechanism.limits(name, searched)
        return cls(f"{mechanism.key}.{name}", searched.lower, searched.upper, *limits, searched.log, searched.typical)

    @property
    def offset(self) -> float:
        """What is added before the logarithm is taken, in its unit."""
        return BEYOND_ZERO * self.upper if self.lower == 0.0 else 0.0

    def scaled(self, value: np.ndarray | float) -> np.ndarray:
        """Return u (...,) of values (...,) in the parameter's unit; -inf for a zero on a logarithmic scale."""
        first, last = self._measure(self.lower), self._measure(self.upper)
        return (self._measure(value) - first) / (last - first)

    def physical(self, u: np.ndarray | float) -> np.ndarray:
        """Return the values (...,) at coordinates u (...,), within the limits."""
        first, last = self._measure(self.lower), self._measure(self.upper)
        measured = first + np.asarray(u) * (last - first)
        return np.clip(np.exp(measured) - self.offset if self.logarithmic else measured, self.least, self.largest)

    def slope(self, u: float) -> float:
        """Return the derivative of the parameter by its coordinate."""
        extent = self._measure(self.upper) - self._measure(self.lower)
        return float(extent * (self.physical(u) + self.offset if self.logarithmic else 1.0))

    def _measure(self, value: np.ndarray | float) -> np.ndarray:
        value = np.asarray(value, dtype=float)
        if not self.logarithmic:
            return value
        with np.errstate(divide="ignore"):
            return np.log(value + self.offset)


@dataclass(frozen=True, eq=False)
class NormalPrior:
    """A joint normal prior of some coordinates.

    Parameters
    ----------
    places : ndarray, shape (d,)
        Where they stand among all.
    mean : ndarray, shape (d,)
    covariance : ndarray, shape (d, d)
    """

    places: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, names: Sequence[str], found: JointAmplitudes | None) -> NormalPrior:
        """Return the prior of quantities that an earlier study `found`, among all `names`; of none without that."""
        if found is None:
            return cls(np.empty(0, dtype=int), np.empty(0), np.empty((0, 0)))
        return cls(np.array([names.index(name) for name in found.names], dtype=int), found.mean, found.covariance)

    @cached_property
    def whitening(self) -> np.ndarray:
        """Matrix (d, d) that makes departures from the mean independent, in standard deviations."""
        return np.linalg.inv(np.linalg.cholesky(self.covariance))


@dataclass(frozen=True, eq=False)
class Coordinates:
    """All free parameters of an explanation, and the values of those that are held.

    Parameters
    ----------
    free
        In the order of the coordinates u (k,).
    held
        Values by name.
    known
        What an earlier study found of amplitudes of the instrument.

    Raises
    ------
    InputError
        When every parameter is held.
    """

    free: Sequence[Coordinate]
    held: Mapping[str, float]
    known: JointAmplitudes | None = None

    def __post_init__(self) -> None:
        if not self.free:
            remedy = "give one of them at least two levels"
            raise InputError("every parameter is held", remedy=remedy, place="parameters")

    @classmethod
    def of(cls, levels: Mapping[str, Sequence[float]], declared: Mapping[str, Parameter]) -> Coordinates:
        """Return the coordinates of parameters with `levels` by name; one that has a single level is held."""
        ends = {name: (float(min(values)), float(max(values))) for name, values in levels.items()}
        free = [Coordinate.of(declared[name], *pair) for name, pair in ends.items() if pair[0] < pair[1]]
        return cls(free, {name: lower for name, (lower, upper) in ends.items() if lower == upper})

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> Coordinates:
        """Return the coordinates with those of mechanisms behind, in their order."""
        amplitudes = [
            Coordinate.of_amplitude(mechanism, name, searched)
            for mechanism in mechanisms
            for name, searched in mechanism.searched(scale).items()
        ]
        members = frozenset(name.split(".")[0] for name in self.names if "." in name)
        members = members.union(mechanism.key for mechanism in mechanisms)
        known = scale.instrument.amplitudes_of(members) if scale.instrument else None
        return Coordinates([*self.free, *amplitudes], self.held, known)

    @cached_property
    def normal(self) -> NormalPrior:
        """The joint normal prior of those with one."""
        return NormalPrior.of(self.names, self.known)

    @property
    def names(self) -> list[str]:
        """Names of the free parameters."""
        return [each.name for each in self.free]

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Limits of the coordinates (k,) below and above; infinite where there are none."""
        return (
            np.array([each.scaled(each.least) for each in self.free]),
            np.array([each.scaled(each.largest) for each in self.free]),
        )

    def named(self, u: np.ndarray) -> dict[str, float]:
        """Return all parameters by name at coordinates u (k,)."""
        return {**self.held, **{each.name: float(each.physical(x)) for each, x in zip(self.free, u, strict=True)}}

    def scaled(self, values: Mapping[str, float]) -> np.ndarray:
        """Return the coordinates (k,) of parameters by name."""
        return np.array([float(each.scaled(values[each.name])) for each in self.free])

    def beyond(self, u: np.ndarray) -> np.ndarray:
        """Return how far each coordinate (..., k) lies outside its range, negative below it; standard deviations.

        Those with a normal prior have no range.
        """
        found = np.minimum(u, 0.0) + np.maximum(u - 1.0, 0.0)
        found[..., self.normal.places] = 0.0
        return found

    def departures(self, u: np.ndarray) -> np.ndarray:
        """Return the departures (..., k) from the prior: how far each lies outside its range, or from a normal prior.

        They are in standard deviations. Those of a joint prior are made independent.
        """
        found, normal = self.beyond(u), self.normal
        found[..., normal.places] = (u[..., normal.places] - normal.mean) @ normal.whitening.T
        return found

    def slopes_of_departures(self, u: np.ndarray) -> np.ndarray:
        """Return the derivatives (k, k) of these at coordinates u (k,)."""
        found, places = np.diag(1.0 * (self.beyond(u) != 0.0)), self.normal.places
        found[np.ix_(places, places)] = self.normal.whitening
        return found

    def precision(self, variance: float) -> np.ndarray:
        """Return the precision (k, k) of the prior, where an even one has a `variance`."""
        found, places = np.eye(len(self.free)) / variance, self.normal.places
        found[np.ix_(places, places)] = self.normal.whitening.T @ self.normal.whitening
        return found

    def even_variances(self, variance: float) -> np.ndarray:
        """Return a `variance` for each coordinate (k,); `EVEN` for those whose normal prior counts by departures."""
        found = np.full(len(self.free), variance)
        found[self.normal.places] = EVEN
        return found

    @cached_property
    def cauchy(self) -> np.ndarray:
        """Places of the coordinates with Cauchy's prior."""
        return np.array([k for k in self._without_normal if self.free[k].typical is not None], dtype=int)

    @property
    def _without_normal(self) -> list[int]:
        return [k for k in range(len(self.free)) if k not in self.normal.places]

    @cached_property
    def cauchy_sizes(self) -> np.ndarray:
        """Their typical sizes, in widths of the range."""
        return np.array([self.free[k].typical / (self.free[k].upper - self.free[k].lower) for k in self.cauchy])

    def cauchy_mixture(self) -> Iterator[tuple[float, np.ndarray]]:
        """Yield the logarithm of the weight of each part of the joint prior of these, and the variances (c,) in it."""
        for parts in itertools.product(range(len(CAUCHY)), repeat=len(self.cauchy)):
            weight = np.log(CAUCHY_WEIGHTS[list(parts)]).sum()
            yield float(weight), (CAUCHY[list(parts)] * self.cauchy_sizes) ** 2

    def log_cauchy(self, u: np.ndarray) -> np.ndarray:
        """Return the log density of these (...,) at coordinates u (..., k)."""
        away = (u[..., self.cauchy] - 0.5)[..., None] / (CAUCHY * self.cauchy_sizes[:, None])
        parts = np.log(CAUCHY_WEIGHTS / CAUCHY) - 0.5 * away**2 - 0.5 * np.log(2.0 * np.pi)
        return np.sum(logsumexp(parts, axis=-1) - np.log(self.cauchy_sizes), axis=-1)

    def log_mass(self, first: int) -> float:
        """Return the logarithm of the mass of the prior of the coordinates from number `first` on, within the limits.

        An even prior has a density of one over the range and falls off beyond as a Gaussian of its width. A normal one
        is exp(-departures^2 / 2) on the density `even_variances`, which is not one.
        """
        even = [k for k in self._without_normal if k >= first and self.free[k].typical is None]
        least, largest = (ends[even] for ends in self.limits)
        beyond = norm.cdf(np.maximum(largest - 1.0, 0.0)) - norm.cdf(np.minimum(least, 0.0))
        of_normal = -np.log(np.diag(self.normal.whitening)).sum() - 0.5 * len(self.normal.places) * np.log(EVEN)
        return float(np.log1p(np.sqrt(2.0 * np.pi) * beyond).sum() + of_normal)

    def at_limit(self, u: np.ndarray) -> np.ndarray:
        """Return which coordinates (k,) lie on a limit."""
        least, largest = self.limits
        return (u < least + AT_LIMIT) | (u > largest - AT_LIMIT)
