r"""Least squares on a forward model with derivatives: Levenberg and Marquardt's method, several steps at a time.

About the coordinates u with the weighted residual r and its derivatives J, steps of several lengths are tried at once,

    (J^T J + m I) s = -J^T r,    each with the damping m that keeps max |s| to its length,

and the best is taken (K. Levenberg, Quart. Appl. Math. 2 (1944) 164-168; D. Marquardt, J. SIAM 11 (1963) 431-441).
Simulations in parallel lanes cost hardly more for several steps than for one. From the second iteration on, each has
the second-order correction from the curvature along the last step (geodesic acceleration; Transtrum & Sethna,
arXiv:1207.4999), because the valleys of chi^2 are curved. Exact derivatives cost more than several curves: after a step
that lowers chi^2 by at least the part `LINEAR_ENOUGH` of the predicted decrease they are updated by its secant (C.G.
Broyden, Math. Comp. 19 (1965) 577-593), and the next steps may be longer; else they are computed anew. So they are
where short steps go on as predicted while a whole step promises far more (`SLOW`): a few secants have spoilt the slopes
along the valley. A search has converged when the predicted decrease of every step is below the tolerance, or none of
those tried exceeds it and a whole step promises little more. Several searches advance together; one that falls behind
is given up, and so is one that, after two iterations and by the known errors, several whole steps would not bring to
what it must reach. One that gains hardly anything in `STALLED` iterations, whatever its slopes predict, ends without
having converged: derivatives mislead where a parameter has no effect or a curve has a kink.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import CancelledError
from dataclasses import replace

import numpy as np

from palpate.data.measures import root_mean_square
from palpate.errors import PalpateError
from palpate.inference.least_squares import Misfit
from palpate.inference.search_state import LARGEST_STEP, SearchState, Steps, StoppingCriteria
from palpate.models.forward import Forward

SHORTEST_STEP = 1e-3  # of the range of a parameter
GROWTH = 4.0  # of the next steps' length over one that the slopes predicted well, which is still among those tried
LEAST_STEPS = 2  # tried at once by each search
LINEAR_ENOUGH = 0.6  # ratio of actual to predicted decrease of chi^2 above which the secant update suffices
SLOW = 0.1  # part of the decrease that a whole step promises, below which slopes that are not exact are not trusted
STALLED = 4  # iterations that together must lower chi^2 by a little, or else a search ends
PATIENCE, BEHIND = 3, 1.5  # iterations after which a search is given up whose residual is so many times the best
GENEROUS = 4.0  # times the decrease that a whole step promises, beyond which a search is not expected to come
FALLING, LONGER = 0.9, 3  # a search lasts so many times longer while `PATIENCE` iterations lower the residual so far


def descend(
    misfit: Misfit, model: Forward, starts: Sequence[np.ndarray | SearchState], until: StoppingCriteria
) -> SearchState:
    """Return the search that ends at the least misfit.

    Parameters
    ----------
    misfit
        The least-squares problem.
    model
        Gives curves and derivatives.
    starts
        Coordinates (k,), or searches that have ended.
    until
        When they end.

    Raises
    ------
    PalpateError
        When the model fails at all starts.
    CancelledError
        When the search was stopped.
    """
    begun = [start for start in starts if isinstance(start, SearchState)]
    searches = [search.anew() for search in begun]
    _check(until)
    points = [_inside(misfit, start) for start in starts if not isinstance(start, SearchState)]
    outcomes = misfit.tangents(model, points) if points else []
    searches += [
        SearchState(u, *found) for u, found in zip(points, outcomes, strict=True) if not isinstance(found, str)
    ]
    if not searches:
        raise PalpateError(str(outcomes[0]))
    least = [np.inf]
    for iteration in range(LONGER * until.iterations):
        going = [search for search in searches if search.active]
        if not going or (iteration >= until.iterations and least[-1] > FALLING * least[-1 - PATIENCE]):
            break
        _check(until)
        if iteration and until.reach < np.inf:
            for search in going:
                search.hopeless = search.hopeless + 1 if _hopeless(misfit, search, until.reach) else 0
                search.active = not search.given_up
        _advance(misfit, model, [search for search in going if search.active], until)
        rms = {search: root_mean_square(misfit.residual(search.curve)) for search in searches}
        least.append(min(rms.values()))
        for search in searches:
            stalled = len(search.gains) >= STALLED and sum(search.gains[-STALLED:]) < until.least_gain
            search.active &= not stalled and (iteration < PATIENCE or rms[search] <= BEHIND * least[-1])
    weights = misfit.weights(min(misfit.remainder(misfit.residual(search.curve)) for search in searches))
    return min(searches, key=lambda search: misfit.chi_square(search.curve, search.u, weights))


def continued(misfit: Misfit, model: Forward, state: SearchState, until: StoppingCriteria) -> SearchState:
    """Continue a search with another model from its end, or from the last place where that model does not fail.

    At its end it goes on with the derivatives of the model before.

    Parameters
    ----------
    state
        The search that ended.
    misfit, model, until
        See `descend`, as the errors that are raised.
    """
    (outcome,) = misfit.curves(model, [state.u])
    if not isinstance(outcome, str):
        return descend(misfit, model, [replace(state, curve=outcome, exact=False)], until)
    failed = outcome
    for start in reversed(state.path):
        try:
            return descend(misfit, model, [start], until)
        except PalpateError as error:
            failed = str(error)
    raise PalpateError(failed)


def gauss_newton(
    misfit: Misfit, model: Forward, state: SearchState, most: int, tolerance: float, first_order: float
) -> SearchState:
    """Take Gauss-Newton steps, with secant updates of the slopes, as long as they lower chi-square on finer meshes.

    Parameters
    ----------
    misfit, tolerance
        See `descend`.
    model
        Gives the curves.
    state
        Where the search begins, with its curves and slopes.
    most
        Largest number of steps.
    first_order
        Predicted decrease of chi-square below which the last step is taken with the slopes, without a simulation.
    """
    for _ in range(most):
        steps = Steps.of(misfit, state)
        end = steps.end(LARGEST_STEP)
        predicted = steps.predicted_decrease(end)
        if predicted < first_order:
            state.converged = True
            if predicted >= tolerance:
                state.move(end, state.predicted(end))
            break
        (curve,), here = misfit.curves(model, [end]), misfit.chi_square(state.curve, state.u, steps.weights)
        if isinstance(curve, str) or misfit.chi_square(curve, end, steps.weights) > here:
            break
        state.move(end, curve)
    return state


def _check(until: StoppingCriteria) -> None:
    """Raise `CancelledError` once a search is to end; as no `PalpateError`, it is not taken for a failure."""
    if until.stop and until.stop.is_set():
        raise CancelledError


def _hopeless(misfit: Misfit, search: SearchState, reach: float) -> bool:
    """Return whether a search is not expected to reach a chi-square by the known errors, see `GENEROUS`."""
    steps = Steps.of(misfit, search, remainder=0.0)
    promised = steps.predicted_decrease(steps.end(LARGEST_STEP))
    return float(steps.residual @ steps.residual) - GENEROUS * promised > reach


def _advance(misfit: Misfit, model: Forward, searches: Sequence[SearchState], until: StoppingCriteria) -> None:
    """Move all searches by one iteration."""
    if not searches:
        return
    count = max(LEAST_STEPS, model.points_per_batch(searches[0].u) // len(searches))
    longer = min(GROWTH, 2.0 ** (count - 1))
    tried: list[tuple[SearchState, np.ndarray, float]] = []
    ways: dict[SearchState, Steps] = {}
    promised: dict[SearchState, float] = {}
    outdated: list[SearchState] = []
    for search in searches:
        steps = Steps.of(misfit, search)
        promised[search] = steps.predicted_decrease(steps.end(LARGEST_STEP))
        if promised[search] < until.tolerance:
            if until.exact and not search.exact:
                outdated.append(search)
            else:
                search.converged, search.active = True, False
            continue
        ways[search] = steps
        tried += [(search, *trial) for trial in steps.trials(search, count)]
    outcomes = misfit.curves(model, [u for _, u, _ in tried]) if tried else []
    for search, steps in ways.items():
        here = best = misfit.chi_square(search.curve, search.u, steps.weights)
        chosen: tuple[np.ndarray, np.ndarray, float] | None = None
        for (owner, u, length), curve in zip(tried, outcomes, strict=True):
            if owner is search and not isinstance(curve, str):
                search.last = search.last if chosen else search.departed(u, curve)
                value = misfit.chi_square(curve, u, steps.weights)
                if value < best:
                    best, chosen = value, (u, curve, length)
        search.gains.append(here - best)
        if chosen is None:
            search.length *= 0.5**count
            search.active = search.length >= SHORTEST_STEP or not search.exact
            if not search.exact:
                outdated.append(search)
            continue
        u, curve, length = chosen
        straight = here - best >= LINEAR_ENOUGH * steps.predicted_decrease(u)
        slow = not search.exact and here - best < SLOW * promised[search]
        search.length = min(longer * length if straight else length, LARGEST_STEP)
        search.move(u, curve)
        little = max(here - best, SLOW * promised[search]) < until.tolerance
        search.converged = little and (straight or not until.exact)
        search.active = not search.converged
        if not search.converged and (slow or not straight):
            outdated.append(search)
    _renew(misfit, model, outdated)


def _renew(misfit: Misfit, model: Forward, searches: Sequence[SearchState]) -> None:
    """Compute the exact derivatives at the searches' places; where the model fails, a search keeps those it has."""
    outcomes = misfit.tangents(model, [search.u for search in searches]) if searches else []
    for search, found in zip(searches, outcomes, strict=True):
        search.exact = True
        if isinstance(found, str):
            search.length *= 0.5
            search.active = search.length >= SHORTEST_STEP
        else:
            search.curve, search.tangent = found


def _inside(misfit: Misfit, u: np.ndarray) -> np.ndarray:
    """Return coordinates (k,) a little within the limits."""
    least, largest = misfit.coordinates.limits
    return np.clip(u, least + 1e-6, largest - 1e-6)
