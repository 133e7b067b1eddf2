"""By how much a mechanism changes the curves of an explanation, and how probable it is that this counts.

A mechanism acts if it changes the mean depth of some part of a test, half of a segment, by more than a stated share of
the depth. The change is known as well as the coordinates of its amplitudes are: it is normal to first order. Where an
amplitude differs between recordings, the root of its mean square counts: drifts of either sign act, too.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import norm

from palpate.diagnosis.parts import mean_changes
from palpate.inference.explanation import Fit


def acts(fit: Fit, key: str, smallest: float) -> float:
    """Return the probability that a mechanism of an explanation acts: by more than `smallest`, a share of the depth.

    It acts by nothing where the curves cannot be simulated without it.
    """
    problem = fit.problem
    smaller, rest = problem.without(fit.explanation, fit.z, key)
    (without,), (with_it,) = problem.model(smaller).curves([rest]), problem.model(fit.explanation).curves([fit.z])
    if isinstance(without, str) or isinstance(with_it, str):
        return _exceeds(0.0, 0.0, smallest)
    change = problem.stacked(with_it) - problem.stacked(without)
    varying = [(problem.unit_effects(a), fit.errors.noise.variances[str(a)]) for a in fit.own if a.key == key]
    places, largest, deviation = problem.places(fit.explanation)[key], 0.0, 0.0
    for weights in mean_changes(problem, fit.curve):
        scatter = sum(variance * float(weights @ column) ** 2 for column, variance in varying)
        size = float(np.hypot(weights @ change, np.sqrt(scatter)))
        if size > largest:
            slope = weights @ fit.tangent[:, places]
            largest, deviation = size, float(np.sqrt(slope @ fit.posterior[np.ix_(places, places)] @ slope))
    return _exceeds(largest, deviation, smallest)


def would_act(fit: Fit, key: str, smallest: float) -> float:
    """Return the probability that a mechanism that only adds to the depth acts if it joins a fit, to first order.

    Each amplitude has its most likely value beside the parameters of the fit, with a normal prior of its typical size.
    """
    problem, amplitudes, largest, deviation = fit.problem, fit.problem.typical(key), 0.0, 0.0
    columns = np.column_stack([problem.unit_effects(amplitude) for amplitude in amplitudes])
    sizes = np.array([problem.typical_size(amplitude) for amplitude in amplitudes])
    change, covariance = fit.joined(columns, sizes**2)
    best, spread = change[len(fit.z) :], covariance[len(fit.z) :, len(fit.z) :]
    for weights in mean_changes(problem, fit.curve):
        along = weights @ columns
        size = abs(float(along @ best))
        if size > largest:
            largest, deviation = size, float(np.sqrt(along @ spread @ along))
    return _exceeds(largest, deviation, smallest)


def _exceeds(size: float, deviation: float, smallest: float) -> float:
    """Return the probability that a change of this size and standard deviation exceeds the smallest one either way."""
    deviation = max(deviation, 1e-12)
    return float(norm.sf((smallest - size) / deviation) + norm.cdf((-smallest - size) / deviation))
