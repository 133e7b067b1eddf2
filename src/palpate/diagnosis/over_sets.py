"""The material's parameters over all sets of mechanisms: what is known of them whichever of the library's effects act.

The interval of one explanation holds if that explanation is right. Others have a probability, too, and shift the
parameters: a tip that is a degree off changes a modulus by four per cent, and leaves no misfit by which to tell. So the
posterior over all sets is the mixture of theirs, each with its probability (J. A. Hoeting, D. Madigan, A. E. Raftery,
C. T. Volinsky, Statist. Sci. 14 (1999) 382).
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp

from palpate.diagnosis.coefficient_prior import neutral_place, with_coefficient
from palpate.diagnosis.explanations import Explanations, Members
from palpate.diagnosis.screen import Screen
from palpate.inference.explanation import PRIOR_VARIANCE, Fit
from palpate.inference.posterior import DRAWS, draws_to_first_order
from palpate.mechanisms import MECHANISMS
from palpate.models.coordinates import Coordinates

LIKELY = 0.2  # probability of a set from which on its posterior is more than one to first order, which costs seconds


def draws_over_sets(found: Explanations, screen: Screen, rng: np.random.Generator) -> np.ndarray:
    """Return draws (m, k) of the material's coordinates from the mixture of all sets.

    Sets that were estimated by an exchange of mechanisms lie beside fitted ones that hold most of the probability, and
    are left out.
    """
    parts = []
    for members, probability in found.probabilities().items():
        count = int(np.floor(probability * DRAWS + rng.random()))
        if not count or found.is_exchanged(members):
            continue
        draws, _ = draws_of(found, members, probability, screen, rng)
        places = rng.choice(len(draws), count, replace=count > len(draws))
        parts.append(draws[places, : found.fitted[frozenset()].fit.problem.material])
    return np.concatenate(parts)


def draws_of(
    found: Explanations, members: Members, probability: float, screen: Screen, rng: np.random.Generator
) -> tuple[np.ndarray, list[str]]:
    """Return draws (m, k) from the posterior of a set of a `probability`, and the names of its coordinates.

    A set that was not fitted counts to first order from the smaller set by which it was estimated.

    Parameters
    ----------
    found, members
        The sets that were fitted or estimated, and the mechanisms of this one.
    screen
        Effects of the mechanisms that were considered.
    rng
        Source of the draws.
    """
    if members in found.fitted:
        fit = found.fitted[members].fit
        draws = found.fitted[members].draws if probability >= LIKELY else draws_to_first_order(fit, rng)
        return draws, fit.coordinates.names
    smaller, _ = found.estimated[members]
    (key,), fit = members - smaller, found.fitted[smaller].fit
    further = with_coefficient(fit, key, screen.trials[key])
    drawn, ways = _with_prior(fit, screen, key, further, rng) if further else _joined(fit, screen, key, rng)
    joined = fit.coordinates.joined([MECHANISMS[key]], fit.problem.scale)
    k, start = len(fit.z), neutral_place(fit.problem, key)
    amplitudes = start + drawn[:, k:] * (screen.trials[key][ways] - start)
    draws = np.column_stack([drawn[:, :k], np.clip(amplitudes, *(ends[k:] for ends in joined.limits))])
    return draws, joined.names


def _joined(fit: Fit, screen: Screen, key: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return draws (m, k + 1) of the coordinates of a fit and the coefficient of an effect that joins, to first order.

    The effects that were screened are taken in proportion to a coefficient, as for the evidence, at the likeliest size
    of the law's discrepancy. The number of the effect comes with each draw (m,).
    """
    posteriors = []
    for number, variances in enumerate(screen.prior_variances(fit, key)):
        for weight, variance in variances:
            best, covariance = fit.joined(screen.effects[key][number], variance)
            gain = best @ np.linalg.solve(covariance, best)
            evidence = 0.5 * (gain + np.linalg.slogdet(covariance)[1] - np.log(variance))
            posteriors.append((weight + evidence, best, covariance, number))
    weights = np.array([weight for weight, *_ in posteriors])
    counts = rng.multinomial(DRAWS, np.exp(weights - logsumexp(weights)))
    numbers = np.repeat([number for *_, number in posteriors], counts)
    drawn = [
        rng.multivariate_normal(best, covariance, size=count, method="svd")
        for count, (_, best, covariance, _) in zip(counts, posteriors, strict=True)
        if count
    ]
    return np.append(fit.z, 0.0) + np.concatenate(drawn), numbers


def _with_prior(
    fit: Fit, screen: Screen, key: str, further: tuple[Coordinates, int], rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same where an earlier study gives the prior, see `palpate.diagnosis.coefficient_prior`."""
    coordinates, number = further
    variances = coordinates.even_variances(PRIOR_VARIANCE)
    found = fit.marginal(np.column_stack([fit.residual, fit.tangent, screen.effects[key][number]]), coordinates)
    likeliest = found.products[int(np.argmax(found.log_prior + found.log_densities(variances)))]
    covariance = np.linalg.inv(likeliest[1:, 1:] + np.diag(1.0 / variances))
    best = np.append(fit.z, 0.0) + covariance @ likeliest[1:, 0]
    return rng.multivariate_normal(best, covariance, size=DRAWS, method="svd"), np.full(DRAWS, number)
