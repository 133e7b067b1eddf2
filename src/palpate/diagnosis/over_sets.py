"""The material's parameters over all sets of mechanisms: what is known of them whichever of the library's effects act.

The interval of one explanation holds if that explanation is right. Others have a probability, too, and shift the
parameters: a tip that is a degree off changes a modulus by four per cent, and leaves no misfit by which to tell. So the
posterior over all sets is the mixture of theirs, each with its probability (J. A. Hoeting, D. Madigan, A. E. Raftery,
C. T. Volinsky, Statist. Sci. 14 (1999) 382).
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp

from palpate.diagnosis.explanations import Explanations
from palpate.diagnosis.screen import Screen
from palpate.diagnosis.search import Candidate
from palpate.inference.explanation import Fit
from palpate.inference.posterior import DRAWS, draws_to_first_order

LIKELY = 0.2  # probability of a set from which on its posterior is more than one to first order, which costs seconds


def draws_over_sets(found: Explanations, screen: Screen, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the material's coordinates from the mixture of all sets.

    Sets that were not fitted count to first order from the smaller set by which they were estimated. Those that were
    estimated by an exchange of mechanisms lie beside fitted ones that hold most of the probability, and are left out.
    """
    parts = []
    for members, probability in found.probabilities().items():
        count = int(np.floor(probability * DRAWS + rng.random()))
        if not count or found.is_exchanged(members):
            continue
        if members in found.fitted:
            draws = draws_of(found.fitted[members], probability, rng)
        else:
            smaller, _ = found.estimated[members]
            (key,) = members - smaller
            draws = _joined(found.fitted[smaller].fit, screen, key, rng)
        places = rng.choice(len(draws), count, replace=count > len(draws))
        parts.append(draws[places, : found.fitted[frozenset()].fit.problem.material])
    return np.concatenate(parts)


def draws_of(candidate: Candidate, probability: float, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) from the posterior of a set of this probability; to first order where it is unlikely."""
    return candidate.draws if probability >= LIKELY else draws_to_first_order(candidate.fit, rng)


def _joined(fit: Fit, screen: Screen, key: str, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the coordinates of a fit that a mechanism joins, to first order.

    The effects that were screened are taken in proportion to a coefficient, as for the evidence, at the likeliest size
    of the law's discrepancy.
    """
    posteriors = []
    for effect, variances in zip(screen.effects[key], screen.prior_variances(fit, key), strict=True):
        for weight, variance in variances:
            best, covariance = fit.joined(effect, variance)
            gain = best @ np.linalg.solve(covariance, best)
            evidence = 0.5 * (gain + np.linalg.slogdet(covariance)[1] - np.log(variance))
            posteriors.append((weight + evidence, best, covariance))
    weights = np.array([weight for weight, _, _ in posteriors])
    counts = rng.multinomial(DRAWS, np.exp(weights - logsumexp(weights)))
    drawn = [
        rng.multivariate_normal(best, covariance, size=count, method="svd")
        for count, (_, best, covariance) in zip(counts, posteriors, strict=True)
        if count
    ]
    return fit.z + np.concatenate(drawn)[:, : len(fit.z)]
