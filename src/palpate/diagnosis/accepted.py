"""What recordings must hold so that a single explanation is identified, and not only suspected."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS


def sufficient_to_identify(problem: Problem, explanation: Explanation) -> bool:
    """Return whether the recordings suffice to name the single explanation that is accepted.

    Where at most half of the conditions are repeated, part of the noise is assumed. A single condition determines a
    curve, not a law: a law outside the library may change that curve as an effect on the body does.
    """
    return problem.replicated and (of_instrument(explanation) or len(problem.conditions) > 1)


def zero_on_average(fit: Fit) -> list[str]:
    """Return the instrument's effects of an explanation whose mean amplitudes do not differ from zero at 95 %.

    With their values a and covariance V, a^T V^-1 a is then below the quantile of chi-square. They explain that single
    recordings differ, which chance or another law may cause, too. An effect that averages out is judged by its scatter.
    """
    undecided, problem = [], fit.problem
    for key in [key for key in fit.explanation if not (MECHANISMS[key].acts_on_body or MECHANISMS[key].averages_out)]:
        names = [f"{key}.{name}" for name in MECHANISMS[key].amplitudes]
        places = [problem.place(fit.explanation, name) for name in names]
        values, slopes = np.transpose([problem.quantity(fit.explanation, fit.z, name) for name in names])
        steps = values / slopes
        if steps @ np.linalg.solve(fit.posterior[np.ix_(places, places)], steps) <= chi2.ppf(0.95, len(names)):
            undecided.append(key)
    return undecided


def of_instrument(explanation: Explanation) -> bool:
    """Return whether no mechanism of an explanation acts on the body."""
    return not any(MECHANISMS[key].acts_on_body for key in explanation)
