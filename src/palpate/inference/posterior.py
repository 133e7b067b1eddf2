r"""Draws from the posterior of an explanation's coordinates, by importance sampling.

The density is that of the curves to second order about the best point (`Curvature`), with the prior of
`palpate.models.coordinates`, integrated over the size of the law's discrepancy: at coordinates z with the
features f(z) of the curves,

    p(z) ~ sum over sizes q of prior_q |C_q|^(-1/2) exp(-f' (X' C_q^-1 X) f / 2 - departures(z)^2 / 2).

A law that lacks creep at short times takes it for elasticity. Fits of Burgers solids to power, logarithmic and
stretched creep leave a modulus that is too low, its logarithm by 6 to 52 times the root mean square misfit as a share
of the depth (`studies.coverage.structure`), and hardly show it, as the misfit is least there. So the draws of Young's
modulus are raised by the positive part of a normal deviate, of `AT_ONCE` times the posterior of that part of the misfit
which obeys the scaling law: the law may or may not lack such creep.

Proposals come from a mixture of Student's distributions, first one for each size, to first order; then, as long as the
weights are uneven, about draws of the round before (population Monte Carlo: O. Cappe et al., J. Comput. Graph. Stat. 13
(2004) 907-929), which follow a bent density. All rounds count, each in proportion to its effective number of draws. The
random numbers are the same ones for every fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln, logsumexp

from palpate.inference.amplitude_constraint import departures
from palpate.inference.explanation import PRIOR_VARIANCE, Fit
from palpate.inference.least_squares import central_slopes
from palpate.inference.marginal import Marginal

DRAWS = 1500
PROPOSALS = 6000  # a round
ROUNDS = 6
ENOUGH = 3000.0  # effective number of draws of all rounds, with which no further one follows
CENTRES = 60  # draws of the round before about which the next round proposes
NARROWER = 0.35  # covariance about each of them, as a share of that of all draws
AXES = 3  # along which second derivatives are taken
REACH = 2.0  # standard deviations, beyond which the curves are continued linearly
AT_ONCE = 30.0  # of ln(modulus), over the misfit's share of the depth: 97.5 % lie below 59
MODULUS = "youngs_modulus"
FREEDOM = 5.0  # degrees of freedom of Student's distribution, whose tails reach beyond a bent density
NEGLIGIBLE = 1e-5  # weight of a size, relative to the largest, below which it is left out


def posterior_draws(fit: Fit) -> np.ndarray:
    """Return draws (m, k) of the coordinates of an explanation.

    Where the law is taken to be exact and does not explain the recordings to the errors, chi-square of the curves is
    divided by its ratio to the degrees of freedom (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
    """
    target = _Density.of(fit)
    mixture, rng = target.first_order(), np.random.default_rng(0)
    rounds, masses, effective = list[np.ndarray](), list[np.ndarray](), 0.0
    for _ in range(ROUNDS):
        points = mixture.drawn(PROPOSALS, rng)
        log_weights = target.log_density(points) - mixture.log_density(points)
        weights = np.exp(log_weights - logsumexp(log_weights))
        count = 1.0 / float(np.sum(weights**2))
        rounds.append(points)
        masses.append(count * weights)
        effective += count
        if effective >= ENOUGH:
            break
        mixture = _Mixture.about(points, weights, rng)
    points, weights = np.concatenate(rounds), np.concatenate(masses) / effective
    places = np.searchsorted(np.cumsum(weights), (np.arange(DRAWS) + 0.5) / DRAWS * (1.0 - 1e-12))
    return _with_creep_at_once(fit, points[np.minimum(places, len(points) - 1)], rng)


def _with_creep_at_once(fit: Fit, draws: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) whose modulus is that without the creep which the law took for elasticity."""
    names = fit.coordinates.names
    if MODULUS not in names:
        return draws
    place = names.index(MODULUS)
    modulus, shares = fit.coordinates.free[place], fit.law_share(rng.random(len(draws)), of_law=True)
    more = AT_ONCE * shares * np.maximum(rng.standard_normal(len(draws)), 0.0)
    raised = draws.copy()
    raised[:, place] = modulus.scaled(modulus.physical(draws[:, place]) * np.exp(more))
    return raised


def draws_to_first_order(fit: Fit, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the coordinates of an explanation from linearised curves."""
    return _with_creep_at_once(fit, rng.multivariate_normal(fit.z, fit.posterior, size=DRAWS, method="svd"), rng)


@dataclass(frozen=True, eq=False)
class _Mixture:
    """Student's distributions of `FREEDOM` about centres (j, k), with scale matrices (j, k, k) and weights (j,)."""

    centres: np.ndarray
    scales: np.ndarray
    weights: np.ndarray

    @classmethod
    def about(cls, points: np.ndarray, weights: np.ndarray, rng: np.random.Generator) -> _Mixture:
        """Return a mixture about some of the weighted points (n, k)."""
        mean = weights @ points
        off = points - mean
        covariance = (weights[:, None] * off).T @ off + 1e-12 * np.eye(points.shape[1])
        chosen = rng.choice(len(points), size=CENTRES, p=weights)
        narrow = np.broadcast_to(NARROWER * covariance, (CENTRES, *covariance.shape))
        centres, scales = np.vstack([points[chosen], mean]), np.concatenate([narrow, covariance[None]])
        return cls(centres, scales, np.append(np.full(CENTRES, 0.9 / CENTRES), 0.1))

    def drawn(self, count: int, rng: np.random.Generator) -> np.ndarray:
        """Return points (count, k)."""
        of = rng.choice(len(self.weights), size=count, p=self.weights)
        roots = np.linalg.cholesky(self.scales)
        normal = rng.standard_normal((count, self.centres.shape[1]))
        stretch = np.sqrt(FREEDOM / rng.chisquare(FREEDOM, size=count))
        return self.centres[of] + stretch[:, None] * np.einsum("nij,nj->ni", roots[of], normal)

    def log_density(self, points: np.ndarray) -> np.ndarray:
        """Return the log density (n,) at points (n, k)."""
        k, found = points.shape[1], []
        for centre, scale, weight in zip(self.centres, self.scales, self.weights, strict=True):
            root = np.linalg.cholesky(scale)
            squares = np.sum(np.linalg.solve(root, (points - centre).T) ** 2, axis=0)
            height = np.log(weight) - np.log(np.diag(root)).sum()
            found.append(height - 0.5 * (FREEDOM + k) * np.log1p(squares / FREEDOM))
        constant = gammaln(0.5 * (FREEDOM + k)) - gammaln(0.5 * FREEDOM) - 0.5 * k * np.log(FREEDOM * np.pi)
        return logsumexp(found, axis=0) + constant


@dataclass(frozen=True, eq=False)
class _Density:
    """The posterior of a fit, up to a constant.

    Parameters
    ----------
    curvature
        Of the curves.
    products : ndarray, shape (q, c, c)
        X' C^-1 X of its columns at each size of the discrepancy.
    log_heights : ndarray, shape (q,)
        What each size adds to the log density.
    sizes
        The same to first order in the coordinates.
    """

    curvature: Curvature
    products: np.ndarray
    log_heights: np.ndarray
    sizes: Marginal

    @classmethod
    def of(cls, fit: Fit) -> _Density:
        curvature, ratio = Curvature.of(fit), max(fit.misfit_ratio, 1.0)
        left = -curvature.columns
        left[:, 0] += fit.problem.mean
        flat = Marginal.of(fit.modes, left)
        k = len(fit.z)
        first = fit.marginal(np.column_stack([left[:, 0], -left[:, 1 : k + 1]]))
        likely = first.log_prior + first.log_densities(PRIOR_VARIANCE)
        counts = likely > likely.max() + np.log(NEGLIGIBLE)
        kept = Marginal(*(getattr(first, name)[counts] for name in Marginal.__dataclass_fields__))
        of_bulk = curvature.bulk.T @ curvature.bulk
        return cls(
            curvature, flat.products[counts] / ratio + of_bulk, (flat.log_prior - flat.half_log_det)[counts], kept
        )

    def first_order(self) -> _Mixture:
        """Return the posterior at each size to first order, with wider tails, about places within the limits."""
        fit, products = self.curvature.fit, self.sizes.products
        precision = products[:, 1:, 1:] + np.eye(len(fit.z)) / PRIOR_VARIANCE
        scales = np.linalg.inv(precision)
        moved = fit.z + np.einsum("qij,qj->qi", scales, products[:, 1:, 0])
        centres = np.clip(moved, *fit.coordinates.limits)
        likely = self.sizes.log_prior + self.sizes.log_densities(PRIOR_VARIANCE)
        return _Mixture(centres, scales, np.exp(likely - logsumexp(likely)))

    def log_density(self, points: np.ndarray) -> np.ndarray:
        """Return the log density (n,) at coordinates (n, k)."""
        fit = self.curvature.fit
        least, largest = fit.coordinates.limits
        found = np.full(len(points), -np.inf)
        inside = np.all((points >= least) & (points <= largest), axis=1)
        if inside.any():
            features, prior = self.curvature.features(points[inside]), fit.coordinates.departures(points[inside])
            prior[:, fit.coordinates.cauchy] = 0.0
            pairs = np.einsum("ni,nj->nij", features, features).reshape(len(features), -1)
            squares = pairs @ self.products.reshape(len(self.products), -1).T
            found[inside] = logsumexp(self.log_heights - 0.5 * squares, axis=1) - 0.5 * np.sum(prior**2, axis=1)
            found[inside] += fit.coordinates.log_cauchy(points[inside])
            if fit.constraints:
                off = (departures(fit.constraints, fit.model.amplitudes(row)) for row in points[inside])
                found[inside] -= 0.5 * np.array([np.sum(each**2) for each in off])
        return found


@dataclass(frozen=True, eq=False)
class Curvature:
    """A Taylor series of the curves about a fit, to second order along the parameters that they determine least.

    Along the few least determined directions an interval is wide, and the derivatives at the best point differ from
    those at its ends. The forward model's derivatives one standard deviation to either side along each of these axes
    give the second derivatives along it, pure and mixed with every other coordinate (Box & Wilson, J. R. Stat. Soc. B
    13 (1951) 1-45, with slopes in place of further runs).

    Parameters
    ----------
    fit
    slopes : ndarray, shape (n_all, k)
        By the coordinates, at the fit [nm].
    axes : ndarray, shape (k, m)
        Steps of one standard deviation along the axes.
    bends : ndarray, shape (m, n_all, k)
        By how much the slopes change over one such step [nm].
    bulk : ndarray, shape (b, c)
        What the departures of uniaxial tests are made of, in the proportions of `features` [standard deviations].
    """

    fit: Fit
    slopes: np.ndarray
    axes: np.ndarray
    bends: np.ndarray
    bulk: np.ndarray

    @classmethod
    def of(cls, fit: Fit) -> Curvature:
        """Simulate the slopes around a fit, one-sided where an end lies beyond a limit or the model fails."""
        variances, directions = np.linalg.eigh(fit.posterior)
        axes = (directions * np.sqrt(variances))[:, -AXES:]
        least, largest = fit.coordinates.limits
        ends = [fit.z + side * step for step in axes.T for side in (1.0, -1.0)]
        within = [bool(np.all((end >= least) & (end <= largest))) for end in ends]
        outcomes = fit.model.tangents([fit.z, *(end for end, inside in zip(ends, within, strict=True) if inside)])
        found = [None if isinstance(each, str) else fit.problem.stacked(each[1]) for each in outcomes]
        here, simulated = fit.tangent if found[0] is None else found[0], iter(found[1:])
        there = [next(simulated) if inside else None for inside in within]
        return cls(fit, here, axes, _bends(here, there), _bulk_columns(fit, ends, within))

    @property
    def columns(self) -> np.ndarray:
        """What the curves are made of (n_all, c), in the proportions of `features` [nm]."""
        return np.column_stack([self.fit.curve, self.slopes, *self.bends])

    def features(self, z: np.ndarray) -> np.ndarray:
        """Return the proportions (p, c) of `columns` at coordinates z (p, k)."""
        off = z - self.fit.z
        along = np.linalg.lstsq(self.axes, off.T, rcond=None)[0].T
        within = np.clip(along, -REACH, REACH)
        beside = off - 0.5 * within @ self.axes.T
        bent = [within[:, number, None] * beside for number in range(len(self.bends))]
        return np.column_stack([np.ones(len(z)), off, *bent])


def _bends(here: np.ndarray, there: Sequence[np.ndarray | None]) -> np.ndarray:
    """Return by how much slopes (n, k) change over a step along each axis (m, n, k), from those `here` and at the ends.

    The ends lie ahead and behind on one axis after the other; None where there are no slopes.
    """
    bends = []
    for ahead, behind in zip(there[::2], there[1::2], strict=True):
        changes = [ahead - here] if ahead is not None else []
        changes += [here - behind] if behind is not None else []
        bends.append(np.mean(changes, axis=0) if changes else np.zeros_like(here))
    return np.array(bends)


def _bulk_columns(fit: Fit, ends: Sequence[np.ndarray], within: Sequence[bool]) -> np.ndarray:
    """Return the departures of uniaxial tests at a fit, their slopes, and the bends of these (b, c)."""

    def slopes(z: np.ndarray) -> np.ndarray:
        return central_slopes(lambda u: fit.problem.bulk_departures(fit.explanation, u), z)

    here = slopes(fit.z)
    if not len(here):
        return np.empty((0, 1 + (1 + len(ends) // 2) * len(fit.z)))
    there = [slopes(end) if inside else None for end, inside in zip(ends, within, strict=True)]
    return np.column_stack([fit.problem.bulk_departures(fit.explanation, fit.z), here, *_bends(here, there)])
