r"""Least squares on a forward model with derivatives: Levenberg and Marquardt's method, several steps at a time.

About the coordinates u with the weighted residual r and its derivatives J, steps of several lengths are tried at once,

    (J^T J + m I) s = -J^T r,    each with the damping m that keeps max |s| to its length,

and the best is taken (K. Levenberg, Quart. Appl. Math. 2 (1944) 164-168; D. Marquardt, J. SIAM 11 (1963) 431-441).
Simulations in parallel lanes cost hardly more for several steps than for one. For each length there is also a step with
the second-order correction from the curvature along the last step (geodesic acceleration; Transtrum & Sethna,
arXiv:1207.4999), because the valleys of chi^2 are curved. Exact derivatives cost more than several curves: after a step
that lowers chi^2 by at least the part `LINEAR_ENOUGH` of the predicted decrease they are updated by its secant (C.G.
Broyden, Math. Comp. 19 (1965) 577-593), else computed anew. A search has converged when the predicted decrease of every
step is below the tolerance, or none of those tried exceeds it. Several searches advance together; one that falls behind
is given up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.errors import PalpateError
from palpate.inference.forward import Curves, Forward
from palpate.inference.least_squares import Misfit

LARGEST_STEP, SHORTEST_STEP = 1.0, 1e-3  # of the range of a parameter
GROWTH = 2.0  # of the length of the next steps over that of the last
LEAST_STEPS = 2  # tried at once by each search
BENDINGS = 3  # times that a bent step is found from the last one
LINEAR_ENOUGH = 0.6  # ratio of actual to predicted decrease of chi^2 above which the secant update suffices
PATIENCE, BEHIND = 3, 1.5  # iterations after which a search is given up whose residual is so many times the best
FALLING, LONGER = 0.9, 3  # a search lasts so many times longer while `PATIENCE` iterations lower the residual so far


@dataclass(eq=False)
class Descent:
    """One search.

    Attributes
    ----------
    u : ndarray, shape (k,)
        Where it is.
    curves, slopes
        Of each condition there, in the unit of the response, and their derivatives by the coordinates.
    exact
        Whether the slopes are the model's derivatives there, and not updated by secants.
    last
        The last step (k,) that was tried, and the departure of the curves there from their linear prediction; None
        before.
    length
        Length of the longest step that it tries next.
    converged
        Whether its predicted or actual decrease of chi^2 has fallen below the tolerance.
    path
        Where it was before (k,).
    active
        Whether it goes on.
    """

    u: np.ndarray
    curves: Curves
    slopes: Curves
    exact: bool = True
    last: tuple[np.ndarray, Curves] | None = None
    length: float = LARGEST_STEP
    converged: bool = False
    active: bool = True
    path: list[np.ndarray] = field(default_factory=list)

    def departed(self, u: np.ndarray, curves: Curves) -> tuple[np.ndarray, Curves]:
        """Return the step to coordinates u (k,), and the departure of the curves there from their linear prediction."""
        step = u - self.u
        return step, {name: curves[name] - self.curves[name] - slopes @ step for name, slopes in self.slopes.items()}

    def move(self, u: np.ndarray, curves: Curves) -> None:
        """Take a step to coordinates u (k,) with these curves, and correct the slopes by its secant."""
        step, departure = self.departed(u, curves)
        self.slopes = {n: slopes + np.outer(departure[n], step) / (step @ step) for n, slopes in self.slopes.items()}
        self.path.append(self.u)
        self.u, self.curves, self.exact = u, curves, False


def descend(
    misfit: Misfit,
    model: Forward,
    starts: Sequence[np.ndarray | Descent],
    iterations: int,
    tolerance: float,
    exact: bool = True,
) -> Descent:
    """Return the search that ends at the least misfit.

    Parameters
    ----------
    misfit
        The least-squares problem.
    model
        Gives curves and derivatives.
    starts
        Coordinates (k,), or searches that have ended.
    iterations
        Largest number of iterations, but for those that lower the residual by much (`FALLING`).
    tolerance
        Change of chi^2 below which a search has converged.
    exact
        Whether it converges only with exact derivatives.

    Raises
    ------
    PalpateError
        When the model fails at all starts.
    """
    searches = [replace(s, length=LARGEST_STEP, converged=False, active=True) for s in starts if isinstance(s, Descent)]
    points = [_inside(misfit, start) for start in starts if not isinstance(start, Descent)]
    outcomes = model.tangents(points) if points else []
    searches += [Descent(u, *found) for u, found in zip(points, outcomes, strict=True) if not isinstance(found, str)]
    if not searches:
        raise PalpateError(str(outcomes[0]))
    least = [np.inf]
    for iteration in range(LONGER * iterations):
        going = [search for search in searches if search.active]
        if not going or (iteration >= iterations and least[-1] > FALLING * least[-1 - PATIENCE]):
            break
        _advance(misfit, model, going, tolerance, exact)
        rms = {search: float(np.sqrt(np.mean(misfit.residual(search.curves) ** 2))) for search in searches}
        least.append(min(rms.values()))
        for search in searches:
            search.active &= iteration < PATIENCE or rms[search] <= BEHIND * least[-1]
    weights = misfit.weights(min(misfit.discrepancy(misfit.residual(search.curves)) for search in searches))
    return min(searches, key=lambda search: misfit.chi_square(search.curves, search.u, weights))


def resumed(misfit: Misfit, model: Forward, way: Descent, iterations: int, tolerance: float) -> Descent:
    """Continue a search with another model from its end, or from the last place where that model does not fail.

    At its end it goes on with the derivatives of the model before; it may converge with derivatives that are not exact.

    Parameters
    ----------
    way
        The search that ended.
    misfit, model, iterations, tolerance
        See `descend`, as the errors that are raised.
    """
    (outcome,) = model.curves([way.u])
    if not isinstance(outcome, str):
        return descend(misfit, model, [replace(way, curves=outcome, exact=False)], iterations, tolerance, exact=False)
    failed = outcome
    for start in reversed(way.path):
        try:
            return descend(misfit, model, [start], iterations, tolerance, exact=False)
        except PalpateError as error:
            failed = str(error)
    raise PalpateError(failed)


def _advance(misfit: Misfit, model: Forward, searches: Sequence[Descent], tolerance: float, exact: bool) -> None:
    """Move all searches by one iteration."""
    count = max(LEAST_STEPS, model.together(searches[0].u) // len(searches))
    tried: list[tuple[Descent, np.ndarray, float]] = []
    ways: dict[Descent, Steps] = {}
    outdated: list[Descent] = []
    for search in searches:
        steps = Steps.of(misfit, search)
        if steps.predicted_decrease(steps.end(LARGEST_STEP)) < tolerance:
            if exact and not search.exact:
                outdated.append(search)
            else:
                search.converged, search.active = True, False
            continue
        ways[search] = steps
        tried += [(search, *trial) for trial in steps.trials(search, count)]
    outcomes = model.curves([u for _, u, _ in tried]) if tried else []
    for search, steps in ways.items():
        here = best = misfit.chi_square(search.curves, search.u, steps.weights)
        chosen: tuple[np.ndarray, Curves, float] | None = None
        for (owner, u, length), curves in zip(tried, outcomes, strict=True):
            if owner is search and not isinstance(curves, str):
                search.last = search.last if chosen else search.departed(u, curves)
                value = misfit.chi_square(curves, u, steps.weights)
                if value < best:
                    best, chosen = value, (u, curves, length)
        if chosen is None:
            search.length *= 0.5**count
            search.active = search.length >= SHORTEST_STEP or not search.exact
            if not search.exact:
                outdated.append(search)
            continue
        u, curves, length = chosen
        search.length = min(GROWTH * length, LARGEST_STEP)
        straight = here - best >= LINEAR_ENOUGH * steps.predicted_decrease(u)
        search.move(u, curves)
        search.converged = here - best < tolerance and (straight or not exact)
        search.active = not search.converged
        if not (straight or search.converged):
            outdated.append(search)
    _renew(model, outdated)


def _renew(model: Forward, searches: Sequence[Descent]) -> None:
    """Compute the exact derivatives at the searches' places; where the model fails, a search keeps those it has."""
    outcomes = model.tangents([search.u for search in searches]) if searches else []
    for search, found in zip(searches, outcomes, strict=True):
        search.exact = True
        if isinstance(found, str):
            search.length *= 0.5
            search.active = search.length >= SHORTEST_STEP
        else:
            search.curves, search.slopes = found


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps of several lengths from one place.

    Parameters
    ----------
    misfit
    u : ndarray, shape (k,)
    weights : ndarray, shape (n, n)
        Matrix that whitens curves.
    residual, slopes : ndarray, shape (n + k + m,) and (n + k + m, k)
        Weighted; they include those of the prior and of independent measurements.
    """

    misfit: Misfit
    u: np.ndarray
    weights: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray

    @classmethod
    def of(cls, misfit: Misfit, search: Descent) -> Steps:
        """Return the steps from where a search is."""
        weights = misfit.weights(misfit.discrepancy(misfit.residual(search.curves)))
        residual = np.append(weights @ misfit.residual(search.curves), misfit.of_parameters(search.u))
        slopes = np.vstack([weights @ misfit.stacked(search.slopes), misfit.slopes_of_parameters(search.u)])
        return cls(misfit, search.u, weights, residual, slopes)

    def trials(self, search: Descent, count: int) -> list[tuple[np.ndarray, float]]:
        """Return `count` places (k,) to try, and the lengths of the steps there.

        For each length a linear step, and one with the second-order correction from the last step.
        """
        lengths = search.length * 0.5 ** np.arange(count if search.last is None else -(-count // 2))
        places = [(self.end(length), length) for length in lengths]
        if search.last is None:
            return places
        step, departure = search.last
        weighed = self.weights @ self.misfit.stacked(departure)
        bent = np.append(weighed, np.zeros(len(self.residual) - len(weighed))) / (step @ step) ** 2
        return [p for end, length in places for p in ((end, length), (self._followed(bent, step, end, length), length))]

    def _followed(self, bent: np.ndarray, step: np.ndarray, end: np.ndarray, length: float) -> np.ndarray:
        """Correct a step to `end` by a departure of the curves quadratic in its component along the last `step`."""
        for _ in range(BENDINGS):
            end = self.end(length, (step @ (end - self.u)) ** 2 * bent)
        return end

    def end(self, length: float, departure: np.ndarray | float = 0.0) -> np.ndarray:
        """Return the coordinates (k,) at the end of the step of this length, within the limits.

        Parameters
        ----------
        departure : ndarray, shape (n + k + m,)
            Of the weighted curves there from their linear prediction.
        """
        least, largest = self.misfit.coordinates.limits
        free = np.ones(len(self.u), dtype=bool)
        while True:
            step = np.zeros(len(self.u))
            step[free] = _limited(self.slopes[:, free], self.residual + departure, length)
            held = free & (((self.u <= least) & (step < 0.0)) | ((self.u >= largest) & (step > 0.0)))
            if not held.any():
                return np.clip(self.u + step, least, largest)
            free &= ~held
            if not free.any():
                return self.u

    def predicted_decrease(self, end: np.ndarray) -> float:
        """Return the decrease of chi^2 that the linear model predicts for a step to coordinates (k,)."""
        left = self.residual + self.slopes @ (end - self.u)
        return float(self.residual @ self.residual - left @ left)


def _limited(slopes: np.ndarray, residual: np.ndarray, length: float) -> np.ndarray:
    """Return the damped step (k,) none of whose components exceeds the length."""
    values, directions = np.linalg.eigh(slopes.T @ slopes)
    pull, largest = directions.T @ (-slopes.T @ residual), max(float(values[-1]), 1e-300)

    def step(damping: float) -> np.ndarray:
        return directions @ (pull / (np.maximum(values, 0.0) + damping))

    low, high = 1e-10 * largest, 1e10 * largest
    if np.abs(step(low)).max() <= length:
        return step(low)
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if np.abs(step(middle)).max() > length else (low, middle)
    return step(high)


def _inside(misfit: Misfit, u: np.ndarray) -> np.ndarray:
    """Return coordinates (k,) a little within the limits."""
    least, largest = misfit.coordinates.limits
    return np.clip(u, least + 1e-6, largest - 1e-6)
