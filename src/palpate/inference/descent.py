"""The state of one search for the least misfit, and when it ends."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from threading import Event

import numpy as np

from palpate.inference.forward import Curves

LARGEST_STEP = 1.0  # of the range of a parameter


@dataclass(frozen=True, eq=False)
class Until:
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
    hopeless
        After how many iterations in a row it seemed that it would not reach what it must.
    gains
        By how much each iteration lowered chi^2.
    """

    u: np.ndarray
    curves: Curves
    slopes: Curves
    exact: bool = True
    last: tuple[np.ndarray, Curves] | None = None
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

    def anew(self) -> Descent:
        """Return the search as it begins again where it ended."""
        return replace(self, length=LARGEST_STEP, converged=False, active=True, hopeless=0, gains=[])

    def predicted(self, u: np.ndarray) -> Curves:
        """Return the curves at coordinates u (k,) to first order."""
        return {name: curves + self.slopes[name] @ (u - self.u) for name, curves in self.curves.items()}

    def departed(self, u: np.ndarray, curves: Curves) -> tuple[np.ndarray, Curves]:
        """Return the step to coordinates u (k,), and the departure of the curves there from their linear prediction."""
        return u - self.u, {name: curves[name] - linear for name, linear in self.predicted(u).items()}

    def move(self, u: np.ndarray, curves: Curves) -> None:
        """Take a step to coordinates u (k,) with these curves, and correct the slopes by its secant."""
        step, departure = self.departed(u, curves)
        self.slopes = {n: slopes + np.outer(departure[n], step) / (step @ step) for n, slopes in self.slopes.items()}
        self.path.append(self.u)
        self.u, self.curves, self.exact = u, curves, False
