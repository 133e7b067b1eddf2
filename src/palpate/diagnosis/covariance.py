"""The covariance of the mean curves: noise of the recordings, error of the solver and of the surrogates, in one matrix.

Every instrument drifts a little. A steady rate that differs between recordings with a standard deviation of up to
0.01 nm/s counts as background, not as an effect (Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, began their tests
once the rate was below 0.05 nm/s).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from palpate.calibration.noise import model_covariance, ripple
from palpate.diagnosis.noise import NoiseModel, Replicates, contrasts, fit_noise, without_trend
from palpate.diagnosis.problem import Explanation, Problem
from palpate.diagnosis.segments import segments
from palpate.mechanisms import MECHANISMS

ASSUMED_WANDER = 0.02
BACKGROUND = 0.01


@dataclass(frozen=True, eq=False)
class Errors:
    """The errors of the mean curves under one explanation.

    Attributes
    ----------
    noise
        Noise of single recordings; contains a component for each mechanism whose value varies.
    components
        The components' matrices for each condition.
    model : ndarray, shape (n_all, n_all)
        Covariance of the errors of the simulation, those of the surrogates included [nm^2].
    surrogate : ndarray, shape (n_all, n_all)
        The surrogates' part of it.
    counts
        Number of recordings of each condition.
    """

    noise: NoiseModel
    components: list[dict[str, np.ndarray]]
    model: np.ndarray
    surrogate: np.ndarray
    counts: list[int]

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the mean curves (n_all, n_all) [nm^2]."""
        return self.model + block_diag(*self.blocks(self.noise))

    def blocks(self, noise: NoiseModel) -> list[np.ndarray]:
        """Return the noise of the mean of each condition's recordings."""
        return [
            noise.matrix(k, parts) / n for k, (parts, n) in enumerate(zip(self.components, self.counts, strict=True))
        ]


def varying(explanation: Explanation) -> tuple[str, ...]:
    """Return the mechanisms of an explanation that have a value of their own for each recording."""
    return tuple(key for key in explanation if MECHANISMS[key].varies)


def components(problem: Problem, keys: Iterable[str]) -> list[dict[str, np.ndarray]]:
    """Return the matrices of the variance components of each condition."""
    found = []
    for condition in problem.conditions:
        item = problem.observed[condition.name]
        parts = {
            "site": np.outer(item.mean, item.mean),
            "wander": np.minimum.outer(item.time, item.time),
            "background": np.outer(item.time, item.time),
        }
        for key in keys:
            unit = {p.name: 1.0 for p in MECHANISMS[key].parameters}
            column = problem.recorded_effect(key, condition, unit)
            parts[key] = np.outer(column, column)
        found.append(parts)
    return found


def assumed_variances(problem: Problem, keys: Iterable[str], site_scatter: float) -> dict[str, float]:
    """Return the variances that count where nothing is replicated; of a plausible range, a tenth."""
    assumed = {"site": site_scatter**2, "wander": ASSUMED_WANDER**2, "background": (0.3 * BACKGROUND) ** 2}
    for key in keys:
        (plausible,) = MECHANISMS[key].plausible(problem.scale).values()
        assumed[key] = (0.1 * plausible.upper) ** 2
    return assumed


def noise_of(
    problem: Problem, keys: tuple[str, ...], residual: np.ndarray, site_scatter: float
) -> tuple[NoiseModel, list]:
    """Fit the noise with components for `keys`; the `residual` (n_all,) serves where nothing is replicated."""
    parts = components(problem, keys)
    assumed = assumed_variances(problem, keys, site_scatter)
    items = [problem.observed[condition.name] for condition in problem.conditions]
    replicated = all(len(item.depth) > 1 for item in items)
    rests = problem.split(residual)
    replicates = []
    for condition, item, part in zip(problem.conditions, items, parts, strict=True):
        size = len(item.time)
        if replicated:
            replicates.append(Replicates(contrasts(item.depth), np.eye(size), part, float(np.abs(item.mean).max())))
        else:
            basis = without_trend(list(segments(condition.protocol).values()))
            rest = np.sqrt(len(item.depth)) * rests[condition.name]
            replicates.append(Replicates((basis @ rest)[None], basis, part, float(np.abs(item.mean).max())))
    return fit_noise(replicates, assumed, replicated, {"background": BACKGROUND**2}), parts


def errors(
    problem: Problem, explanation: Explanation, residual: np.ndarray, site_scatter: float, solver_error: float
) -> Errors:
    """Put the errors of the mean curves together, for the surrogates of `explanation`."""
    noise, parts = noise_of(problem, varying(explanation), residual, site_scatter)
    measured = {condition.name: problem.observed[condition.name].mean for condition in problem.conditions}
    surrogate = surrogate_error(problem, explanation)
    model = model_covariance(measured, solver_error) + surrogate + solver_scatter(measured, explanation)
    return Errors(noise, parts, model, surrogate, [len(problem.observed[c.name].depth) for c in problem.conditions])


def solver_scatter(measured: Mapping[str, np.ndarray], explanation: Explanation) -> np.ndarray:
    """Return the covariance of what the mesh adds to the simulated effects, correlated over a tenth of each curve."""
    variance = sum(MECHANISMS[key].solver_scatter ** 2 for key in explanation)
    return variance * block_diag(*(np.outer(h, h) * ripple(len(h)) for h in measured.values()))


def surrogate_error(problem: Problem, explanation: Explanation) -> np.ndarray:
    """Return the covariance of the surrogates' errors (n_all, n_all), from their leave-one-out errors."""
    blocks = []
    for condition in problem.conditions:
        found = [problem.base[condition.name].loo_error_]
        effects: Mapping = problem.effects[condition.name]
        found += [effects[key].error for key in explanation if key in effects]
        blocks.append(sum(error.T @ error / len(error) for error in found))
    return block_diag(*blocks)
