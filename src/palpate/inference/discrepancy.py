r"""The discrepancy of a law: what the best material of a law that is not quite right leaves, smooth along the tests.

No material obeys a law to the noise of averaged recordings. Under test a the mean depth is

    d_a = h_a(theta) + effects + delta_a + errors of the mesh + noise,        delta = h_m x,

with h_m the largest depth so far, by which a recovered depth is measured, too. x is a Gaussian process of standard
deviation `share` (M. C. Kennedy and A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425-464). Its structure is that of the
physics. A sharp tip on a homogeneous body has no length, so depth / sqrt(load) is a functional of the history up to
now alone, whatever the law: of the present time t, since the law may know times of its own, and of the normalised
history p(s) = P(t (1 - s)) / max P. So is x, and a functional that is smooth has close values at close histories:

    corr(x, x') = exp(-(ln t - ln t')^2 / (2 a^2) - mean (p(s) - p'(s))^2 / (2 b^2)).

Two tests of one normalised history and equal times share x wholly, at every load; while both are loaded evenly they
share it at equal times even if their rates differ; a corner of the history changes p, and so ends the memory. What has
a length of its own, a sphere or a film, loses that memory with the logarithm of the ratio of loads. As tips, contacts
and meshes breach the scaling a little, each test keeps a part of its own, `own` of the variance: with a correlation of
exactly one each breach by a thousandth would be named. Replicates share x wholly.

What laws leave most often is creep at other times than theirs. Its spectrum of retardation times g(ln tau), of either
sign, adds to the compliance M of the contact, and to first order to the depth

    delta h = h_m x_m = (h_m^2 / (n h)) int g(ln tau) phi_tau d ln tau,    phi_tau = int (1 - exp(-(t - t') / tau)) dp,

with h^n = int M dP, n = 2 under a sharp tip, p the load over the largest so far, and g of the standard deviation
`creep` times `share`, independent at each time, from a tenth of the shortest interval between samples on. Such creep
does not fade towards early times as a stationary process does: what is faster than the first samples looks elastic.
Without this part the modulus of elasticity of a body that creeps faster than its law came out too low, in two of three
sets of recordings by more than its interval (studies/coverage).

None of these numbers is known. `GRID` integrates over all, with a prior that is the same for all explanations compared.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from itertools import product

import numpy as np
from scipy.linalg import block_diag, lapack, solve_triangular
from scipy.special import logsumexp

from palpate.study.protocol import LOAD, Protocol

LAW_ERROR = 0.0025  # share of the depth, median of the prior; see docs/inference.md for the wrong laws that it rests on
TIMES = 0.8  # a, of the logarithm of time: fits of linear solids to power, logarithmic and stretched creep leave this
HISTORIES = 0.25  # b, of the normalised load: the same
LOADS = 0.7  # of the logarithm of the load, where body or tip has a length: a factor of two
AGO = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 24)])  # s, of the present time: the recent past counts most
FASTEST = 0.1  # of the shortest interval between samples, from which on creep counts as such
SLOWEST = 3.0  # longest tests, beyond which it is steady
A_FOLD = 3  # retardation times for each factor of e
SHALLOW = 0.05  # of the largest depth, below which x is no longer linear in the compliance
DROPPED = 1e-4  # of the variance of x, below which columns are left out
PRIOR_SCALE = 0.68  # of the logistic density of ln(share): 95 % lie within a factor of twelve of the median
SHARES = np.geomspace(5e-5, 0.1, 39)  # nodes of the quadrature over `share`
OWN = np.array([0.01, 0.03, 0.1, 0.3, 0.9])  # nodes of the quadrature over `own`
OWN_WEIGHTS = np.array([0.2, 0.25, 0.25, 0.2, 0.1])  # their prior, chosen: even in ln(own) but for the last
CREEP = np.array([0.0, 8.0, 60.0])  # nodes of the quadrature over `creep`, even beforehand


@dataclass(frozen=True)
class Size:
    """How large the discrepancy is.

    Parameters
    ----------
    share
        Standard deviation as a share of the depth, without that of creep [-].
    own
        Share of the variance that each test has of its own.
    creep
        Standard deviation of the change of depth by creep at the times of a factor of e, over `share`.
    """

    share: float = 0.0
    own: float = OWN[0]
    creep: float = CREEP[0]

    def deviations(self, parts: Sequence[np.ndarray]) -> np.ndarray:
        """Return the standard deviation (m,) of each coefficient of columns that histories, tests, and creep have."""
        of_parts = np.sqrt([1.0 - self.own, self.own, self.creep**2])
        return self.share * np.repeat(of_parts, [part.shape[1] for part in parts])


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """The covariance of a law's discrepancy under some tests, one after the other.

    Parameters
    ----------
    parts : list of ndarray, shape (n, m_i)
        Columns of what histories determine, of what each test has of its own, and of creep, per unit of `share` [nm].
    scale : ndarray, shape (n,)
        Largest depth so far [nm].
    law_error
        Median of the prior of `share` [-].
    size
        Of which it is.
    """

    parts: Sequence[np.ndarray]
    scale: np.ndarray
    law_error: float
    size: Size = Size()

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
            `palpate.study.quantity`; one where not given.
        """
        known = tuple(protocols)
        curves = [shares.get(name, 1.0) * np.abs(curve) for name, curve in depths.items()]
        scale = np.concatenate([np.maximum.accumulate(curve) for curve in curves])
        parts = [scale[:, None] * part for part in _correlated(known, sharp)]
        weights = _per_compliance(known, 2.0 if sharp else 1.5, curves)
        return cls([*parts, weights[:, None] * _of_creep(known, sharp)], scale, law_error)

    def sized(self, size: Size) -> Discrepancy:
        """Return the same with another size."""
        return replace(self, size=size)

    @cached_property
    def covariance(self) -> np.ndarray:
        """Covariance (n, n) [nm^2]."""
        columns = self.columns * self.size.deviations(self.parts)
        return columns @ columns.T

    @property
    def log_prior(self) -> float:
        """Logarithm of the prior weight of its size, which is that of a node of the quadrature."""
        return float(log_prior(self.law_error)[sizes().index(self.size)])

    @property
    def columns(self) -> np.ndarray:
        """All columns (n, m) [nm]."""
        return np.column_stack(self.parts)

    def left_by_best(self, tangent: np.ndarray) -> np.ndarray:
        """Return the root mean square (q,) that the best parameters leave of each size, as a share of the depth [-].

        Parameters
        ----------
        tangent : ndarray, shape (n, k)
            Slopes of the depths by the parameters [nm].
        """
        basis, columns = np.linalg.qr(tangent / self.scale[:, None])[0], self.columns / self.scale[:, None]
        squares = np.mean((columns - basis @ (basis.T @ columns)) ** 2, axis=0)
        return np.array([np.sqrt(size.deviations(self.parts) ** 2 @ squares) for size in sizes()])


