r"""What noise of the recordings looks like: a covariance, and draws from it.

Under condition c, replicate r of the curve h is h_r = h + n_r with the covariance

    K_c = sigma_c^2 rho_c^|i - j| + sum_k v_k M_k,

point noise AR(1) of its own strength and memory for each condition, and variance components common to all:

    site     M = h h^T          one depth factor a recording (scatter between sites)
    wander   M = min(t, t')     slow drift of the instrument, a random walk
    ...      M = c c^T          a mechanism whose value differs between recordings, with its column c(t)

Replicates fix it (`noise_fit`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import toeplitz
from scipy.special import expit, logit

LARGEST_MEMORY = 0.99
SINGLE_MEMORY = 0.9
FURTHEST = 2.0


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """A fitted noise model.

    Attributes
    ----------
    sigma, memory : ndarray, shape (c,)
        sigma_c [nm] and rho_c.
    variances
        v_k by name.
    log_likelihood
        Of all contrasts.
    covariance : ndarray
        Of the estimates (log sigma, logit rho of each condition, then the variances), from Fisher's information.
    replicated
        Whether replicates fixed it; else parts are assumed.
    """

    sigma: np.ndarray
    memory: np.ndarray
    variances: Mapping[str, float]
    log_likelihood: float
    covariance: np.ndarray
    replicated: bool

    def matrix(self, k: int, components: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return K (n, n) of condition number k [nm^2]."""
        return matrix_of(self.sigma[k], self.memory[k], self.variances, components)

    def slopes(self, k: int, components: Mapping[str, np.ndarray]) -> dict[int, np.ndarray]:
        """Return the derivative (n, n) of K of condition number k by each estimate, under its place in `covariance`."""
        count, size = len(self.sigma), len(next(iter(components.values())))
        points = point_noise(self.sigma[k], self.memory[k], size)
        found = {k: 2.0 * points, count + k: slope_by_memory(self.sigma[k], self.memory[k], size)}
        return found | {2 * count + j: components[name] for j, name in enumerate(self.variances)}

    def typical(self, components: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return K (n, n) of a condition of which only `components` are known, where the model has them [nm^2]."""
        known = {name: component for name, component in components.items() if name in self.variances}
        return matrix_of(float(np.median(self.sigma)), float(np.median(self.memory)), self.variances, known)

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
            memory=np.concatenate([model.memory for model in models]),
            log_likelihood=sum(model.log_likelihood for model in models),
            covariance=covariance,
        )

    def spread(self, places: Sequence[int], count: int) -> NoiseModel:
        """Return the model of `count` conditions of which those at `places` are this one's, in order.

        The others, which were tested once, take the median of their strength and memory, as uncertain as they differ.
        """
        if len(places) == count:
            return self
        points = np.stack([np.log(self.sigma), logit(self.memory)])
        whole = np.repeat(np.median(points, axis=1)[:, None], count, axis=1)
        whole[:, list(places)] = points
        doubt = np.append(np.repeat(np.var(points, axis=1), count), np.zeros(len(self.variances)))
        kept = np.concatenate([np.array(places), count + np.array(places), 2 * count + np.arange(len(self.variances))])
        covariance = np.diag(doubt)
        covariance[np.ix_(kept, kept)] = self.covariance
        return replace(self, sigma=np.exp(whole[0]), memory=expit(whole[1]), covariance=covariance)

    def simulated(
        self, components: Sequence[Mapping[str, np.ndarray]], count: int, rng: np.random.Generator
    ) -> list[np.ndarray]:
        """Return noise (n, count) of one recording of each condition, each column from a model drawn anew [nm].

        The model is drawn from its uncertainty, `covariance`. Strength and memory err together: what recordings tell
        apart is the fresh part of the point noise, sigma^2 (1 - rho^2), and its memory, and those two are drawn. The
        logarithm of the one and logit rho of the other move by `FURTHEST` at most. Rounding may leave the covariance an
        eigenvalue just below zero, of which the magnitude counts.
        """
        conditions = len(self.sigma)
        mean = np.concatenate([np.zeros(2 * conditions), list(self.variances.values())])
        draws = rng.multivariate_normal(mean, self.covariance, size=count, method="svd", check_valid="ignore")
        louder, longer = draws[:, :conditions], draws[:, conditions : 2 * conditions]
        fresher = 2.0 * louder - 2.0 * self.memory**2 / (1.0 + self.memory) * longer
        fresher, longer = (np.clip(moved, -FURTHEST, FURTHEST) for moved in (fresher, longer))
        memory = np.minimum(expit(logit(self.memory) + longer), largest_memory(self.replicated))
        sigma = self.sigma * np.sqrt((1.0 - self.memory**2) / (1.0 - memory**2) * np.exp(fresher))
        deviations = np.sqrt(np.maximum(draws[:, 2 * conditions :], 0.0))
        noise = []
        for k, parts in enumerate(components):
            size = len(next(iter(parts.values())))
            total = sigma[:, k] * _first_order(memory[:, k], size, rng)
            for deviation, name in zip(deviations.T, self.variances, strict=True):
                total += deviation * (_root(parts[name]) @ rng.standard_normal((size, count)))
            noise.append(total)
        return noise


def largest_memory(replicated: bool) -> float:
    """Return the largest memory that counts as noise."""
    return LARGEST_MEMORY if replicated else SINGLE_MEMORY


def matrix_of(
    sigma: float, memory: float, variances: Mapping[str, float], components: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Return K (n, n) of one condition [nm^2]: its point noise, and the variance `components`."""
    matrix = point_noise(sigma, memory, len(next(iter(components.values()))))
    for name, component in components.items():
        matrix += variances[name] * component
    return matrix


def point_noise(sigma: float, memory: float, size: int) -> np.ndarray:
    """Return the covariance (size, size) of the point noise [nm^2]."""
    return sigma**2 * (toeplitz(memory ** np.arange(size)) + 1e-6 * np.eye(size))


def slope_by_memory(sigma: float, memory: float, size: int) -> np.ndarray:
    """Return the derivative (size, size) of the point noise's covariance by logit rho [nm^2]."""
    lags = np.arange(size)
    return sigma**2 * toeplitz(lags * memory ** np.maximum(lags - 1, 0)) * memory * (1 - memory)


def _first_order(memory: np.ndarray, size: int, rng: np.random.Generator) -> np.ndarray:
    """Return stationary autoregressive noise (size, m) of unit variance, a column for each `memory` (m,)."""
    noise = rng.standard_normal((size, len(memory)))
    fresh = np.sqrt(1.0 - memory**2)
    for i in range(1, size):
        noise[i] = memory * noise[i - 1] + fresh * noise[i]
    return noise


def _root(matrix: np.ndarray) -> np.ndarray:
    """Return the symmetric square root of a matrix that is at least positive semidefinite."""
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
