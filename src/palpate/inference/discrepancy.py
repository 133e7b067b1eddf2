r"""The discrepancy of a law: what the best material of a law that is not quite right leaves, smooth along the tests.

No material obeys a law to the noise of averaged recordings. Under test a the mean depth is

    d_a = h_a(theta) + effects + delta_a + errors of the mesh + noise,        delta = h_m x,

with h_m the largest depth so far, by which a recovered depth is measured, too. x is a Gaussian process of standard
deviation `share` (M. C. Kennedy and A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425-464). Its structure is that of the
physics. A sharp tip on a homogeneous body has no length, so depth / sqrt(load) is a functional of the history up to
now alone, whatever the law: of the present time t, since the law may know times of its own, and of the normalised
history p(s) = (P(t (1 - s)) / max P)^(1/2), the depth of an elastic cone. So is x, and a functional that is smooth has
close values at close histories:

    corr(x, x') = exp(-(ln t - ln t')^2 / (2 a^2) - mean (p(s) - p'(s))^2 / (2 b^2)).

Two tests of one normalised history and equal times share x wholly, at every load; while both are loaded evenly they
share it at equal times even if their rates differ; a corner of the history changes p, and so ends the memory. What has
a length of its own, a sphere or a film, loses that memory with the logarithm of the ratio of loads. Tips, contacts,
instruments and meshes breach the scaling a little, so `own` of the variance belongs to what does not obey it, of one
kind or of several: of each test alone, with the clock, since the load turned, or with a length, see
`palpate.inference.law_structure`. With a correlation of exactly one each breach by a thousandth would be named.
Replicates share x wholly.

Of these a length matters most. What any body, tip or instrument with one length does, a film, a rounded tip and a
compliant frame do nearly, too. So an unlisted length is as simple a function as those in the library: it crosses over
between two neighbouring lengths, and its size is not tied to that of the law. A flexible process would lose against
any function of two parameters, and a gradient of the modulus would be called a film.

None of the three is known. A quadrature over `SHARES` and `SHAPES` integrates over all, with a prior that is the same
for all explanations compared. The median that a study states as `calibration.law_error` is that of
the part that obeys the scaling law.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.special import logsumexp
from scipy.stats import logistic

from palpate.inference.law_structure import (
    CROSSINGS,
    Indentation,
    Tests,
    clocks,
    common,
    crossovers,
    of_several_loads,
    parts_of_tests,
    reversals,
)

PRIOR_SCALE = 0.68  # of the logistic density of ln(share): 95 % lie within a factor of twelve of the median
SHARES = np.geomspace(5e-5, 0.1, 39)  # nodes of the quadrature over `share`
OBEYS = 0.01  # `own` of what obeys the scaling law: one node, of several kinds in equal parts
OWN = (0.1, 0.9)  # further nodes of the quadrature over `own`; all three are equally probable beforehand
OWN_OF_LENGTH = (0.9, 0.99, 0.999)  # the same where a single length acts, whose size that of the law does not limit
LEARNING_RATE = 0.5  # power to which evidence counts where no explanation is exact, see `power_of_evidence`
BREACHES = ("test", "clock", "reversal")
LENGTHS = tuple(f"{of} {k}" for of in ("depth", "load") for k in range(len(CROSSINGS) - 1))
KINDS = (*BREACHES, "several")


def _shapes() -> dict[tuple[str, float], float]:
    """Return `kind` and `own` of the nodes with their prior: each kind is as probable, all lengths together one."""
    kind = 1.0 / (len(KINDS) + 1)
    of_one, of_length = kind / (len(OWN) + 1), kind / (len(LENGTHS) * len(OWN_OF_LENGTH))
    found = {("several", OBEYS): of_one * len(KINDS)}
    found |= {(each, own): of_one for each in KINDS for own in OWN}
    return found | {(each, own): of_length for each in LENGTHS for own in OWN_OF_LENGTH}


@dataclass(frozen=True)
class Size:
    """The size of a discrepancy.

    Parameters
    ----------
    share
        Standard deviation as a share of the depth [-].
    own
        Share of the variance that breaches the scaling law [-].
    kind
        Of that breach, of `KINDS` or `LENGTHS`.
    """

    share: float = 0.0
    own: float = 0.0
    kind: str = "several"


SHAPES = _shapes()
SIZES = np.array([Size(float(share), own, kind) for kind, own in SHAPES for share in SHARES], dtype=object)  # the nodes


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """The covariance of a law's discrepancy under some tests, one after the other.

    Parameters
    ----------
    common : ndarray, shape (n, m)
        Columns of the part that obeys the scaling law, per unit of `share` [nm].
    breaches : Mapping
        Columns (n, m') of the part that breaches it, for each of `BREACHES` and `LENGTHS`.
    scale : ndarray, shape (n,)
        Largest depth so far [nm].
    law_error
        Median of the prior of `share` [-].
    size
        By default none.
    """

    common: np.ndarray
    breaches: Mapping[str, np.ndarray]
    scale: np.ndarray
    law_error: float
    size: Size = Size()

    @classmethod
    def of(
        cls,
        tests: Sequence[Indentation],
        depths: Mapping[str, np.ndarray],
        law_error: float,
        shares: Mapping[str, float],
    ) -> Discrepancy:
        """Return the structure, without a size yet, about simulated depths.

        Parameters
        ----------
        tests
            Histories and tips.
        depths
            Simulated curve (n_points,) of each test, in their order [nm].
        law_error
            Median of the prior of its standard deviation [-].
        shares
            Relative change of a test's response where the depth under the same load changes, see
            `palpate.observables.observable`; one where not given.
        """
        every, scale = tuple(tests), largest_depths(depths, shares)
        breaches = {
            "test": scale[:, None] * parts_of_tests(every),
            "clock": mean_depth(depths) * clocks(every),
            "reversal": scale[:, None] * reversals(every),
            **{kind: scale[:, None] * part for kind, part in _with_length(every, depths).items()},
        }
        return cls(scale[:, None] * common(every), breaches, scale, law_error)

    @property
    def share(self) -> float:
        """Standard deviation as a share of the depth [-]."""
        return self.size.share

    def sized(self, size: Size) -> Discrepancy:
        """Return the same with another size."""
        return replace(self, size=size)

    @cached_property
    def covariance(self) -> np.ndarray:
        """Covariance (n, n) [nm^2]."""
        columns = self.columns * self.deviations(self.size.own, self.size.kind)
        return self.share**2 * columns @ columns.T

    @property
    def log_prior(self) -> float:
        """Logarithm of the prior weight of its size, that of a node of the quadrature."""
        own, kind = self.size.own, self.size.kind
        same = {k: size.share for k, size in enumerate(SIZES) if (size.own, size.kind) == (own, kind)}
        nearest = min(same, key=lambda k: float(abs(np.log(same[k] / self.share))))
        return float(log_prior(self.law_error)[nearest])

    @cached_property
    def columns(self) -> np.ndarray:
        """All columns (n, m) [nm]."""
        return np.column_stack([self.common, *self.breaches.values()])

    def left_by_best(self, tangent: np.ndarray, of_law: bool = False) -> np.ndarray:
        """Return what the best parameters leave at each node (q,): root mean square as a share of the depth [-].

        Parameters
        ----------
        tangent : ndarray, shape (n, k)
            Slopes of the depths by the parameters [nm].
        of_law
            Whether only what obeys the scaling law counts.
        """
        # A test that a distant model lifts off has no depth to be a share of, and no column.
        share = np.divide(1.0, self.scale, out=np.zeros_like(self.scale), where=self.scale > 0.0)[:, None]
        basis, columns = np.linalg.qr(share * tangent)[0], share * self.columns
        squares = np.mean((columns - basis @ (basis.T @ columns)) ** 2, axis=0)
        squares[self.common.shape[1] if of_law else len(squares) :] = 0.0
        found = [SHARES * np.sqrt(self.deviations(own, kind) ** 2 @ squares) for kind, own in SHAPES]
        return np.concatenate(found)

    def deviations(self, own: float, kind: str) -> np.ndarray:
        """Return the standard deviation (m,) of each column's coefficient at a share of one."""
        several = own / len(BREACHES) if kind == "several" else 0.0
        of_kinds = {**dict.fromkeys(self.breaches, 0.0), **dict.fromkeys(BREACHES, several)}
        if kind in LENGTHS:
            of_kinds[kind] = 0.5 * own  # of two columns
        elif kind in BREACHES:
            of_kinds[kind] = own
        counts = [self.common.shape[1], *(columns.shape[1] for columns in self.breaches.values())]
        return np.sqrt(np.repeat([1.0 - own, *of_kinds.values()], counts))


def _with_length(tests: Tests, depths: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return columns (n, 2 t + 1) of what crosses over with depth and load under t tips of several loads, by `LENGTHS`.

    Where each tip has one load there is no column: a length would be one more part of the law.
    """
    depth, tips = np.abs(np.concatenate(list(depths.values()))), of_several_loads(tests)
    if not tips:
        return dict.fromkeys(LENGTHS, np.zeros((len(depth), 0)))
    relative = depth / np.maximum(largest_depths(depths, {}), 1e-9 * depth.max())
    drive = np.concatenate([test.protocol.sample_drive for test in tests])
    parts = [*crossovers(depth, relative, tips), *crossovers(drive, relative, tips)]
    return dict(zip(LENGTHS, parts, strict=True))


def mean_depth(depths: Mapping[str, np.ndarray]) -> float:
    """Return the mean of the largest depths of tests [nm], by which what follows the clock is measured."""
    return float(np.mean([np.abs(curve).max() for curve in depths.values()]))


def largest_depths(depths: Mapping[str, np.ndarray], shares: Mapping[str, float]) -> np.ndarray:
    """Return the largest depth so far (n,) of tests [nm], times the relative change of their responses, see `of`."""
    return np.concatenate([shares.get(n, 1.0) * np.maximum.accumulate(np.abs(h)) for n, h in depths.items()])


@lru_cache(maxsize=8)
def log_prior(law_error: float) -> np.ndarray:
    """Return the logarithm of the prior weight (q,) of each of `SIZES`."""
    of_law = np.array([size.share * np.sqrt(1.0 - size.own) for size in SIZES])
    density = logistic.logpdf(np.log(of_law / law_error) / PRIOR_SCALE).reshape(len(SHAPES), -1)
    shapes = np.log(list(SHAPES.values())) - logsumexp(density, axis=1)
    return (density + shapes[:, None]).ravel()


def power_of_evidence(law: Discrepancy | None) -> float:
    """Return the power to which evidence counts where explanations are compared: one if the law is taken to be exact.

    Bayes' rule is right where one of the explanations, with its discrepancy, made the recordings. Where all are wrong,
    as real laws, tips and instruments are, the points of a curve depart together in ways that no covariance here
    describes, and the ratio of two evidences is as much too large as these points are fewer than counted
    (P. Gruenwald, T. van Ommen, Bayesian Anal. 12 (2017) 1069; C. C. Holmes, S. G. Walker, Biometrika 104 (2017) 497;
    J. W. Miller, D. B. Dunson, J. Am. Stat. Assoc. 114 (2019) 1113). The power, the learning rate, is the one in
    steps of a tenth or so with which probabilities had the best log score on 200 sets of the study of claims, with
    departures and a seed that no reported result has; from 0.3 to 0.65 the score is nearly the same.
    """
    return 1.0 if law is None else LEARNING_RATE
