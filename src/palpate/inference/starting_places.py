"""Where the fit of a base model may begin: scattered over the ranges, and where searches with few samples lead."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.stats import qmc

from palpate.inference.fit_policy import FitPolicy
from palpate.inference.least_squares import Misfit, by_misfit
from palpate.inference.search_state import SearchState, StoppingCriteria
from palpate.inference.trust_region import descend
from palpate.models.forward import Forward


def scattered(number: int, policy: FitPolicy, rng: np.random.Generator) -> list[np.ndarray]:
    """Return places (k,) of the ranges of a `number` of coordinates at which a search may begin."""
    return list(qmc.Sobol(number, seed=rng).random(policy.scattered))


def places(misfit: Misfit, cheaper: Forward, starts: Sequence[np.ndarray], policy: FitPolicy) -> Iterator[np.ndarray]:
    """Yield coordinates (k,) at which to begin with the model of record, that of least expected misfit first.

    Parameters
    ----------
    misfit, cheaper
        Of curves with few samples, and the model that gives them.
    starts
        Coordinates (k,) from which searches with it go on; a single one is taken as it is first.
    policy
        How many searches, and how far they go.
    """
    if len(starts) == 1:
        yield starts[0]
    way = _followed(misfit, cheaper, starts, policy)
    yield from (way.u, *reversed(way.path), *starts)


def _followed(misfit: Misfit, cheaper: Forward, starts: Sequence[np.ndarray], policy: FitPolicy) -> SearchState:
    """Return where searches with few samples lead from the best of some coordinates (k,)."""
    best = [u for _, u in by_misfit(misfit, np.eye(len(misfit.measured)), cheaper, starts)][: policy.base_searches]
    return descend(misfit, cheaper, best, StoppingCriteria(policy.base_iterations, policy.first_tolerance))
