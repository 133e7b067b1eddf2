"""The forward model has the last word: an explanation is simulated, and refitted with the surrogates moved onto it.

The difference between simulated and surrogates' curves at the best point is added to the surrogates, and the fit
repeated, until chi-square settles (output space mapping; Bandler et al., IEEE Trans. Microw. Theory Tech. 52
(2004) 337-361).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.config import Condition, Study
from palpate.diagnosis.fit import Fit, solve
from palpate.errors import PalpateError
from palpate.model import simulate

ROUNDS = 3
SETTLED = 1.0


def simulated_at(study: Study, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the forward model's curve of an explanation at coordinates z under one condition [nm].

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    problem = fit.problem
    specification = study.specification(problem.space.named(problem.parts(fit.explanation, z)[0]), condition)
    outcome = simulate(replace(specification, mechanisms=problem.amplitudes(fit.explanation, z)))
    if outcome.status != "ok":
        raise PalpateError(f"{'+'.join(fit.explanation) or 'base model'}, {condition.name}: {outcome.reason}")
    return outcome.depth


def refine(study: Study, fit: Fit) -> Fit:
    """Return the fit with the forward model in place of the surrogates; as it was when the forward model fails."""
    exact = replace(
        fit.errors, model=fit.errors.model - fit.errors.surrogate, surrogate=np.zeros_like(fit.errors.model)
    )
    best, previous = fit, np.inf
    for _ in range(ROUNDS):
        try:
            curves = [simulated_at(study, condition, fit, fit.z) for condition in fit.problem.conditions]
        except PalpateError:
            return best
        shift = np.concatenate(curves) - fit.problem.curve(fit.explanation, fit.z)
        here = Fit(fit.problem, fit.explanation, fit.z, exact, shift)
        misfit = float(np.sum(here.whiten(here.residual) ** 2))
        if misfit < previous:
            best = here
        fit = solve(fit.problem, fit.explanation, exact, [fit.z], shift)
        gain = misfit - float(np.sum(fit.whiten(fit.residual) ** 2))
        previous = min(misfit, previous)
        if gain < SETTLED:
            break
    return best
