"""The forward model has the last word: an explanation is simulated, and refitted with the surrogates moved onto it.

The difference between simulated and surrogates' curves at the best point is added to the surrogates, and the fit
repeated, until the likelihood settles, or promises little of the way to what noise leaves (output space mapping;
Bandler et al., IEEE Trans. Microw. Theory Tech. 52 (2004) 337-361); there, a promise counts as the last was kept. A
step that makes it worse is tried again within a third of its length (Bakr et al., same Trans. 46 (1998) 2412-2425).

The surrogates' slopes are corrected by secants, of the steps that were taken. Around an explanation that stands the
forward model's own slopes take their place (`palpate.diagnosis.sharpen`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from palpate.config import Condition, Study
from palpate.diagnosis.correction import Correction
from palpate.diagnosis.fit import Fit, solve
from palpate.errors import PalpateError
from palpate.model import Simulation, simulate_batch
from palpate.specification import Specification

ROUNDS = 8
RADIUS = 0.3
SETTLED = 0.5
HOPELESS, ABSURD = 3.0, 30.0  # far more than noise; more than any error of a surrogate
WORTH = 0.25  # of the way to what noise leaves, what a round must promise
DOUBT = 0.5  # of a promise, what counts where the last was not kept at all
MARGIN = 1e-3


def hopeless(fit: Fit) -> bool:
    """Return whether a fit leaves far more than noise."""
    return fit.misfit > HOPELESS * len(fit.residual)


def specification_at(study: Study, condition: Condition, fit: Fit, z: np.ndarray) -> Specification:
    """Return what an explanation at coordinates z simulates under one condition."""
    problem = fit.problem
    specification = study.specification(problem.space.named(problem.parts(fit.explanation, z)[0]), condition)
    return replace(specification, mechanisms=problem.amplitudes(fit.explanation, z))


def simulated_at(study: Study, conditions: Iterable[Condition], fit: Fit, z: np.ndarray) -> list[np.ndarray]:
    """Return the forward model's curves of an explanation at coordinates z (k,) under some conditions [nm].

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    conditions = list(conditions)
    outcomes = simulate_batch(specification_at(study, condition, fit, z) for condition in conditions)
    return [on_fine_mesh(outcome, condition, fit, z) for outcome, condition in zip(outcomes, conditions, strict=True)]


def depth_of(outcome: Simulation, condition: Condition, fit: Fit) -> np.ndarray:
    """Return the curve [nm] of a simulation that did not fail, a load as the depth that it amounts to."""
    if outcome.status != "ok":
        raise PalpateError(f"{'+'.join(fit.explanation) or 'base model'}, {condition.name}: {outcome.reason}")
    return fit.problem.nm.get(condition.name, 1.0) * outcome.response


def on_fine_mesh(outcome: Simulation, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the curve [nm] of a simulation, with the mesh's correction for an explanation at coordinates z.

    Raises
    ------
    PalpateError
        When the solver failed.
    """
    return corrected(body_of(outcome, condition, fit, z), condition, fit, z)


def body_of(outcome: Simulation, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the body's own depth [nm] in a simulation that did not fail, without what the instrument adds."""
    return depth_of(outcome, condition, fit) - fit.problem.recorded(fit.explanation, condition, z)


def corrected(body: np.ndarray, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return what is recorded of a body's depth (n_points,) [nm]: the mesh errs by that, not by what is added to it."""
    return body * fit.problem.mesh_factor(condition) + fit.problem.recorded(fit.explanation, condition, z)


def curve_under(study: Study, condition: Condition, fit: Fit) -> np.ndarray:
    """Return the curve of a fit under any condition [nm]: as fitted, or simulated where the condition took no part."""
    fitted = fit.problem.split(fit.curve)
    return fitted[condition.name] if condition.name in fitted else simulated_at(study, [condition], fit, fit.z)[0]


def refine(study: Study, fit: Fit, lacking: Callable[[Fit], float], least: float = -np.inf) -> Fit:
    """Return the fit with the forward model in place of the surrogates.

    Parameters
    ----------
    lacking
        Returns by how much the chi-square of a fit must fall before noise alone is left.
    least
        Logarithm of the evidence below which the explanation does not matter.

    Raises
    ------
    PalpateError
        When the forward model fails at the fit's coordinates.
    """
    z = np.clip(fit.z, MARGIN, 1.0 - MARGIN)
    start = Correction.constant(z, missed_by_surrogates(study, fit, z))
    best = replace(fit, z=z, correction=start, errors=fit.errors.exact)
    if min(fit.misfit, best.misfit) > ABSURD * len(fit.residual):
        return best
    return _followed(study, best, lacking, least)


def _followed(study: Study, best: Fit, lacking: Callable[[Fit], float], least: float = -np.inf) -> Fit:
    """Return the fit at the optimum to which the forward model leads; see `refine`."""
    radius, kept = RADIUS, 1.0
    for _ in range(ROUNDS):
        proposed = solve(best.problem, best.explanation, best.errors, [best.z], best.correction, radius, best.laws)
        promised = 2.0 * (proposed.log_likelihood - best.log_likelihood)
        settled = SETTLED * max(1.0, best.misfit / len(best.residual))
        if promised < settled or proposed.log_evidence < least:
            return proposed
        if kept * promised < WORTH * lacking(proposed):
            return best
        z = np.clip(proposed.z, MARGIN, 1.0 - MARGIN)
        if np.array_equal(z, best.z):
            return proposed
        try:
            tried = replace(proposed, z=z, correction=best.correction.moved(z, missed_by_surrogates(study, best, z)))
        except PalpateError:
            return best
        if hopeless(best) and tried.misfit > 0.5 * best.misfit:
            return min(best, tried, key=lambda found: found.misfit)
        gained = 2.0 * (tried.log_likelihood - best.log_likelihood)
        kept = min(max(gained / promised, DOUBT), 1.0)
        if gained > 0.0:
            best = tried
        else:
            radius = float(np.abs(z - best.z).max()) / 3.0
            best = replace(best, correction=replace(best.correction, slope=tried.correction.slope))
    return best


def missed_by_surrogates(study: Study, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the forward model's less the surrogates' curves (n_all,) at coordinates z (k,) [nm]."""
    simulated = simulated_at(study, fit.problem.conditions, fit, z)
    return np.concatenate(simulated) - fit.problem.curves(fit.explanation, z[None])[0]
