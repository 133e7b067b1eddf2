"""Noise of the recordings by restricted maximum likelihood, from what distinguishes replicates.

Orthonormal contrasts of the replicates have the covariance of the noise (`noise`) and do not know the curve, so they
determine the noise under any model (Patterson & Thompson, Biometrika 58 (1971) 545-554). With few replicates
the estimate of a variance is often zero although the variance is not; a prior proportional to the standard deviation
keeps site scatter and random walk off that boundary, by a standard error at most (Chung et al., Psychometrika 78 (2013)
685-709). A single contrast, of two recordings in all, gives one number about the sites: that prior would then raise
their scatter without end, so the assumed scatter counts as one more contrast instead.

Without replicates, what remains of the residual after a cubic in each segment takes their place, and the variances of
the components are assumed. The correlation of the point noise is then limited to about ten points: a slower misfit must
not count as noise, or a missing effect would pass for noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, helmert
from scipy.optimize import minimize
from scipy.special import expit, logit

from palpate.inference.noise import NoiseModel, largest_autocorrelation, point_noise, slope_by_rho

SMALLEST_SIGMA = 1e-5
SMALLEST_VARIANCE = 1e-12
MARGIN = 30.0
AT_BOUND = 1e-4
LEAST_LEFT = 0.25  # of the points, beside slow trends
OFF_BOUNDARY = ("site", "random_walk")
AUTOCORRELATIONS = (0.5, 0.95)  # where the search begins


@dataclass(frozen=True, eq=False)
class Replicates:
    """Deviations of one condition's recordings from their mean.

    Parameters
    ----------
    contrasts : ndarray, shape (k, d)
        Independent vectors with covariance ``basis @ K @ basis.T`` [nm].
    basis : ndarray, shape (d, n)
        The identity, or what projects smooth trends out.
    components : mapping of ndarray, shape (n, n)
        Matrix M of each variance component.
    scale
        Largest depth [nm].
    """

    contrasts: np.ndarray
    basis: np.ndarray
    components: Mapping[str, np.ndarray]
    scale: float

    @cached_property
    def parts(self) -> dict[str, np.ndarray]:
        """Matrix (d, d) of each variance component in the basis."""
        return {name: self.in_basis(component) for name, component in self.components.items()}

    def in_basis(self, matrix: np.ndarray) -> np.ndarray:
        """Return a covariance (n, n) in the basis (d, d), which is the identity where it has n rows."""
        return self.basis @ matrix @ self.basis.T if len(self.basis) < len(matrix) else matrix

    def with_parts(self, points: np.ndarray, variances: Mapping[str, float]) -> np.ndarray:
        """Return the covariance (d, d) in the basis: of the point noise and of the variance components."""
        return points + sum(variances[name] * part for name, part in self.parts.items())

    def points(self, sigma: float, autocorrelation: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the point noise's covariance (d, d) in the basis, and its derivative by logit rho."""
        size = self.basis.shape[1]
        return self.in_basis(point_noise(sigma, autocorrelation, size)), self.in_basis(
            slope_by_rho(sigma, autocorrelation, size)
        )


def contrasts(depth: np.ndarray) -> np.ndarray:
    """Return orthonormal contrasts (R - 1, n) of replicates (R, n)."""
    return helmert(len(depth)) @ depth


def without_trend(segments: Sequence[np.ndarray], degree: int = 3) -> np.ndarray:
    """Return an orthonormal basis (d, n) of what is left when each segment (bool, n) loses a polynomial.

    Where that would leave less than `LEAST_LEFT` of the points, or than two, the degree is lower, or nothing is lost.
    """
    count = len(segments[0])
    while degree >= 0:
        trends = _trends(segments, degree)
        if count - len(trends) >= max(LEAST_LEFT * count, 2):
            return np.linalg.qr(np.column_stack(trends), mode="complete")[0][:, len(trends) :].T
        degree -= 1
    return np.eye(count)


def _trends(segments: Sequence[np.ndarray], degree: int) -> list[np.ndarray]:
    """Return the powers (n,) of each segment (bool, n) up to a degree."""
    trends = []
    for segment in segments:
        x = np.linspace(-1, 1, int(segment.sum()))
        for power in range(min(degree, len(x) - 1) + 1):
            column = np.zeros(len(segment))
            column[segment] = x**power
            trends.append(column)
    return trends


