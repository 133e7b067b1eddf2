"""What may still hide behind an explanation that stands: amplitudes of effects on the recorded depth that it lacks.

Each joins alone, by generalised least squares together with the parameters of the explanation, to first order about
the best point, where an exact law speaks of it with that law. A wide interval says that these recordings neither show the
effect nor rule it out; what it trades with most says why.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from palpate.diagnosis.fit import PRIOR_VARIANCE, Fit
from palpate.diagnosis.law import NORMAL_95
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.mechanism import unchanged_specification


def may_hide(fit: Fit, keys: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return, as ``key.name``, estimate and 95 % interval of each mechanism in `keys` that only adds to the depth.

    ``trades_with`` is what it can be mistaken for: the coordinate with the largest posterior ``correlation``.
    """
    names, off = coordinate_names(fit), fit.from_laws(fit.z)
    slopes = fit.whiten(fit.problem.jacobian(fit.explanation, fit.z))
    found = {}
    for key in keys:
        mechanism = MECHANISMS[key]
        if key in fit.explanation or mechanism.simulate is not unchanged_specification:
            continue
        (parameter,) = mechanism.parameters
        column = np.concatenate([fit.problem.unit_effect(key, c) for c in fit.problem.conditions])
        design = np.column_stack([slopes, fit.whiten(column)])
        precision = design.T @ design + np.diag(np.append(np.full(slopes.shape[1], 1.0 / PRIOR_VARIANCE), 0.0))
        pull = design.T @ fit.white
        precision[:-1, :-1] += fit.law_tangent.T @ fit.law_tangent
        pull[:-1] -= fit.law_tangent.T @ off
        for law in [law for law in fit.laws if law.key == key]:
            precision[-1, -1] += law.weight(0.0) ** 2
            pull[-1] -= law.weight(0.0) * law.departure(0.0)
        covariance = np.linalg.inv(precision)
        deviation = np.sqrt(np.diag(covariance))
        correlation = (covariance[-1] / (deviation * deviation[-1]))[:-1]
        furthest = int(np.argmax(np.abs(correlation)))
        estimate, half = float((covariance @ pull)[-1]), NORMAL_95 * float(deviation[-1])
        found[f"{key}.{parameter.name}"] = {
            "estimate": estimate,
            "lower": estimate - half,
            "upper": estimate + half,
            "trades_with": names[furthest],
            "correlation": float(correlation[furthest]),
        }
    return found


def coordinate_names(fit: Fit) -> list[str]:
    """Return the name of each coordinate: a material parameter, or ``key.name`` of a mechanism's."""
    space = fit.problem.space
    names = [name for name, free in zip(space.bounds, space.free, strict=True) if free]
    for key in fit.explanation:
        names += [f"{key}.{name}" for name in MECHANISMS[key].plausible(fit.problem.scale)]
    return names
