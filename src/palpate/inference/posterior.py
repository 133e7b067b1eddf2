"""Draws from the posterior of an explanation's coordinates.

Where the data hardly determine a parameter the posterior is not Gaussian, and an interval from the linearisation at the
best point misses the truth. The ensemble sampler (Foreman-Mackey et al., PASP 125 (2013) 306-312) follows its shape;
its walkers move by differences of one another (ter Braak & Vrugt, Stat. Comput. 18 (2008) 435-446). The prior is that
of `palpate.inference.coordinates`.
"""

from __future__ import annotations

from collections.abc import Callable

import emcee
import numpy as np

from palpate.inference.curvature import Curvature
from palpate.inference.explanation import Fit

WALKERS_PER_DIMENSION = 6
BURN_IN, KEPT, THINNING = 150, 250, 5
DRAWS = 1000
INSIDE = 0.02  # of a range, within which walkers that would begin beyond a limit begin
LEAPS = 0.1  # share of moves by a whole difference, which lead from one optimum to another


def posterior_draws(fit: Fit, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the coordinates of an explanation, from curves to second order about its best point.

    What it does not explain to the errors widens the posterior: chi-square of the curves is divided by its ratio to the
    degrees of freedom where that exceeds one (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
    """
    walkers, curvature, ratio = WALKERS_PER_DIMENSION * len(fit.z), Curvature.of(fit), max(fit.misfit_ratio, 1.0)
    least, largest = fit.coordinates.limits
    left = -curvature.columns
    left[:, 0] += fit.problem.mean
    white = fit.whiten(left)
    products = white.T @ white / ratio

    def log_probability(z: np.ndarray) -> np.ndarray:
        inside = np.all((z >= least) & (z <= largest), axis=1)
        found = np.full(len(z), -np.inf)
        if inside.any():
            features, beyond = curvature.features(z[inside]), fit.coordinates.beyond(z[inside])
            found[inside] = -0.5 * (np.sum((features @ products) * features, axis=1) + np.sum(beyond**2, axis=1))
            if fit.laws:
                found[inside] -= 0.5 * np.array([np.sum(fit.from_laws(row) ** 2) for row in z[inside]])
        return found

    start = rng.multivariate_normal(fit.z, fit.posterior, size=walkers, method="svd")
    room = INSIDE * rng.uniform(size=start.shape)
    return sampled(log_probability, np.clip(start, least + room, largest - room), rng)


def draws_to_first_order(fit: Fit, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the coordinates of an explanation that is not accepted, from linearised curves."""
    return rng.multivariate_normal(fit.z, fit.posterior, size=DRAWS, method="svd")


def sampled(
    log_probability: Callable[[np.ndarray], np.ndarray], start: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Return draws (m, k) from a density given by its logarithm at points (n, k), from walkers at `start` (n, k)."""
    moves = [(emcee.moves.DEMove(), 1.0 - LEAPS), (emcee.moves.DEMove(gamma0=1.0), LEAPS)]
    sampler = emcee.EnsembleSampler(*start.shape, log_probability, moves=moves, vectorize=True)
    sampler.random_state = np.random.RandomState(rng.integers(2**31)).get_state()
    sampler.run_mcmc(start, BURN_IN + KEPT, skip_initial_state_check=True)
    return sampler.get_chain(discard=BURN_IN, thin=THINNING, flat=True)
