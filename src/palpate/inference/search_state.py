"""One search for the least misfit: its state, when it ends, and the damped steps from where it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from threading import Event

import numpy as np

from palpate.inference.least_squares import Misfit

LARGEST_STEP = 1.0  # of the range of a parameter
SHORTEST_SECANT = 1e-4  # of the range; over shorter steps curves of bodies that almost yield change less than they err
CORRECTIONS = 3  # fixed-point iterations of the second-order correction


@dataclass(frozen=True, eq=False)
class StoppingCriteria:
    """When a search ends.

    Parameters
    ----------
    iterations
        After how many at most, but for those that lower the residual by much.
    tolerance
        Change of chi^2 below which it has converged.
    exact
        Whether it converges only with exact derivatives.
    stop
        Ends it once it is set.
    reach
        Chi-square by the known errors alone which it must be able to reach, or else is given up.
    least_gain
        Decrease of chi^2 in some iterations together, below which it has stalled.
    """

    iterations: int
    tolerance: float
    exact: bool = False
    stop: Event | None = None
    reach: float = np.inf
    least_gain: float = 0.0


@dataclass(eq=False)
class SearchState:
    """One search.

    Attributes
    ----------
    u : ndarray, shape (k,)
        Where it is.
    curve, tangent : ndarray, shape (n,) and (n, k)
        Of all conditions there [nm], and its derivatives by the coordinates.
    exact
        Whether the tangent is the model's there, and not updated by secants.
    last
        The last step (k,) that was tried, and the departure (n,) of the curve there from its linear prediction; None
        before.
    length
        Length of the longest step that it tries next.
    converged
        Whether its predicted or actual decrease of chi^2 has fallen below the tolerance.
    path
        Where it was before (k,).
    active
        Whether it goes on.
    hopeless
        After how many iterations in a row it seemed that it would not reach what it must.
    gains
        By how much each iteration lowered chi^2.
    """

    u: np.ndarray
    curve: np.ndarray
    tangent: np.ndarray
    exact: bool = True
    last: tuple[np.ndarray, np.ndarray] | None = None
    length: float = LARGEST_STEP
    converged: bool = False
    active: bool = True
    hopeless: int = 0
    path: list[np.ndarray] = field(default_factory=list)
    gains: list[float] = field(default_factory=list)

    @property
    def given_up(self) -> bool:
        """Whether it ended because it would not reach what it must; one iteration may mislead, as at a kink."""
        return self.hopeless > 1

    def anew(self) -> SearchState:
        """Return the search as it begins again where it ended."""
        return replace(self, length=LARGEST_STEP, converged=False, active=True, hopeless=0, gains=[])

    def predicted(self, u: np.ndarray) -> np.ndarray:
        """Return the curve (n,) at coordinates u (k,) to first order."""
        return self.curve + self.tangent @ (u - self.u)

    def departed(self, u: np.ndarray, curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the step to coordinates u (k,), and the departure (n,) of the curve there from its prediction."""
        return u - self.u, curve - self.predicted(u)

    def move(self, u: np.ndarray, curve: np.ndarray) -> None:
        """Take a step to coordinates u (k,) with this curve (n,), and correct the tangent by its secant."""
        step, departure = self.departed(u, curve)
        if step @ step > SHORTEST_SECANT**2:
            self.tangent = self.tangent + np.outer(departure, step) / (step @ step)
        self.path.append(self.u)
        self.u, self.curve, self.exact = u, curve, False


@dataclass(frozen=True, eq=False)
class Steps:
    """Damped steps of several lengths from one place, linear or with a second-order correction.

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
    def of(cls, misfit: Misfit, search: SearchState, remainder: float | None = None) -> Steps:
        """Return the steps from where a search is, weighted with a remainder [nm^2]; by default with that there."""
        if remainder is None:
            remainder = misfit.remainder(misfit.residual(search.curve))
        weights = misfit.weights(remainder)
        residual = np.append(weights @ misfit.residual(search.curve), misfit.of_parameters(search.u))
        slopes = np.vstack([weights @ search.tangent, misfit.slopes_of_parameters(search.u)])
        return cls(misfit, search.u, weights, residual, slopes)

    def trials(self, search: SearchState, count: int) -> list[tuple[np.ndarray, float]]:
        """Return `count` places (k,) to try, and the lengths of the steps there.

        Each is half as long as the one before, and has the second-order correction from the last step, if there is one.
        """
        lengths = search.length * 0.5 ** np.arange(count)
        ends = [self.end(length) for length in lengths]
        if search.last is not None and search.last[0] @ search.last[0] > SHORTEST_SECANT**2:
            step, departure = search.last
            weighed = self.weights @ departure
            second = np.append(weighed, np.zeros(len(self.residual) - len(weighed))) / (step @ step) ** 2
            ends = [self._corrected(second, step, end, length) for end, length in zip(ends, lengths, strict=True)]
        return list(zip(ends, lengths, strict=True))

    def _corrected(self, second: np.ndarray, step: np.ndarray, end: np.ndarray, length: float) -> np.ndarray:
        """Correct a step to `end` by a departure of the curves quadratic in its component along the last `step`."""
        for _ in range(CORRECTIONS):
            end = self.end(length, (step @ (end - self.u)) ** 2 * second)
        return end

    def end(self, length: float, departure: np.ndarray | float = 0.0) -> np.ndarray:
        """Return the coordinates (k,) at the end of the step of this length.

        A coordinate that would cross its limit is held there, the first one first, and the others are solved for again.

        Parameters
        ----------
        departure : ndarray, shape (n + k + m,)
            Of the weighted curves there from their linear prediction.
        """
        least, largest = self.misfit.coordinates.limits
        free, step = np.ones(len(self.u), dtype=bool), np.zeros(len(self.u))
        while free.any():
            held = self.slopes[:, ~free] @ step[~free]
            step[free] = _limited(self.slopes[:, free], self.residual + departure + held, length)
            room = np.where(step > 0.0, largest, least) - self.u
            beyond = free & (np.abs(step) > np.abs(room))
            if not beyond.any():
                break
            first = int(np.argmin(np.divide(room, step, out=np.full(len(step), np.inf), where=beyond)))
            step[first], free[first] = room[first], False
        return np.clip(self.u + step, least, largest)

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
