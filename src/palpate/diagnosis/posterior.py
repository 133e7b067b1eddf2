"""What the recordings leave open: draws from the posterior of an explanation's coordinates.

Where the data hardly fix a parameter the likelihood is curved, and an interval from its slope at the best point misses
the truth. The ensemble sampler (Foreman-Mackey et al., PASP 125 (2013) 306-312) follows the curve; its walkers move by
differences of one another (ter Braak & Vrugt, Stat. Comput. 18 (2008) 435-446). The prior is even over the ranges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import emcee
import numpy as np

from palpate.diagnosis.covariance import Errors, surrogate_error
from palpate.diagnosis.fit import Fit

WALKERS_PER_DIMENSION = 6
SETTLING, KEPT, THINNING = 150, 250, 5
LEAPS = 0.1  # share of moves by a whole difference, which lead from one optimum to another


def posterior_draws(fit: Fit, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the coordinates of an explanation.

    Away from the best point the surrogates err again, also where the forward model has corrected them there; and so
    does the plane that took their place.
    """
    fit = replace(fit, errors=away(fit))
    walkers = WALKERS_PER_DIMENSION * len(fit.z)

    def log_probability(z: np.ndarray) -> np.ndarray:
        inside = np.all((z >= 0.0) & (z <= 1.0), axis=1)
        found = np.full(len(z), -np.inf)
        if inside.any():
            white = fit.whiten((fit.problem.mean - fit.curves(z[inside])).T)
            found[inside] = -0.5 * np.sum(white**2, axis=0)
            if fit.laws:
                found[inside] -= 0.5 * np.array([np.sum(fit.from_laws(row) ** 2) for row in z[inside]])
        return found

    start = rng.multivariate_normal(fit.z, fit.posterior, size=walkers, method="svd")
    start = np.clip(start, rng.uniform(0.0, 0.02, start.shape), rng.uniform(0.98, 1.0, start.shape))
    return sampled(log_probability, start, rng)


def away(fit: Fit) -> Errors:
    """Return the errors of a fit away from where the forward model has corrected it."""
    missed = fit.local.scatter if fit.local else surrogate_error(fit.problem, fit.explanation)
    return replace(fit.errors, model=fit.errors.model - fit.errors.surrogate + missed)


def sampled(
    log_probability: Callable[[np.ndarray], np.ndarray], start: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Return draws (m, k) from a density given by its logarithm at points (n, k), from walkers that `start` (n, k)."""
    moves = [(emcee.moves.DEMove(), 1.0 - LEAPS), (emcee.moves.DEMove(gamma0=1.0), LEAPS)]
    sampler = emcee.EnsembleSampler(*start.shape, log_probability, moves=moves, vectorize=True)
    sampler.random_state = np.random.RandomState(rng.integers(2**31)).get_state()
    sampler.run_mcmc(start, SETTLING + KEPT, skip_initial_state_check=True)
    return sampler.get_chain(discard=SETTLING, thin=THINNING, flat=True)
