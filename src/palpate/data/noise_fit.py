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
from scipy.linalg.lapack import dpotrf, dpotri
from scipy.optimize import minimize
from scipy.special import expit, logit

from palpate.data.contrasts import Replicates
from palpate.data.noise import NoiseModel, largest_autocorrelation

SMALLEST_SIGMA = 1e-5  # of the largest depth
SMALLEST_VARIANCE = 1e-12
CONVERGED = 1e-4  # change of the log likelihood, which then is within 0.01 of its maximum in nine of ten searches
MARGIN = 30.0  # of the logarithm of a variance below where a search begins: none
AT_BOUND = 1e-4  # within which rho lies at its bound, and to which logit rho is then known
OFF_BOUNDARY = ("site", "random_walk")  # variances with a prior that keeps them off zero
AUTOCORRELATIONS = (0.5, 0.95)  # where the search begins


@dataclass(frozen=True, eq=False)
class PenalisedLikelihood:
    """The restricted likelihood of all contrasts, times the prior that keeps variances off zero.

    The unknowns x are log sigma and logit rho of each condition and, with replicates, the logarithms of the variances;
    without replicates these are the assumed ones.

    Parameters
    ----------
    replicates, replicated, assumed, largest
        See `fit_noise`.
    """

    replicates: Sequence[Replicates]
    replicated: bool
    assumed: Mapping[str, float]
    largest: Mapping[str, float]

    @cached_property
    def names(self) -> list[str]:
        """Names of the variances, in their order."""
        return list(self.replicates[0].components)

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and largest values of x."""
        count, longest = len(self.replicates), logit(np.array(largest_autocorrelation(self.replicated)))
        scales = np.log([r.scale for r in self.replicates])
        lowest = np.concatenate([self.least_log_sigma, np.full(count, -4.0)])
        highest = np.concatenate([scales, np.full(count, longest)])
        if self.replicated:
            lowest = np.append(lowest, self.first_log_variances - MARGIN)
            highest = np.append(highest, self.largest_log_variances)
        return lowest, highest

    @cached_property
    def least_log_sigma(self) -> np.ndarray:
        """Least log sigma of each condition."""
        return np.log([SMALLEST_SIGMA * r.scale for r in self.replicates])

    @cached_property
    def largest_log_variances(self) -> np.ndarray:
        """Largest logarithm of each variance."""
        return np.log([self.largest[name] if name in self.largest else self._greatest(name) for name in self.names])

    @cached_property
    def first_log_variances(self) -> np.ndarray:
        """Logarithms of the variances from which a search begins."""
        assumed = np.log([max(self.assumed[name], SMALLEST_VARIANCE) for name in self.names])
        return np.minimum(assumed, self.largest_log_variances)

    @cached_property
    def penalised(self) -> tuple[list[int], list[int]]:
        """Places in x of variances with a prior off the boundary, and of one that a single contrast determines."""
        if not self.replicated:
            return [], []
        places = {
            name: 2 * len(self.replicates) + self.names.index(name) for name in OFF_BOUNDARY if name in self.names
        }
        single = sum(len(r.contrasts) for r in self.replicates) == 1
        alone = [places.pop("site")] if single and "site" in places else []
        return list(places.values()), alone

    def unpack(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, dict[str, float]]:
        """Return sigma and rho of each condition, and the variances by name."""
        count = len(self.replicates)
        values = np.exp(x[2 * count :]) if self.replicated else [self.assumed[name] for name in self.names]
        variances = dict(zip(self.names, map(float, values), strict=True))
        return np.exp(x[:count]), expit(x[count : 2 * count]), variances

    def start(self, autocorrelation: float) -> np.ndarray:
        """Return x for the same autocorrelation everywhere, and for the sigma that the scatter of the points gives."""
        steps = np.array([np.std(np.diff(r.contrasts)) for r in self.replicates])
        sigma = np.maximum(steps / np.sqrt(2.0 * (1.0 - autocorrelation)), np.exp(self.least_log_sigma))
        rho = np.full(len(self.replicates), logit(np.array(autocorrelation)))
        return np.concatenate([np.log(sigma), rho, self.first_log_variances if self.replicated else []])

    def start_within(self, model: NoiseModel) -> np.ndarray:
        """Return x of a model with fewer components."""
        values = {**self.assumed, **model.variances}
        known = [np.log(max(values[name], SMALLEST_VARIANCE)) for name in self.names]
        return np.concatenate([np.log(model.sigma), logit(model.autocorrelation), known])

    def prior(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return the logarithm of the prior, less its constant and with its sign changed, and its slope."""
        off_boundary, alone = self.penalised
        slope = np.zeros(len(x))
        slope[off_boundary] = -0.5
        value = float(slope @ x)
        for j in alone:
            share = 0.5 * self.assumed["site"] * np.exp(-x[j])
            value, slope[j] = value + 0.5 * x[j] + share, 0.5 - share
        return value, slope

    def objective(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return the logarithm of likelihood and prior, with its sign changed, and its slope.

        Where a component is so much larger than the point noise that the covariance cannot be factorised, the value is
        infinite, so that a search takes a shorter step.
        """
        count, (sigma, autocorrelation, variances) = len(self.replicates), self.unpack(x)
        value, slope = 0.0, np.zeros(len(x))
        for k, r in enumerate(self.replicates):
            points, by_autocorrelation = r.points(sigma[k], autocorrelation[k])
            try:
                half_log, inverse = _inverted(r.with_parts(points, variances))
            except np.linalg.LinAlgError:
                return np.inf, slope
            solved = inverse @ r.contrasts.T
            rank = len(r.contrasts)
            value += rank * half_log + 0.5 * np.vdot(solved, r.contrasts.T)
            weight = 0.5 * (rank * inverse - solved @ solved.T)
            slope[k] += 2 * np.vdot(weight, points)
            slope[count + k] += np.vdot(weight, by_autocorrelation)
            if self.replicated:
                for j, name in enumerate(self.names):
                    slope[2 * count + j] += variances[name] * np.vdot(weight, r.parts[name])
        beforehand, pull = self.prior(x)
        return value + beforehand, slope + pull

    def maximum(self, starts: Sequence[np.ndarray]) -> NoiseModel:
        """Return the model of the best of the searches that begin at these points."""
        lowest, highest = self.bounds
        within = list(zip(lowest, highest, strict=True))
        searches = [
            minimize(
                self.objective,
                np.clip(x, lowest, highest),
                jac=True,
                method="SLSQP",
                bounds=within,
                options={"ftol": CONVERGED},
            )
            for x in starts
        ]
        found = min(searches, key=lambda search: search.fun)
        sigma, autocorrelation, variances = self.unpack(found.x)
        covariance = self.covariance(sigma, autocorrelation, variances)
        log_likelihood = self.prior(found.x)[0] - float(found.fun)
        return NoiseModel(sigma, autocorrelation, variances, log_likelihood, covariance, self.replicated)

    def covariance(self, sigma: np.ndarray, autocorrelation: np.ndarray, variances: Mapping[str, float]) -> np.ndarray:
        """Return the inverse of Fisher's information of (log sigma, logit rho, v); a rho at its bound is known."""
        count, names = len(self.replicates), list(variances)
        information = np.zeros((2 * count + len(names),) * 2)
        for k, r in enumerate(self.replicates):
            points, by_autocorrelation = r.points(sigma[k], autocorrelation[k])
            inverse = np.linalg.inv(r.with_parts(points, variances))
            solved = [inverse @ part for part in (2 * points, by_autocorrelation, *r.parts.values())]
            places = [k, count + k, *range(2 * count, 2 * count + len(names))]
            for a, i in enumerate(places):
                for b, j in enumerate(places):
                    information[i, j] += 0.5 * len(r.contrasts) * np.sum(solved[a] * solved[b].T)
        if not self.replicated:
            information[2 * count :] = information[:, 2 * count :] = 0.0
            information[range(2 * count, len(information)), range(2 * count, len(information))] = [
                1.0 / (0.5 * max(v, SMALLEST_VARIANCE)) ** 2 for v in variances.values()
            ]
        for place in count + np.flatnonzero(autocorrelation > largest_autocorrelation(self.replicated) - AT_BOUND):
            information[place] = information[:, place] = 0.0
            information[place, place] = AT_BOUND**-2
        scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
        scaled = information / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
        inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
        return 0.5 * (inverse + inverse.T)

    def _greatest(self, name: str) -> float:
        """Return the variance with which a component would add as much as the recordings are deep."""
        return max(
            r.scale**2 / max(float(np.diag(r.components[name]).max()), SMALLEST_VARIANCE) for r in self.replicates
        )


def _inverted(covariance: np.ndarray) -> tuple[float, np.ndarray]:
    """Return half the logarithm of a covariance's (n, n) determinant, and its inverse (n, n).

    By LAPACK itself: scipy's functions around it take as long as the factors of so small matrices.
    """
    factor, failed = dpotrf(covariance, lower=1)
    if failed:
        raise np.linalg.LinAlgError("the covariance of the noise is not positive definite")
    lower, _ = dpotri(factor, lower=1)
    inverse = lower + lower.T
    inverse[np.diag_indices(len(inverse))] *= 0.5
    return float(np.log(factor.diagonal()).sum()), inverse


def fit_noise(
    replicates: Sequence[Replicates],
    assumed: Mapping[str, float],
    replicated: bool,
    largest: Mapping[str, float],
    within: Sequence[NoiseModel] = (),
) -> NoiseModel:
    """Fit by penalised maximum likelihood.

    The likelihood has several maxima, as a long autocorrelation, a random walk and a mechanism resemble each other. The
    search starts from short autocorrelation, and from each model that this one contains, so that more components hardly
    fit worse; where it contains none, from long autocorrelation, too.

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
    likelihood = PenalisedLikelihood(replicates, replicated, assumed, largest)
    starts = [likelihood.start(AUTOCORRELATIONS[0]), *map(likelihood.start_within, within)]
    if not within:
        starts += map(likelihood.start, AUTOCORRELATIONS[1:])
    return likelihood.maximum(starts)
