r"""Least squares on a forward model with exact derivatives: Levenberg and Marquardt's method, several steps at a time.

About the coordinates u with the residual r and its derivatives J, weighed, steps of several lengths are tried at once,

    (J^T J + m I) s = -J^T r,    each with the damping m that keeps max |s| to its length,

and the best is taken (K. Levenberg, Quart. Appl. Math. 2 (1944) 164-168; D. Marquardt, J. SIAM 11 (1963) 431-441).
Simulations that run in lanes cost hardly more for several steps than for one. A search has settled when no step
promises to lower chi^2 by more than `SETTLED`, or none of those tried does. Several searches advance together; one that
falls behind is given up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import PalpateError
from palpate.inference.forward import Curves, Forward
from palpate.inference.least_squares import Misfit

LARGEST_STEP, SHORTEST_STEP = 1.0, 1e-3  # of the range of a parameter
GROWTH = 4.0  # of the length of the next steps over that of the last
STEPS = 8  # tried at once, shared out among searches and conditions
LEAST_STEPS = 3
SETTLED = 0.02  # of chi^2; 0.14 standard deviations of the estimate in all
PATIENCE, BEHIND = 3, 1.5  # iterations after which a search is given up whose residual is so many times the best


@dataclass(eq=False)
class Descent:
    """One search.

    Attributes
    ----------
    u : ndarray, shape (k,)
        Where it is.
    curves, slopes
        Of each condition there, in the unit of what answers, by coordinates.
    length
        Of the longest step that it tries next.
    settled
        Whether it arrived.
    active
        Whether it goes on.
    """

    u: np.ndarray
    curves: Curves
    slopes: Curves
    length: float = LARGEST_STEP
    settled: bool = False
    active: bool = True


def descend(
    misfit: Misfit,
    model: Forward,
    starts: Sequence[np.ndarray],
    iterations: int,
    report: Callable[[str], None] = lambda line: None,
) -> Descent:
    """Return the search that ends at the least misfit.

    Parameters
    ----------
    starts
        Coordinates (k,).
    iterations
        Largest number of iterations.

    Raises
    ------
    PalpateError
        When the model fails at all starts.
    """
    points = [_inside(misfit, start) for start in starts]
    outcomes = model.tangents(points)
    searches = [Descent(u, *found) for u, found in zip(points, outcomes, strict=True) if not isinstance(found, str)]
    if not searches:
        raise PalpateError(str(outcomes[0]))
    for iteration in range(iterations):
        going = [search for search in searches if search.active]
        if not going:
            break
        _advance(misfit, model, going)
        rms = {search: float(np.sqrt(np.mean(misfit.residual(search.curves) ** 2))) for search in searches}
        least = min(rms.values())
        report(f"iteration {iteration + 1}: residual {least:.4g} nm")
        for search in searches:
            search.active &= iteration < PATIENCE or rms[search] <= BEHIND * least
    weights = misfit.weights(min(misfit.discrepancy(misfit.residual(search.curves)) for search in searches))
    return min(searches, key=lambda search: misfit.chi_square(search.curves, search.u, weights))


def _advance(misfit: Misfit, model: Forward, searches: Sequence[Descent]) -> None:
    """Move all searches by one iteration."""
    count = max(LEAST_STEPS, STEPS // (len(searches) * len(misfit.measured)))
    tried: list[tuple[Descent, np.ndarray, float]] = []
    weighing: dict[Descent, np.ndarray] = {}
    for search in searches:
        weights = misfit.weights(misfit.discrepancy(misfit.residual(search.curves)))
        steps = Steps.of(misfit, search, weights)
        if steps.promise(LARGEST_STEP) < SETTLED:
            search.settled, search.active = True, False
            continue
        weighing[search] = weights
        tried += [(search, steps.end(length), length) for length in search.length * 0.5 ** np.arange(count)]
    if not tried:
        return
    outcomes = model.curves([u for _, u, _ in tried])
    moved = []
    for search, weights in weighing.items():
        here = best = misfit.chi_square(search.curves, search.u, weights)
        place, chosen = None, 0.0
        for (owner, u, length), curves in zip(tried, outcomes, strict=True):
            if owner is search and not isinstance(curves, str):
                value = misfit.chi_square(curves, u, weights)
                if value < best:
                    best, place, chosen = value, u, length
        if place is None:
            search.length *= 0.5**count
            search.active = search.length >= SHORTEST_STEP
        else:
            moved.append((search, place, chosen, here - best))
    tangents = model.tangents([u for _, u, _, _ in moved]) if moved else []
    for (search, u, chosen, gain), found in zip(moved, tangents, strict=True):
        if isinstance(found, str):
            search.length = 0.5 * chosen  # the step itself would be found best again
            search.active = search.length >= SHORTEST_STEP
        else:
            search.u, (search.curves, search.slopes) = u, found
            search.length = min(GROWTH * chosen, LARGEST_STEP)
            search.settled = gain < SETTLED
            search.active = not search.settled


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps of several lengths from one place.

    Parameters
    ----------
    misfit
    u : ndarray, shape (k,)
    residual, slopes : ndarray, shape (n + k,) and (n + k, k)
        Weighed, those of the prior among them.
    """

    misfit: Misfit
    u: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray

    @classmethod
    def of(cls, misfit: Misfit, search: Descent, weights: np.ndarray) -> Steps:
        """Return the steps from where a search is."""
        beyond = misfit.coordinates.beyond(search.u)
        residual = np.append(weights @ misfit.residual(search.curves), beyond)
        slopes = np.vstack([weights @ misfit.stacked(search.slopes), np.diag(1.0 * (beyond != 0.0))])
        return cls(misfit, search.u, residual, slopes)

    def end(self, length: float) -> np.ndarray:
        """Return the coordinates (k,) at the end of the step of this length, within the walls."""
        least, largest = self.misfit.coordinates.walls
        free = np.ones(len(self.u), dtype=bool)
        while True:
            step = np.zeros(len(self.u))
            step[free] = _limited(self.slopes[:, free], self.residual, length)
            held = free & (((self.u <= least) & (step < 0.0)) | ((self.u >= largest) & (step > 0.0)))
            if not held.any():
                return np.clip(self.u + step, least, largest)
            free &= ~held
            if not free.any():
                return self.u

    def promise(self, length: float) -> float:
        """Return by how much the step of this length should lower chi^2."""
        left = self.residual + self.slopes @ (self.end(length) - self.u)
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
    """Return coordinates (k,) a little within the walls."""
    least, largest = misfit.coordinates.walls
    return np.clip(u, least + 1e-6, largest - 1e-6)
