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
a length of its own, a sphere or a film, loses that memory with the logarithm of the ratio of loads. As tips, contacts
and meshes breach the scaling a little, each test keeps a part of its own, `own` of the variance: with a correlation of
exactly one each breach by a thousandth would be named. Replicates share x wholly.

Neither number is known. A quadrature over `SHARES` and `OWN` integrates over both, with a prior that is the same for
all explanations compared.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import block_diag, lapack, solve_triangular
from scipy.special import log_ndtr, logsumexp

from palpate.study.protocol import Protocol

LAW_ERROR = 0.0025  # share of the depth, median of the prior; see docs/inference.md for the wrong laws that it rests on
TIMES = 0.8  # a, of the logarithm of time: fits of linear solids to power, logarithmic and stretched creep leave this
HISTORIES = 0.25  # b, of the root of the normalised load: the same
ROUGHER = 6.0  # times shorter than those of the law's discrepancy are the lengths of a mesh's ripple
LOADS = 0.7  # of the logarithm of the load, where body or tip has a length: a factor of two
AGO = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 24)])  # s, of the present time: the recent past counts most
DROPPED = 1e-4  # of the variance of x, below which columns are left out
PRIOR_SCALE = 0.68  # of the logistic density of ln(share): 95 % lie within a factor of twelve of the median
SHARES = np.geomspace(5e-5, 0.1, 39)  # nodes of the quadrature over `share`
OWN = np.array([0.01, 0.03, 0.1, 0.3, 0.9])  # nodes of the quadrature over `own`
OWN_WEIGHTS = np.array([0.2, 0.25, 0.25, 0.2, 0.1])  # their prior, chosen: even in ln(own) but for the last


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """The covariance of a law's discrepancy under some tests, one after the other.

    Parameters
    ----------
    common : ndarray, shape (n, m)
        Columns of the part that histories determine, per unit of `share` [nm].
    alone : ndarray, shape (n, m')
        Columns of the part that each test has of its own.
    scale : ndarray, shape (n,)
        Largest depth so far [nm].
    law_error
        Median of the prior of `share` [-].
    share
        Standard deviation as a share of the depth [-].
    own
        Share of the variance that each test has of its own.
    """

    common: np.ndarray
    alone: np.ndarray
    scale: np.ndarray
    law_error: float
    share: float = 0.0
    own: float = OWN[0]

    @classmethod
    def of(
        cls,
        protocols: Sequence[Protocol],
        sharp: bool,
        depths: Mapping[str, np.ndarray],
        law_error: float,
        shares: Mapping[str, float],
    ) -> Discrepancy:
        """Return the structure, without a size yet, about simulated depths.

        Parameters
        ----------
        protocols
            Of the tests.
        sharp
            Whether neither the tip nor the body has a length.
        depths
            Simulated curve (n_points,) of each test, in the order of the protocols [nm].
        law_error
            Median of the prior of its standard deviation [-].
        shares
            Relative change of a test's response where the depth under the same load changes, see
            `palpate.observables.observable`; one where not given.
        """
        common, alone = _correlated(tuple(protocols), sharp)
        scale = largest_depths(depths, shares)
        return cls(scale[:, None] * common, scale[:, None] * alone, scale, law_error)

    def sized(self, share: float, own: float) -> Discrepancy:
        """Return the same with another size."""
        return replace(self, share=share, own=own)

    @cached_property
    def covariance(self) -> np.ndarray:
        """Covariance (n, n) [nm^2]."""
        together, alone = self.common * np.sqrt(1.0 - self.own), self.alone * np.sqrt(self.own)
        return self.share**2 * (together @ together.T + alone @ alone.T)

    @property
    def log_prior(self) -> float:
        """Logarithm of the prior weight of its size, that of a node of the quadrature."""
        nodes = log_prior(*_nodes(), self.law_error)
        return float(nodes[np.argmin(np.abs(np.log(_nodes()[0] / self.share)) + np.abs(_nodes()[1] - self.own))])

    @property
    def columns(self) -> np.ndarray:
        """All columns (n, m + m') [nm]."""
        return np.column_stack([self.common, self.alone])

    def left_by_best(self, tangent: np.ndarray) -> np.ndarray:
        """Return what the best parameters leave at each node (q,): root mean square as a share of the depth [-].

        Parameters
        ----------
        tangent : ndarray, shape (n, k)
            Slopes of the depths by the parameters [nm].
        """
        basis, columns = np.linalg.qr(tangent / self.scale[:, None])[0], self.columns / self.scale[:, None]
        squares = np.mean((columns - basis @ (basis.T @ columns)) ** 2, axis=0)
        shares, own = _nodes()
        return shares * np.sqrt([self.deviations(each) ** 2 @ squares for each in own])

    def deviations(self, own: float) -> np.ndarray:
        """Return the standard deviation (m + m',) of each column's coefficient at a share of one."""
        return np.sqrt(np.repeat([1.0 - own, own], [self.common.shape[1], self.alone.shape[1]]))


