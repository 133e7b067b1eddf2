r"""Profile likelihoods over the solver itself: the least chi^2 with one parameter held, the others free.

All held values of all parameters are improved together, so that their curves are solved in batches. Each begins at the
least of the linear problem and takes Gauss-Newton steps, the Jacobian brought up to date by Broyden's formula; a step
that does not improve is halved (Nocedal and Wright 2006, Numerical Optimization, chapters 10 and 11).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import lsq_linear

Residuals = Callable[[np.ndarray], np.ndarray]
STEPS = 3


@dataclass(eq=False)
class Held:
    """One parameter held at one value, and the best point found so far.

    Parameters
    ----------
    index
        Which parameter is held.
    value
        Where, scaled to the range.
    start : ndarray, shape (p,)
        A point at which the residuals vanish.
    jacobian : ndarray, shape (n, p)
        Of the whitened residuals there.
    """

    index: int
    value: float
    start: np.ndarray
    jacobian: np.ndarray
    point: np.ndarray = field(init=False)
    residual: np.ndarray = field(init=False)
    damping: float = 1.0
    solved: bool = False

    def __post_init__(self) -> None:
        self.jacobian = self.jacobian.copy()
        moved = self.start.copy()
        moved[self.index] = self.value
        self.point, self.residual = moved, self.jacobian @ (moved - self.start)

    @property
    def chi_square(self) -> float:
        """Sum of squares at the best point; infinite before any was solved."""
        return float(self.residual @ self.residual) if self.solved else np.inf

    def proposal(self) -> np.ndarray:
        """Return the next point (p,) to try."""
        free = np.arange(len(self.point)) != self.index
        here = self.point[free]
        step = lsq_linear(self.jacobian[:, free], -self.residual, bounds=(-here - 1e-12, 1 - here + 1e-12)).x
        tried = self.point.copy()
        tried[free] = np.clip(here + self.damping * step, 0.0, 1.0)
        return tried

    def learn(self, tried: np.ndarray, residual: np.ndarray) -> None:
        """Take the point if it is better, and bring the Jacobian up to date."""
        if not np.all(np.isfinite(residual)):
            self.damping *= 0.5
            return
        origin, known = (self.point, self.residual) if self.solved else (self.start, np.zeros_like(residual))
        step = tried - origin
        if step @ step > 1e-16:
            self.jacobian += np.outer(residual - known - self.jacobian @ step, step) / (step @ step)
        if residual @ residual < self.chi_square:
            self.point, self.residual, self.damping, self.solved = tried, residual, 1.0, True
        else:
            self.damping *= 0.5


def profile(start: np.ndarray, jacobian: np.ndarray, grids: list[np.ndarray], residuals: Residuals) -> list[np.ndarray]:
    """Return the least chi^2 found (k,) at each value of each parameter's grid.

    Parameters
    ----------
    start : ndarray, shape (p,)
        Where the residuals vanish, scaled to the ranges.
    jacobian : ndarray, shape (n, p)
        Of the whitened residuals there.
    grids
        Values (k,) at which each parameter is held, scaled to its range.
    residuals
        From points (m, p) to whitened residuals (m, n).
    """
    points = [Held(index, float(value), start, jacobian) for index, grid in enumerate(grids) for value in grid]
    for _ in range(STEPS):
        tried = np.array([point.proposal() for point in points])
        for point, at, found in zip(points, tried, residuals(tried), strict=True):
            point.learn(at, found)
    return [np.array([p.chi_square for p in points if p.index == index]) for index in range(len(grids))]
