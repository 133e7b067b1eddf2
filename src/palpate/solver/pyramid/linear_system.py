"""The linearised system of a step, bordered by the depth, and the line search along its solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from palpate.errors import ConvergenceError
from palpate.solver.pyramid import banded_3d


class LinearSystem(Protocol):
    """A banded matrix with its right-hand side, bordered by the depth: see `element_3d.assemble`."""

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray


def newton_direction(
    work: LinearSystem, bandwidth: int, forces: np.ndarray, corner: float, definite: bool
) -> np.ndarray | None:
    """Return the change (size + 1,) of displacements and depth that balances `forces` in the linearised system.

    None where the matrix cannot be factored, or ought to be positive definite (`definite`) and is not.

    Parameters
    ----------
    work
        The linear system.
    bandwidth
        Number of entries beside the diagonal.
    forces : ndarray, shape (size + 1,)
        Residual of displacements and depth.
    corner
        Diagonal entry of the depth.
    """
    right = np.column_stack([work.residual, work.border[:, 0]])
    solution = banded_3d.solve(work.band, bandwidth, right, definite)
    if solution is None:
        return None
    forward, sideways = solution.T
    row = work.border[:, 1]
    stiffness = corner - row @ sideways
    if definite and stiffness <= 0.0:
        return None
    change = (row @ forward - forces[-1]) / stiffness
    return np.append(-forward - change * sideways, change)


@dataclass
class Search3D:
    """A line search for the zero of the work of the residual along Newton's direction, by the secant.

    Without friction and large strains there is an incremental potential; its minimum is where that work vanishes.
    """

    direction: np.ndarray
    start: float
    fraction: float = 1.0
    tries: int = 0

    @classmethod
    def along(cls, direction: np.ndarray, forces: np.ndarray) -> Search3D:
        """Begin a search at the point whose out-of-balance `forces` gave the `direction`."""
        return cls(direction, float(direction @ forces))

    def halve(self) -> float:
        """Return how far to move back to halve the step."""
        self.fraction *= 0.5
        return -self.fraction

    def shorten(self, forces: np.ndarray) -> float:
        """Return how far to move along the direction again (negative: back), or zero to accept the point."""
        work = float(self.direction @ forces)
        if self.tries >= 5 or work * self.start > 0.0 or abs(work) < 0.8 * abs(self.start):
            return 0.0
        self.tries += 1
        fraction = self.fraction * max(0.1, self.start / (self.start - work))
        move, self.fraction = fraction - self.fraction, fraction
        return move


def retreat(search: Search3D | None, time: float) -> np.ndarray:
    """Return the change (size + 1,) of displacements and depth that leads back from where an element is inside out.

    Raises
    ------
    ConvergenceError
        When there is no way back.
    """
    if search is None or search.fraction < 0.01:
        raise ConvergenceError("an element turned inside out", time=time)
    return search.halve() * search.direction
