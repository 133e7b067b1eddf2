"""The forward model's own curves around an explanation that stands, in place of the surrogates.

Surrogates add up effects that were learnt one by one: friction beside yielding would seem known to half its
uncertainty. So the solver runs at places one standard deviation of the posterior apart, and the fit goes downhill with
the central differences that these give, each step simulated.

Where the optimum leaves these places, or what is left open around it reaches far beyond them, the slopes are those of
another place: in a long and bent valley a search ends early, and looks surer than it is. Then a second set of places
lies there, and a third.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from palpate.config import Study
from palpate.diagnosis.design import thinned
from palpate.diagnosis.effects import interpolation
from palpate.diagnosis.fit import Fit, minimised, spread_own_values
from palpate.diagnosis.local import Local, Straight, design
from palpate.diagnosis.posterior import away
from palpate.diagnosis.refine import MARGIN, RADIUS, SETTLED, body_of, corrected, simulated_at, specification_at
from palpate.mechanisms import MECHANISMS
from palpate.model import simulate_batch

DESIGNS, STEPS = 3, 5  # designs at most, and steps downhill in each
LEFT = 1.0  # standard deviations, as a root mean square over coordinates, by which the optimum may move within a design
GREW = 1.5  # ratio of what is left open in some direction to the design's extent, beyond which that was too small


def sharpen(study: Study, fit: Fit) -> Fit:
    """Return a refined fit, fitted again to the forward model's curves around it.

    Raises
    ------
    PalpateError
        When the forward model fails within the posterior.
    """
    region = replace(fit, errors=away(fit)).posterior
    moved, known = fit.problem.acts_on_body(fit.explanation), fit.problem.slope_by_instrument(fit.explanation)
    fit = replace(fit, z=fit.correction.at)
    for _ in range(DESIGNS):
        straight = _straight(fit, region)
        places, axes = design(fit.z, region, straight, moved)
        places = np.vstack([fit.z, places.clip(MARGIN, 1.0 - MARGIN)])
        curves = fit.curve + changes_from(study, fit, places)
        found = _downhill(study, fit, Local.through(fit.curve, places, curves, axes, straight, known))
        grew, directions = eigh(found.posterior, region)
        left = np.sqrt((found.z - fit.z) @ np.linalg.solve(region, found.z - fit.z) / len(fit.z))
        settled = left <= LEFT and grew[-1] <= GREW**2
        fit = found
        if settled:
            break
        region = _grown(region, grew, directions)
    return spread_own_values(minimised(fit, RADIUS), RADIUS)


def _straight(fit: Fit, region: np.ndarray) -> Straight:
    """Return how to straighten coordinates: factors from their standard deviations in a region (k, k) on."""
    scale, start = fit.problem.scale, fit.problem.space.dimensions
    ranges = [r for key in fit.explanation for r in MECHANISMS[key].searched(scale).values()]
    factors = np.array([False] * start + [r.factor and r.lower == 0.0 for r in ranges])
    return Straight(np.where(factors, np.sqrt(np.diag(region)), np.inf))


def _downhill(study: Study, fit: Fit, local: Local) -> Fit:
    """Return where steps with some slopes lead, while one promises something; a step that leads up is tried shorter."""
    fit, radius = replace(fit, local=local), RADIUS
    for _ in range(STEPS):
        proposed = minimised(fit, radius)
        z = np.clip(proposed.z, MARGIN, 1.0 - MARGIN)
        if 2.0 * (proposed.log_likelihood - fit.log_likelihood) < SETTLED or np.array_equal(z, fit.z):
            break
        curve = np.concatenate(simulated_at(study, fit.problem.conditions, fit, z))
        tried = replace(fit, z=z, local=local.moved(z, curve))
        if tried.log_likelihood > fit.log_likelihood:
            fit = tried
        else:
            radius = float(np.abs(z - fit.z).max()) / 3.0
    return fit


def _grown(region: np.ndarray, grew: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return the extent (k, k) of the next design: what grew by more than was foreseen is taken to do so again.

    Parameters
    ----------
    region : ndarray, shape (k, k)
        The extent of the last one.
    grew : ndarray, shape (k,)
        By how much variances turned out greater than it, along `directions` (k, k), in whose coordinates it is one.
    """
    wider = region @ directions
    return (wider * np.where(grew > GREW**2, grew**2, grew)) @ wider.T


def changes_from(study: Study, fit: Fit, places: np.ndarray) -> np.ndarray:
    """Return by how much the curves (m, n_all) differ from the first, between some coordinates (m, k) [nm].

    With a third of the points in time, so that there are fewer steps: in differences their error cancels.

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    problem = fit.problem
    short = [replace(condition, protocol=thinned(condition.protocol)) for condition in problem.conditions]
    wanted = [(z, *pair) for z in places for pair in zip(short, problem.conditions, strict=True)]
    outcomes = simulate_batch(specification_at(study, condition, fit, z) for z, condition, _ in wanted)
    curves = []
    for (z, condition, whole), outcome in zip(wanted, outcomes, strict=True):
        spread = interpolation(condition.protocol.sample_time, whole.protocol.sample_time)
        curves.append(corrected(spread @ body_of(outcome, condition, fit, z), whole, fit, z))
    rows = np.concatenate(curves).reshape(len(places), -1)
    return rows - rows[0]