def fit_noise(
    replicates: Sequence[Replicates],
    assumed: Mapping[str, float],
    replicated: bool,
    largest: Mapping[str, float],
    within: Sequence[NoiseModel] = (),
) -> NoiseModel:
    """Fit by maximum likelihood.

    The likelihood has several maxima, as a long autocorrelation, a random walk and a mechanism resemble each other. The
    search starts from short and from long autocorrelation, and from each model that this one contains, so that more
    components never fit worse.

    Parameters
    ----------
    replicates
        Deviations of each condition.
    replicated
        Whether they are deviations between replicates; else residuals without trends.
    assumed
        Variance of each component: the value itself without replicates, else where the search begins.
    largest
        Upper bounds of some of the variances.
    within
        Models of the same recordings with fewer components.
    """
    names = list(replicates[0].components)
    count = len(replicates)
    floors = np.log([SMALLEST_SIGMA * r.scale for r in replicates])
    lowest = np.concatenate([floors, np.full(count, -4.0)])
    longest = logit(np.array(largest_autocorrelation(replicated)))
    highest = np.concatenate([np.log([r.scale for r in replicates]), np.full(count, longest)])
    first = np.empty(0)
    if replicated:
        bounds = np.log([largest[name] if name in largest else _greatest(name, replicates) for name in names])
        first = np.minimum(np.log([max(assumed[name], SMALLEST_VARIANCE) for name in names]), bounds)
        lowest, highest = np.append(lowest, first - MARGIN), np.append(highest, bounds)

    def unpack(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, dict[str, float]]:
        values = np.exp(x[2 * count :]) if replicated else [assumed[name] for name in names]
        return np.exp(x[:count]), expit(x[count : 2 * count]), dict(zip(names, map(float, values), strict=True))

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        sigma, autocorrelation, variances = unpack(x)
        value, slope = 0.0, np.zeros(len(x))
        for k, r in enumerate(replicates):
            points, by_autocorrelation = r.points(sigma[k], autocorrelation[k])
            factor = cho_factor(r.with_parts(points, variances), lower=True)
            inverse = cho_solve(factor, np.eye(len(factor[0])))
            solved = inverse @ r.contrasts.T
            rank = len(r.contrasts)
            value += rank * np.log(np.diag(factor[0])).sum() + 0.5 * np.sum(solved * r.contrasts.T)
            weight = 0.5 * (rank * inverse - solved @ solved.T)
            slope[k] += np.vdot(weight, 2 * points)
            slope[count + k] += np.vdot(weight, by_autocorrelation)
            if replicated:
                for j, name in enumerate(names):
                    slope[2 * count + j] += variances[name] * np.vdot(weight, r.parts[name])
        beforehand, pull = prior(x)
        return value + beforehand, slope + pull

    def prior(x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return the logarithm of the prior, less its constant and with its sign changed, and its slope."""
        slope = np.zeros(len(x))
        slope[off_boundary] = -0.5
        value = float(slope @ x)
        for j in single_contrast:
            share = 0.5 * assumed["site"] * np.exp(-x[j])
            value, slope[j] = value + 0.5 * x[j] + share, 0.5 - share
        return value, slope

    def start(autocorrelation: float) -> np.ndarray:
        steps = np.array([np.std(np.diff(r.contrasts)) for r in replicates])
        sigma = np.log(np.maximum(steps / np.sqrt(2.0 * (1.0 - autocorrelation)), np.exp(floors)))
        return np.concatenate([sigma, np.full(count, logit(np.array(autocorrelation))), first])

    def start_within(model: NoiseModel) -> np.ndarray:
        values = {**assumed, **model.variances}
        known = [np.log(max(values[name], SMALLEST_VARIANCE)) for name in names]
        return np.concatenate([np.log(model.sigma), logit(model.autocorrelation), known])

    off_boundary = [2 * count + names.index(name) for name in OFF_BOUNDARY if replicated and name in names]
    single = sum(len(r.contrasts) for r in replicates) == 1
    single_contrast = [j for j in off_boundary if single and names[j - 2 * count] == "site"]
    off_boundary = [j for j in off_boundary if j not in single_contrast]
    starts = [start(AUTOCORRELATIONS[0]), *(start_within(model) for model in within)]
    starts += [] if within else [start(autocorrelation) for autocorrelation in AUTOCORRELATIONS[1:]]
    within_bounds = list(zip(lowest, highest, strict=True))
    searches = [
        minimize(objective, np.clip(x, lowest, highest), jac=True, method="L-BFGS-B", bounds=within_bounds)
        for x in starts
    ]
    found = min(searches, key=lambda search: search.fun)
    sigma, autocorrelation, variances = unpack(found.x)
    covariance = _fisher(replicates, sigma, autocorrelation, variances, replicated)
    log_likelihood = prior(found.x)[0] - float(found.fun)
    return NoiseModel(sigma, autocorrelation, variances, log_likelihood, covariance, replicated)


def _fisher(replicates, sigma, autocorrelation, variances, replicated) -> np.ndarray:
    """Return the inverse of Fisher's information of (log sigma, logit rho, v); a rho at its bound is known."""
    count, names = len(replicates), list(variances)
    information = np.zeros((2 * count + len(names),) * 2)
    for k, r in enumerate(replicates):
        points, by_autocorrelation = r.points(sigma[k], autocorrelation[k])
        inverse = np.linalg.inv(r.with_parts(points, variances))
        solved = [inverse @ part for part in (2 * points, by_autocorrelation, *r.parts.values())]
        places = [k, count + k, *range(2 * count, 2 * count + len(names))]
        for a, i in enumerate(places):
            for b, j in enumerate(places):
                information[i, j] += 0.5 * len(r.contrasts) * np.sum(solved[a] * solved[b].T)
    if not replicated:
        information[2 * count :] = information[:, 2 * count :] = 0.0
        information[range(2 * count, len(information)), range(2 * count, len(information))] = [
            1.0 / (0.5 * max(v, SMALLEST_VARIANCE)) ** 2 for v in variances.values()
        ]
    for place in count + np.flatnonzero(autocorrelation > largest_autocorrelation(replicated) - AT_BOUND):
        information[place] = information[:, place] = 0.0
        information[place, place] = AT_BOUND**-2
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
    return 0.5 * (inverse + inverse.T)


def _greatest(name: str, replicates: Sequence[Replicates]) -> float:
    """Return the variance with which a component would add as much as the recordings are deep."""
    return max(r.scale**2 / max(float(np.diag(r.components[name]).max()), SMALLEST_VARIANCE) for r in replicates)
