"""The linearised system of a step, bordered by the depth, and the line search along its solution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from palpate.errors import ConvergenceError
from palpate.solver.axisymmetric.newton import LESS_WORK, SHORTEST, TRIES
from palpate.solver.pyramid.problem_3d import Workspace


@dataclass(frozen=True, eq=False)
class Factored:
    """A symmetric system whose band has a Cholesky factor.

    Attributes
    ----------
    factor : ndarray, shape (bandwidth + 1, size)
    border, sideways : ndarray, shape (size,)
        Derivatives of the residual by the depth, and the solution for them.
    stiffness
        Diagonal entry of the depth once the displacements are eliminated.
    """

    factor: np.ndarray
    border: np.ndarray
    sideways: np.ndarray
    stiffness: float

    @classmethod
    def of(cls, work: Workspace, corner: float) -> Factored | None:
        """Factor the band in place, `corner` being the entry of the depth; None where it is not positive definite."""
        factor, failed = lapack.dpbtrf(work.band.T, lower=1, overwrite_ab=1)
        if failed:
            return None
        sideways = lapack.dpbtrs(factor, work.border, lower=1)[0]
        return cls(factor, work.border, sideways, corner - work.border @ sideways)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the displacements and the depth (size + 1,) for a right-hand side (size + 1,)."""
        forward = lapack.dpbtrs(self.factor, right[:-1], lower=1)[0]
        change = (right[-1] - self.border @ forward) / self.stiffness
        return np.append(forward - change * self.sideways, change)


def newton_direction(work: Workspace, forces: np.ndarray, corner: float, definite: bool) -> np.ndarray | None:
    """Return the change (size + 1,) of displacements and depth that balances `forces` in the linearised system.

    None where the band is not positive definite, or the whole matrix ought to be (`definite`) and is not.

    Parameters
    ----------
    work
        The linear system; its band is overwritten.
    forces : ndarray, shape (size + 1,)
        Residual of displacements and depth.
    corner
        Diagonal entry of the depth.
    """
    system = Factored.of(work, corner)
    return None if system is None or (definite and system.stiffness <= 0.0) else system.solve(-forces)


@dataclass
class Search3D:
    """A line search for the zero of the work of the residual along Newton's direction, by the secant.

    Without friction and large strains there is an incremental potential; its minimum is where that work vanishes. Its
    limits are those of `palpate.solver.axisymmetric.newton`.
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
        if self.tries >= TRIES or work * self.start > 0.0 or abs(work) < LESS_WORK * abs(self.start):
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
    if search is None or search.fraction < SHORTEST:
        raise ConvergenceError("an element turned inside out", time=time)
    return search.halve() * search.direction