def largest_depths(depths: Mapping[str, np.ndarray], shares: Mapping[str, float]) -> np.ndarray:
    """Return the largest depth so far (n,) of tests [nm], times the relative change of their responses, see `of`."""
    return np.concatenate([shares.get(n, 1.0) * np.maximum.accumulate(np.abs(h)) for n, h in depths.items()])


@lru_cache(maxsize=32)
def _correlated(protocols: tuple[Protocol, ...], sharp: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return factors (n, m) and (n, m') of the correlation of x, and of that within each test alone."""
    of_tests = [features(protocol, sharp) for protocol in protocols]
    alone = block_diag(*(correlation_factor(kernel(each)) for each in of_tests))
    return correlation_factor(kernel(np.vstack(of_tests))), alone


@lru_cache(maxsize=32)
def ripple(protocols: tuple[Protocol, ...], sharp: bool) -> np.ndarray:
    """Return the correlation (n, n) of what a mesh makes rough, by `features` that are `ROUGHER` times as short."""
    return kernel(ROUGHER * np.vstack([features(protocol, sharp) for protocol in protocols]))


def features(protocol: Protocol, sharp: bool) -> np.ndarray:
    """Return what the process depends on, (n_points, f), in units of the distances over which it forgets."""
    time = protocol.sample_time
    before = protocol.drive_at(np.outer(time, 1.0 - AGO).ravel()).reshape(len(time), -1)
    knots = np.interp(time, protocol.knot_time, np.maximum.accumulate(protocol.knot_drive))
    largest = np.maximum(np.maximum(knots, protocol.sample_drive), 1e-9 * protocol.largest_drive)
    history = np.sqrt(before / largest[:, None] / len(AGO))
    lengths = np.zeros(len(time)) if sharp else np.log(largest) / LOADS
    return np.column_stack([np.log(time) / TIMES, history / HISTORIES, lengths])


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


@dataclass(frozen=True, eq=False)
class Marginal:
    r"""Products X' C^-1 X of some columns X under every size of the discrepancy, and what each size adds to a density.

    With the factor L of the known errors, W = L^-1 columns, and the coefficients' deviations s at a given `own`,

        C^-1 = C_0^-1 - C_0^-1 F (1/share^2 + F' C_0^-1 F)^-1 F' C_0^-1,        F = columns diag(s),

    (M. A. Woodbury 1950) becomes diagonal in `share` by the eigenvectors of F' C_0^-1 F.

    Attributes
    ----------
    shares, own : ndarray, shape (q,)
        Size at each node; one node of size zero where there is no discrepancy.
    log_prior : ndarray, shape (q,)
        Logarithm of the prior weight of each node.
    products : ndarray, shape (q, c, c)
        X' C^-1 X.
    half_log_det : ndarray, shape (q,)
        Half the logarithm of the determinant of C.
    """

    shares: np.ndarray
    own: np.ndarray
    log_prior: np.ndarray
    products: np.ndarray
    half_log_det: np.ndarray

    @classmethod
    def of(cls, factor: np.ndarray, discrepancy: Discrepancy | None, columns: np.ndarray) -> Marginal:
        """Return the products of columns (n, c) where the known errors have the lower Cholesky `factor` (n, n)."""
        white = solve_triangular(factor, columns, lower=True)
        known, half = white.T @ white, float(np.log(np.diag(factor)).sum())
        if discrepancy is None:
            return cls(np.zeros(1), np.zeros(1), np.zeros(1), known[None], np.array([half]))
        basis = solve_triangular(factor, discrepancy.columns, lower=True)
        inner, outer = basis.T @ basis, basis.T @ white
        products, halves = [], []
        for own in OWN:
            deviations = discrepancy.deviations(own)
            values, vectors = np.linalg.eigh(deviations[:, None] * inner * deviations)
            along = vectors.T @ (deviations[:, None] * outer)
            grown = SHARES[:, None] ** 2 * np.maximum(values, 0.0)
            halves.append(half + 0.5 * np.log1p(grown).sum(axis=1))
            weights = SHARES[:, None] ** 2 / (1.0 + grown)
            products.append(known - np.einsum("qm,mi,mj->qij", weights, along, along, optimize=True))
        prior = log_prior(*_nodes(), discrepancy.law_error)
        return cls(*_nodes(), prior, np.concatenate(products), np.concatenate(halves))

    def with_data(self, columns: np.ndarray) -> Marginal:
        """Return the same with further data of unit variance, rows (d, c) of the same columns."""
        return replace(self, products=self.products + columns.T @ columns)

    def of_columns(self, places: Sequence[int]) -> Marginal:
        """Return the same for some of the columns."""
        return replace(self, products=self.products[:, places][:, :, places])

    def from_elsewhere(self, places: np.ndarray, moves: np.ndarray) -> Marginal:
        """Return the same with the first column where the coefficients of those at `places` have made `moves` (p,)."""
        moved = np.eye(self.products.shape[1])
        moved[places, 0] = -moves
        return replace(self, products=moved.T @ self.products @ moved)

    def log_densities(self, variance: float | np.ndarray, moves: bool = True, positive: bool = False) -> np.ndarray:
        """Return the log density (q,) of the first column at each node, the coefficients of the others integrated over.

        Constants of the number of points are left out.

        Parameters
        ----------
        variance
            Prior variance of the coefficients about zero, or of each (c - 1,).
        moves
            Whether the coefficients take their best values; else they stay at zero, and only their volume counts.
        positive
            Whether the last coefficient is positive, with half of a normal prior.
        """
        variance = np.broadcast_to(variance, self.products.shape[1] - 1)
        precision = self.products[:, 1:, 1:] + np.diag(1.0 / variance)
        pull, squares = self.products[:, 1:, 0], self.products[:, 0, 0]
        best = np.linalg.solve(precision, pull[:, :, None])[:, :, 0]
        if moves:
            squares = squares - np.einsum("qi,qi->q", pull, best)
        volume = np.linalg.slogdet(precision)[1] + np.log(variance).sum()
        found = -0.5 * (squares + volume) - self.half_log_det
        if positive:
            deviation = np.sqrt(np.linalg.inv(precision)[:, -1, -1])
            found = found + np.log(2.0) + log_ndtr(best[:, -1] / deviation)
        return found


def _nodes() -> tuple[np.ndarray, np.ndarray]:
    """Return `share` and `own` (q,) at every node of the quadrature."""
    return np.tile(SHARES, len(OWN)), np.repeat(OWN, len(SHARES))


def log_prior(shares: np.ndarray, own: np.ndarray, law_error: float) -> np.ndarray:
    """Return the logarithm of the prior weight of each node of `share` and `own` (q,)."""
    size = np.log(shares / law_error) / PRIOR_SCALE
    density = -np.abs(size) - 2.0 * np.log1p(np.exp(-np.abs(size)))
    whole = density + np.log(OWN_WEIGHTS[np.searchsorted(OWN, own - 1e-9)])
    return whole - logsumexp(whole)
