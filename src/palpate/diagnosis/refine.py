"""The forward model has the last word: an explanation is simulated, and refitted with the surrogates moved onto it.

The difference between simulated and surrogates' curves at the best point is added to the surrogates, and the fit
repeated, until chi-square settles (output space mapping; Bandler et al., IEEE Trans. Microw. Theory Tech. 52
(2004) 337-361). The slopes come from the solver's own sensitivities, so this is Gauss-Newton on the forward model.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.config import Condition, Study
from palpate.diagnosis.fit import Correction, Fit, solve
from palpate.errors import InputError, PalpateError
from palpate.model import sensitivities, simulate

ROUNDS = 6
SETTLED = 1.0
STEP = 1e-4
DIFFERENCE = 0.02
MARGIN = 1e-3


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


def slope_at(study: Study, condition: Condition, fit: Fit, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the forward model's curve (n_points,) and its exact slope (n_points, k) by the coordinates [nm].

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    problem = fit.problem
    space, explanation = problem.space, fit.explanation
    material = [name for name, free in zip(space.bounds, space.free, strict=True) if free]
    values = problem.amplitudes(explanation, z)
    names = [*material, *(f"{key}.{name}" for key, given in values.items() for name in given)]
    specification = study.specification(space.named(problem.parts(explanation, z)[0]), condition)
    specification = replace(specification, mechanisms=values)
    try:
        outcome, derivatives = sensitivities(specification, names)
        by_amplitude = derivatives[:, len(material) :] @ _amplitude_slope(fit, z)
    except InputError:
        outcome, derivatives = sensitivities(specification, material)
        by_amplitude = _differences(study, condition, fit, z, outcome.depth)
    if outcome.status != "ok":
        raise PalpateError(f"{'+'.join(explanation) or 'base model'}, {condition.name}: {outcome.reason}")
    slope = np.column_stack([derivatives[:, : len(material)] * space.extent[space.free], by_amplitude])
    return problem.to_fine_mesh(condition, outcome.depth), problem.to_fine_mesh(condition, slope.T).T


def _differences(study: Study, condition: Condition, fit: Fit, z: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the slope (n_points, k) of `depth` by the mechanisms' coordinates, where the solver has no exact one."""
    here = fit.problem.to_fine_mesh(condition, depth)
    columns = []
    for i in range(fit.problem.space.dimensions, len(z)):
        step = np.zeros(len(z))
        step[i] = DIFFERENCE if z[i] < 0.5 else -DIFFERENCE
        columns.append((simulated_at(study, condition, fit, z + step) - here) / step[i])
    return np.array(columns).T


def _amplitude_slope(fit: Fit, z: np.ndarray) -> np.ndarray:
    """Return the slope of all mechanisms' parameters (rows) by their search coordinates, one-sided into the range."""
    count = fit.problem.space.dimensions

    def flat(at: np.ndarray) -> np.ndarray:
        return np.array([v for given in fit.problem.amplitudes(fit.explanation, at).values() for v in given.values()])

    columns = []
    for i in range(count, len(z)):
        step = np.zeros(len(z))
        step[i] = STEP if z[i] < 0.5 else -STEP
        columns.append((flat(z + step) - flat(z)) / step[i])
    return np.array(columns).T if columns else np.zeros((0, 0))


def refine(study: Study, fit: Fit) -> Fit:
    """Return the fit with the forward model in place of the surrogates; as it was when the forward model fails."""
    without = fit.errors.model - fit.errors.surrogate
    errors = replace(fit.errors, model=without, surrogate=np.zeros_like(without))
    best: Fit | None = None
    z = np.clip(fit.z, MARGIN, 1.0 - MARGIN)
    for _ in range(ROUNDS):
        try:
            runs = [slope_at(study, condition, fit, z) for condition in fit.problem.conditions]
        except PalpateError:
            return best or fit
        curve, slope = (np.concatenate(parts) for parts in zip(*runs, strict=True))
        plain = replace(fit, z=z, errors=errors, correction=Correction.none(*slope.shape))
        correction = Correction(z, curve - plain.curve, slope - plain.tangent)
        here = replace(plain, correction=correction)
        if best is not None and here.misfit >= best.misfit:
            z = 0.5 * (z + best.z)
            continue
        best = here
        proposed = solve(fit.problem, fit.explanation, errors, [best.z], best.correction)
        if best.misfit - proposed.misfit < SETTLED:
            return proposed
        z = np.clip(proposed.z, MARGIN, 1.0 - MARGIN)
    return best or fit
