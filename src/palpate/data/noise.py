r"""The noise of recordings: its covariance, and draws from it.

Under condition c, replicate r of the curve h is h_r = h + n_r with the covariance

    K_c = sigma_c^2 rho_c^|i - j| + sum_k v_k M_k,

AR(1) point noise with a standard deviation and an autocorrelation of its own for each condition, and variance
components common to all:

    site     M = h h^T          one depth factor a recording (scatter between sites)
    random walk   M = min(t, t')     slow drift of the instrument, a random walk
    ...      M = c c^T          a mechanism whose value differs between recordings, with its column c(t)

It is estimated from replicates (`noise_fit`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.special import expit, logit

LARGEST_AUTOCORRELATION = 0.99  # of neighbouring points: it falls to 1/e over 100 points
LARGEST_UNREPLICATED_AUTOCORRELATION = 0.9  # over ten points, see `palpate.data.noise_fit`
FURTHEST = 2.0  # by which the logarithm of a variance, or logit rho, may miss its estimate


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """A fitted noise model.

    Attributes
    ----------
    sigma, autocorrelation : ndarray, shape (c,)
        sigma_c [nm] and rho_c.
    variances
        v_k by name.
    log_likelihood
        Of all contrasts.
    covariance : ndarray
        Of the estimates (log sigma, logit rho of each condition, then the variances), from Fisher's information.
    replicated
        Whether it was estimated from replicates; else parts are assumed.
    """

    sigma: np.ndarray
    autocorrelation: np.ndarray
    variances: Mapping[str, float]
    log_likelihood: float
    covariance: np.ndarray
    replicated: bool

    def matrix(self, k: int, components: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return K (n, n) of condition number k [nm^2]."""
        return matrix_of(self.sigma[k], self.autocorrelation[k], self.variances, components)

    def slopes(self, k: int, components: Mapping[str, np.ndarray]) -> dict[int, np.ndarray]:
        """Return the derivative (n, n) of K of condition number k by each estimate, under its place in `covariance`."""
        count, size = len(self.sigma), len(next(iter(components.values())))
        points = point_noise(self.sigma[k], self.autocorrelation[k], size)
        found = {k: 2.0 * points, count + k: slope_by_rho(self.sigma[k], self.autocorrelation[k], size)}
        return found | {2 * count + j: components[name] for j, name in enumerate(self.variances)}

    def under(self, names: Sequence[str], name: str, components: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return K (n, n) of a condition with those `components` that the model has [nm^2].

        One that is not among those whose `names` are in the model's order takes the median of sigma and of rho.
        """
        known = {key: component for key, component in components.items() if key in self.variances}
        if name in names:
            return self.matrix(names.index(name), known)
        return matrix_of(float(np.median(self.sigma)), float(np.median(self.autocorrelation)), self.variances, known)

    @classmethod
    def joined(cls, models: Sequence[NoiseModel]) -> NoiseModel:
        """Return the model of all conditions of several models that know the same variances, each of one condition."""
        count, size = len(models), 2 * len(models) + len(models[0].variances)
        covariance = np.zeros((size, size))
        for k, model in enumerate(models):
            places = np.array([k, count + k, *range(2 * count, size)])
            covariance[np.ix_(places, places)] = model.covariance
        return replace(
            models[0],
            sigma=np.concatenate([model.sigma for model in models]),
            autocorrelation=np.concatenate([model.autocorrelation for model in models]),
            log_likelihood=sum(model.log_likelihood for model in models),
            covariance=covariance,
        )

    def spread(self, places: Sequence[int], count: int) -> NoiseModel:
        """Return the model of `count` conditions of which those at `places` are this one's, in order.

        The others, which were tested once, take the median of sigma and of rho. Their uncertainty is that of one more
        condition beside those (their variance, times one plus one over their number); beside a single one it is not
        known, and twice the variance of its own estimate stands for it.
        """
        if len(places) == count:
            return self
        points = np.stack([np.log(self.sigma), logit(self.autocorrelation)])
        whole = np.repeat(np.median(points, axis=1)[:, None], count, axis=1)
        whole[:, list(places)] = points
        several, own = len(places) > 1, np.diag(self.covariance)[: 2 * len(places)].reshape(2, -1).mean(axis=1)
        scatter = (1.0 + 1.0 / len(places)) * (np.var(points, axis=1, ddof=1) if several else own)
        uncertain = np.append(np.repeat(scatter, count), np.zeros(len(self.variances)))
        kept = np.concatenate([np.array(places), count + np.array(places), 2 * count + np.arange(len(self.variances))])
        covariance = np.diag(uncertain)
        covariance[np.ix_(kept, kept)] = self.covariance
        return replace(self, sigma=np.exp(whole[0]), autocorrelation=expit(whole[1]), covariance=covariance)

    def simulated(
        self, components: Sequence[Mapping[str, np.ndarray]], count: int, rng: np.random.Generator
    ) -> list[np.ndarray]:
        """Return noise (n, count) of one recording of each condition, each column from a model drawn anew [nm].

        The model is drawn from its uncertainty, `covariance`. The errors of sigma and rho are correlated: recordings
        determine the variance of the innovations, sigma^2 (1 - rho^2), and rho, and those two are drawn. The logarithm
        of the one and the logit of the other move by `FURTHEST` at most. Rounding may leave the covariance an
        eigenvalue just below zero, of which the magnitude counts.
        """
        conditions = len(self.sigma)
        mean = np.concatenate([np.zeros(2 * conditions), list(self.variances.values())])
        draws = rng.multivariate_normal(mean, self.covariance, size=count, method="svd", check_valid="ignore")
        larger, longer = draws[:, :conditions], draws[:, conditions : 2 * conditions]
        of_innovation = 2.0 * larger - 2.0 * self.autocorrelation**2 / (1.0 + self.autocorrelation) * longer
        of_innovation, longer = (np.clip(moved, -FURTHEST, FURTHEST) for moved in (of_innovation, longer))
        autocorrelation = np.minimum(
            expit(logit(self.autocorrelation) + longer), largest_autocorrelation(self.replicated)
        )
        sigma = self.sigma * np.sqrt(
            (1.0 - self.autocorrelation**2) / (1.0 - autocorrelation**2) * np.exp(of_innovation)
        )
        deviations = np.sqrt(np.maximum(draws[:, 2 * conditions :], 0.0))
        noise = []
        for k, parts in enumerate(components):
            size = len(next(iter(parts.values())))
            total = sigma[:, k] * _first_order(autocorrelation[:, k], size, rng)
            for deviation, name in zip(deviations.T, self.variances, strict=True):
                total += deviation * (_root(parts[name]) @ rng.standard_normal((size, count)))
            noise.append(total)
        return noise


def largest_autocorrelation(replicated: bool) -> float:
    """Return the largest autocorrelation rho that counts as noise."""
    return LARGEST_AUTOCORRELATION if replicated else LARGEST_UNREPLICATED_AUTOCORRELATION


def matrix_of(
    sigma: float, autocorrelation: float, variances: Mapping[str, float], components: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Return K (n, n) of one condition [nm^2]: its point noise, and the variance `components`.

    Parameters
    ----------
    sigma
        Standard deviation of the point noise [nm].
    autocorrelation
        Correlation rho of neighbouring points.
    variances
        Variance of each component.
    components : mapping of ndarray, shape (n, n)
        Matrix of each component.
    """
    matrix = point_noise(sigma, autocorrelation, len(next(iter(components.values()))))
    for name, component in components.items():
        matrix += variances[name] * component
    return matrix


def point_noise(sigma: float, autocorrelation: float, size: int) -> np.ndarray:
    """Return the covariance (size, size) of the point noise [nm^2]."""
    found = (sigma**2 * autocorrelation ** np.arange(size))[_lags(size)]
    found[np.diag_indices(size)] += 1e-6 * sigma**2
    return found


def slope_by_rho(sigma: float, autocorrelation: float, size: int) -> np.ndarray:
    """Return the derivative (size, size) of the point noise's covariance by logit rho [nm^2]."""
    lags = np.arange(size)
    change = sigma**2 * autocorrelation * (1 - autocorrelation)
    return (change * lags * autocorrelation ** np.maximum(lags - 1, 0))[_lags(size)]


@lru_cache(maxsize=64)
def _lags(size: int) -> np.ndarray:
    """Return by how many places the points of a row and a column (size, size) lie apart."""
    return np.abs(np.subtract.outer(np.arange(size), np.arange(size)))


def _first_order(autocorrelation: np.ndarray, size: int, rng: np.random.Generator) -> np.ndarray:
    """Return stationary autoregressive noise (size, m) of unit variance, a column for each `autocorrelation` (m,)."""
    noise = rng.standard_normal((size, len(autocorrelation)))
    innovation = np.sqrt(1.0 - autocorrelation**2)
    for i in range(1, size):
        noise[i] = autocorrelation * noise[i - 1] + innovation * noise[i]
    return noise


def _root(matrix: np.ndarray) -> np.ndarray:
    """Return the symmetric square root of a matrix that is at least positive semidefinite."""
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
