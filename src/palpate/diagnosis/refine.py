"""The forward model has the last word: an explanation is simulated, and refitted with the surrogates moved onto it.

The difference between simulated and surrogates' curves at the best point is added to the surrogates, and the fit
repeated, until the likelihood settles, or promises little of the way to what noise leaves (output space mapping;
Bandler et al., IEEE Trans. Microw. Theory Tech. 52 (2004) 337-361); there, a promise counts as the last was kept. A
step that makes it worse is tried again within a third of its length (Bakr et al., same Trans. 46 (1998) 2412-2425).

The surrogates' slopes are corrected by secants, of the steps that were taken; of an explanation that stands, also along
what the recordings tell least about (`sharpen`). Surrogates add up effects that were learnt one by one, and what
follows from another effect's being there is missing: friction beside yielding would seem known to half its uncertainty.
The solver's own derivatives ripple from node to node of the contact by some per cent, which would make coordinates that
the data hardly tell apart look independent. Its curves ripple too, by a thousandth, and the surrogates with them; the
mean over several meshes takes their place here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from palpate.config import Condition, Study
from palpate.diagnosis.fit import Correction, Fit, solve
from palpate.diagnosis.posterior import away
from palpate.errors import PalpateError
from palpate.model import Simulation, simulate, simulate_batch, smooth
from palpate.specification import Specification

ROUNDS = 8
RADIUS = 0.3
SETTLED = 0.5
HOPELESS, ABSURD = 3.0, 30.0  # far more than noise; more than any error of a surrogate
WORTH = 0.25  # of the way to what noise leaves, what a round must promise
DOUBT = 0.5  # of a promise, what counts where the last was not kept at all
MARGIN = 1e-3
AXES = 4  # of the posterior, the widest, along which slopes are measured
SHARPENED, FURTHER = 2, 1.0  # times at most, while the logarithm of the likelihood gains as much


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
    outcomes = simulate_batch([smooth(specification_at(study, condition, fit, z)) for condition in conditions])
    return [_finer(outcome, condition, fit, z) for outcome, condition in zip(outcomes, conditions, strict=True)]


def on_fine_mesh(specification: Specification, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the smooth curve [nm] of a specification, with the mesh's correction for an explanation at coordinates z.

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    return _finer(simulate(smooth(specification)), condition, fit, z)


def _finer(outcome: Simulation, condition: Condition, fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the curve [nm] of a simulation, with the mesh's correction."""
    if outcome.status != "ok":
        raise PalpateError(f"{'+'.join(fit.explanation) or 'base model'}, {condition.name}: {outcome.reason}")
    return outcome.depth * fit.problem.mesh_factor(condition, fit.problem.parts(fit.explanation, z)[1])


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
    start = replace(Correction.none(len(fit.residual), len(z)), at=z, shift=missed_by_surrogates(study, fit, z))
    best = replace(fit, z=z, correction=start, errors=fit.errors.exact)
    if min(fit.misfit, best.misfit) > ABSURD * len(fit.residual):
        return best
    return _followed(study, best, lacking, least)


def sharpen(study: Study, fit: Fit, lacking: Callable[[Fit], float]) -> Fit:
    """Return a refined fit with the forward model's slopes along what is known least, fitted again.

    Steps are one standard deviation long, along the widest axes of the posterior with the surrogates' errors in it. A
    search whose slopes are the surrogates' stops in a long valley where they say so; steps as long as they may be wrong
    show where it leads. What has come further is measured once more there.

    Raises
    ------
    PalpateError
        When the forward model fails within the posterior.
    """
    for _ in range(SHARPENED):
        measured = replace(fit, correction=_measured(study, fit))
        before, fit = fit, _followed(study, measured, lacking)
        if fit.log_likelihood - before.log_likelihood < FURTHER:
            break
    return fit


def _measured(study: Study, fit: Fit) -> Correction:
    """Return the correction of a fit with secants along the widest axes."""
    variances, axes = np.linalg.eigh(replace(fit, errors=away(fit)).posterior)
    correction = fit.correction
    for step in (np.sqrt(variances) * axes).T[: -AXES - 1 : -1]:
        ends = np.clip([fit.z + step, fit.z - step], MARGIN, 1.0 - MARGIN)
        z = ends[np.argmax(np.linalg.norm(ends - fit.z, axis=1))]
        correction = correction.with_secant(z, missed_by_surrogates(study, fit, z))
    return correction


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