@lru_cache(maxsize=32)
def _correlated(protocols: tuple[Protocol, ...], sharp: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return factors (n, m) and (n, m') of the correlation of x, and of that within each test alone."""
    features = [_features(protocol, sharp) for protocol in protocols]
    every = np.vstack(features)
    return _factor(_kernel(every)), block_diag(*(_factor(_kernel(each)) for each in features))


@lru_cache(maxsize=32)
def _of_creep(protocols: tuple[Protocol, ...], sharp: bool) -> np.ndarray:
    """Return columns (n, m): phi_tau of the module, at times evenly by their logarithm."""
    shortest = min(float(np.diff(protocol.sample_time, prepend=0.0).min()) for protocol in protocols)
    fastest, slowest = FASTEST * shortest, SLOWEST * max(protocol.sample_time[-1] for protocol in protocols)
    fold = np.log(slowest / fastest)
    times = np.geomspace(fastest, slowest, round(A_FOLD * fold) + 1)
    parts = []
    for protocol in protocols:
        rates, found = np.diff(protocol.knot_drive) / np.diff(protocol.knot_time), 0.0
        for rate, begin, end in zip(rates, protocol.knot_time[:-1], protocol.knot_time[1:], strict=True):
            since, until = (np.maximum(protocol.sample_time - each, 0.0)[:, None] for each in (begin, end))
            found = found + rate * (since - until + times * (np.expm1(-since / times) - np.expm1(-until / times)))
        parts.append(found / _largest(protocol)[:, None])
    columns = np.sqrt(fold / (len(times) - 1)) * np.vstack(parts)
    if sharp:
        return columns
    loads = np.concatenate([np.log(_largest(protocol)) / LOADS for protocol in protocols])
    return _factor(columns @ columns.T * _kernel(loads[:, None]), DROPPED / CREEP[-1] ** 2)


def _per_compliance(protocols: Sequence[Protocol], growth: float, curves: Sequence[np.ndarray]) -> np.ndarray:
    """Return by how much depths (n,) change [nm] where the compliance grows by a part of its first value, the load one.

    Where h^n = M P with the power `growth`, it is h_m^n / (n h^(n - 1)) over M, in units of that under the first loads.
    Under displacement control a response changes by as much of itself.
    """
    found = []
    for protocol, curve in zip(protocols, curves, strict=True):
        largest = np.maximum.accumulate(curve)
        if protocol.control != LOAD:
            found.append(largest)
            continue
        compliance = largest**growth / _largest(protocol)
        raised = largest**growth / np.maximum(curve, SHALLOW * largest) ** (growth - 1.0)
        found.append(raised / growth * compliance.min() / compliance)
    return np.concatenate(found)


def _largest(protocol: Protocol) -> np.ndarray:
    """Return the largest drive (n_points,) so far."""
    knots = np.interp(protocol.sample_time, protocol.knot_time, np.maximum.accumulate(protocol.knot_drive))
    return np.maximum(np.maximum(knots, protocol.sample_drive), 1e-9 * protocol.largest_drive)


def _features(protocol: Protocol, sharp: bool) -> np.ndarray:
    """Return what the process depends on, (n_points, f), in units of the distances over which it forgets."""
    time = protocol.sample_time
    before = protocol.drive_at(np.outer(time, 1.0 - AGO).ravel()).reshape(len(time), -1)
    largest = _largest(protocol)
    history = before / largest[:, None] / np.sqrt(len(AGO))
    lengths = np.zeros(len(time)) if sharp else np.log(largest) / LOADS
    return np.column_stack([np.log(time) / TIMES, history / HISTORIES, lengths])


def _kernel(features: np.ndarray) -> np.ndarray:
    """Return the correlation (n, n) between points with these features (n, f)."""
    squares = np.sum(features**2, axis=1)
    distance = squares[:, None] + squares[None] - 2.0 * features @ features.T
    return np.exp(-0.5 * np.maximum(distance, 0.0))


def _factor(covariance: np.ndarray, dropped: float = DROPPED) -> np.ndarray:
    """Return columns (n, m) whose products are a covariance (n, n) to within `dropped`: Cholesky's with pivots."""
    found, pivots, rank, _ = lapack.dpstrf(covariance, lower=1, tol=dropped)
    rows = np.empty_like(pivots)
    rows[pivots - 1] = np.arange(len(pivots))
    return np.tril(found)[rows, :rank]


@dataclass(frozen=True, eq=False)
class Marginal:
    r"""Products X' C^-1 X of some columns X under every size of the discrepancy, and what each size adds to a density.

    With the factor L of the known errors, W = L^-1 columns, and the coefficients' deviations s at a `share` of one,

        C^-1 = C_0^-1 - C_0^-1 F (1/share^2 + F' C_0^-1 F)^-1 F' C_0^-1,        F = columns diag(s),

    (M. A. Woodbury 1950) becomes diagonal in `share` by the eigenvectors of F' C_0^-1 F.

    Attributes
    ----------
    sizes
        Size at each node; one node of size zero where there is no discrepancy.
    log_prior : ndarray, shape (q,)
        Logarithm of the prior weight of each node.
    products : ndarray, shape (q, c, c)
        X' C^-1 X.
    half_log_det : ndarray, shape (q,)
        Half the logarithm of the determinant of C.
    """

    sizes: Sequence[Size]
    log_prior: np.ndarray
    products: np.ndarray
    half_log_det: np.ndarray

    @classmethod
    def of(cls, factor: np.ndarray, discrepancy: Discrepancy | None, columns: np.ndarray) -> Marginal:
        """Return the products of columns (n, c) where the known errors have the lower Cholesky `factor` (n, n)."""
        white = solve_triangular(factor, columns, lower=True)
        known, half = white.T @ white, float(np.log(np.diag(factor)).sum())
        if discrepancy is None:
            return cls([Size()], np.zeros(1), known[None], np.array([half]))
        basis = solve_triangular(factor, discrepancy.columns, lower=True)
        inner, outer = basis.T @ basis, basis.T @ white
        products, halves = [], []
        for own, creep in product(OWN, CREEP):
            deviations = Size(1.0, own, creep).deviations(discrepancy.parts)
            values, vectors = np.linalg.eigh(deviations[:, None] * inner * deviations)
            along = vectors.T @ (deviations[:, None] * outer)
            grown = SHARES[:, None] ** 2 * np.maximum(values, 0.0)
            halves.append(half + 0.5 * np.log1p(grown).sum(axis=1))
            weights = SHARES[:, None] ** 2 / (1.0 + grown)
            products.append(known - np.einsum("qm,mi,mj->qij", weights, along, along, optimize=True))
        return cls(sizes(), log_prior(discrepancy.law_error), np.concatenate(products), np.concatenate(halves))

    def restricted(self, nodes: np.ndarray) -> Marginal:
        """Return the same at some of the nodes (q,), where `nodes` is true."""
        kept = [size for size, is_kept in zip(self.sizes, nodes, strict=True) if is_kept]
        return Marginal(kept, self.log_prior[nodes], self.products[nodes], self.half_log_det[nodes])

    def with_data(self, columns: np.ndarray) -> Marginal:
        """Return the same with further data of unit variance, rows (d, c) of the same columns."""
        return replace(self, products=self.products + columns.T @ columns)

    def log_densities(self, variance: float, moves: bool = True) -> np.ndarray:
        """Return the log density (q,) of the first column at each node, the coefficients of the others integrated over.

        Constants of the number of points are left out.

        Parameters
        ----------
        variance
            Prior variance of each coefficient about zero.
        moves
            Whether the coefficients take their best values; else they stay at zero, and only their volume counts.
        """
        precision = self.products[:, 1:, 1:] + np.eye(self.products.shape[1] - 1) / variance
        pull, squares = self.products[:, 1:, 0], self.products[:, 0, 0]
        if moves:
            squares = squares - np.einsum("qi,qi->q", pull, np.linalg.solve(precision, pull[:, :, None])[:, :, 0])
        return -0.5 * (squares + np.linalg.slogdet(precision * variance)[1]) - self.half_log_det


@cache
def sizes() -> list[Size]:
    """Return the nodes (q,) of the quadrature."""
    return [Size(float(share), float(own), float(creep)) for own, creep, share in product(OWN, CREEP, SHARES)]


@cache
def log_prior(law_error: float) -> np.ndarray:
    """Return the logarithm of the prior weight of each node (q,)."""
    scaled = np.abs(np.log([size.share / law_error for size in sizes()])) / PRIOR_SCALE
    of_own = np.repeat(np.log(OWN_WEIGHTS), len(CREEP) * len(SHARES))
    whole = of_own - scaled - 2.0 * np.log1p(np.exp(-scaled))
    return whole - logsumexp(whole)
