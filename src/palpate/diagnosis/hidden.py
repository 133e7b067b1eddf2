"""What may still hide behind an explanation that stands: amplitudes of effects on the recorded depth that it lacks.

Each joins alone, by generalised least squares together with the parameters of the explanation, to first order about
the best point. A wide interval says that these recordings neither show the effect nor rule it out.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from palpate.diagnosis.fit import PRIOR_VARIANCE, Fit
from palpate.diagnosis.law import NORMAL_95
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.mechanism import unchanged_specification


def may_hide(fit: Fit, keys: Iterable[str]) -> dict[str, dict[str, float]]:
    """Return, as ``key.name``, estimate and 95 % interval of each mechanism in `keys` that only adds to the depth."""
    slopes = fit.whiten(fit.problem.jacobian(fit.explanation, fit.z))
    found = {}
    for key in keys:
        mechanism = MECHANISMS[key]
        if key in fit.explanation or mechanism.simulate is not unchanged_specification:
            continue
        (parameter,) = mechanism.parameters
        column = np.concatenate([fit.problem.unit_effect(key, c) for c in fit.problem.conditions])
        design = np.column_stack([slopes, fit.whiten(column)])
        prior = np.append(np.full(slopes.shape[1], 1.0 / PRIOR_VARIANCE), 0.0)
        covariance = np.linalg.inv(design.T @ design + np.diag(prior))
        estimate = float((covariance @ design.T @ fit.white)[-1])
        half = NORMAL_95 * float(np.sqrt(covariance[-1, -1]))
        found[f"{key}.{parameter.name}"] = {"estimate": estimate, "lower": estimate - half, "upper": estimate + half}
    return found
