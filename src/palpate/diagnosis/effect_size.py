"""By how much a mechanism changes the curves of an explanation, and how probable it is that this counts.

A mechanism acts if it changes the mean depth of some part of a test, half of a segment, by more than a stated share of
the depth. The change is known as well as the coordinates of its amplitudes are: it is normal to first order. Where an
amplitude differs between recordings, the root of its mean square counts: drifts of either sign act, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from palpate.inference.explanation import PRIOR_VARIANCE, Fit
from palpate.inference.problem import Problem
from palpate.study.prescribed_segments import segments


@dataclass(frozen=True)
class EffectSize:
    """The largest change of a part of a test.

    Parameters
    ----------
    size, deviation
        Of the mean depth, as a share of the largest depth so far, and its standard deviation [-].
    """

    size: float
    deviation: float

    def acts(self, smallest: float) -> float:
        """Return the probability that it exceeds a share of the depth, in either direction."""
        deviation = max(self.deviation, 1e-12)
        return float(norm.sf((smallest - self.size) / deviation) + norm.cdf((-smallest - self.size) / deviation))


def effect_size(fit: Fit, key: str) -> EffectSize:
    """Return how much a mechanism of an explanation changes the curves; none where it cannot be simulated without."""
    problem = fit.problem
    smaller, rest = problem.without(fit.explanation, fit.z, key)
    (without,), (with_it,) = problem.model(smaller).curves([rest]), problem.model(fit.explanation).curves([fit.z])
    if isinstance(without, str) or isinstance(with_it, str):
        return EffectSize(0.0, 0.0)
    change = problem.stacked(with_it) - problem.stacked(without)
    varying = [(problem.unit_effects(a), fit.errors.noise.variances[str(a)]) for a in fit.own if a.key == key]
    places = problem.places(fit.explanation)[key]
    found = EffectSize(0.0, 0.0)
    for weights in parts(problem, fit.curve):
        scatter = sum(variance * float(weights @ column) ** 2 for column, variance in varying)
        size = float(np.hypot(weights @ change, np.sqrt(scatter)))
        if size > found.size:
            slope = weights @ fit.tangent[:, places]
            found = EffectSize(size, float(np.sqrt(slope @ fit.posterior[np.ix_(places, places)] @ slope)))
    return found


def added_effect_size(fit: Fit, key: str) -> EffectSize:
    """Return how much a mechanism that only adds to the depth would change the curves if it joined, to first order.

    Each amplitude has its most likely value beside the parameters of the fit, with a normal prior of its typical size.
    """
    problem, found = fit.problem, EffectSize(0.0, 0.0)
    amplitudes = problem.typical(key)
    columns = np.column_stack([problem.unit_effects(amplitude) for amplitude in amplitudes])
    sizes = np.array([problem.typical_size(amplitude) for amplitude in amplitudes])
    design = fit.whiten(np.column_stack([fit.tangent, columns]))
    prior = np.append(np.full(len(fit.z), 1.0 / PRIOR_VARIANCE), 1.0 / sizes**2)
    covariance = np.linalg.inv(design.T @ design + np.diag(prior))
    best, spread = (covariance @ design.T @ fit.white)[len(fit.z) :], covariance[len(fit.z) :, len(fit.z) :]
    for weights in parts(problem, fit.curve):
        along = weights @ columns
        size = abs(float(along @ best))
        if size > found.size:
            found = EffectSize(size, float(np.sqrt(along @ spread @ along)))
    return found


def parts(problem: Problem, depth: np.ndarray) -> Iterator[np.ndarray]:
    """Yield weights (n_all,) that give the mean change of each half of a segment, as a share of the depth so far.

    Parameters
    ----------
    problem
        The tests.
    depth : ndarray, shape (n_all,)
        Their curves [nm].
    """
    first, curves = 0, problem.split(depth)
    for condition in problem.conditions:
        largest = np.maximum.accumulate(np.abs(curves[condition.name]))
        for where in segments(condition.protocol).values():
            places = np.flatnonzero(where)
            for half in np.array_split(places, 2):
                weights = np.zeros(len(depth))
                weights[first + half] = 1.0 / largest[half].sum()
                yield weights
        first += len(largest)
