"""The forward model has the last word: an explanation is simulated, and refitted with the surrogates moved onto it.

The difference between simulated and surrogates' curves at the best point is added to the surrogates, and the fit
repeated, until chi-square settles (output space mapping; Bandler et al., IEEE Trans. Microw. Theory Tech. 52
(2004) 337-361). Each further simulation also corrects the slope, by Broyden's rank-one formula.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.config import Condition, Study
from palpate.diagnosis.fit import Correction, Fit, solve
from palpate.errors import PalpateError
from palpate.model import simulate

ROUNDS = 6
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
    return problem.to_fine_mesh(condition, outcome.depth)


def refine(study: Study, fit: Fit) -> Fit:
    """Return the fit with the forward model in place of the surrogates; as it was when the forward model fails."""
    without = fit.errors.model - fit.errors.surrogate
    exact = replace(fit.errors, model=without, surrogate=np.zeros_like(without))
    correction = fit.correction
    best: Fit | None = None
    z = fit.z
    for _ in range(ROUNDS):
        try:
            curves = [simulated_at(study, condition, fit, z) for condition in fit.problem.conditions]
        except PalpateError:
            return best or fit
        rest = np.concatenate(curves) - fit.problem.curve(fit.explanation, z)
        slope = correction.slope
        if best is not None:
            step = z - best.z
            slope = slope + np.outer(rest - correction(z), step) / max(float(step @ step), 1e-12)
        correction = Correction(z, rest, slope)
        here = replace(fit, z=z, errors=exact, correction=correction)
        if best is None or here.misfit < best.misfit:
            best = here
        else:
            best = replace(best, correction=replace(best.correction, slope=slope))
        proposed = solve(fit.problem, fit.explanation, exact, [best.z], best.correction)
        if best.misfit - proposed.misfit < SETTLED:
            return replace(best, errors=proposed.errors)
        z, correction = proposed.z, best.correction
    return best or fit
