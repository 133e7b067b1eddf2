"""Where the iteration of a step begins in which the load grows by much: the last solution, wider and deeper.

Under a sharp tip the displacements at one load are those at another, but for one factor on all lengths (K. L. Johnson,
Contact Mechanics (1985), section 6.3: the body has no length but the contact's). Creep, rounded tips and films change
that slowly. An extrapolation in time says less from one load to its double; where the load grows by little it says
more, and is left alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.drive import Drives
from palpate.solver.axisymmetric.march import States
from palpate.solver.axisymmetric.mesh import Mesh

GROWTH = 1.15, 4.0  # of the load in a step, between which the last solution is widened
STEEPEST = 2.0  # power of the load by which area and depth grow at most
SHARP = 1.0, 0.5  # these powers under a sharp tip, taken where no step before tells


@dataclass(frozen=True, eq=False)
class Widening:
    """The rings of a mesh, along which a solution is widened, and how the loads grow.

    Parameters
    ----------
    radii : ndarray, shape (1 + n,)
        Of the tip's node, which is zero, and of the rings.
    equations : ndarray of int, shape (1 + n, k)
        Of the displacements of the nodes of each.
    loads : ndarray, shape (1 + m, LANES)
        Numbers that grow as the loads do, at the beginning and at the end of each step.
    """

    radii: np.ndarray
    equations: np.ndarray
    loads: np.ndarray

    @classmethod
    def of(cls, mesh: Mesh, drives: Drives, times: np.ndarray) -> Widening:
        """Return the rings of a polar mesh, and what drives tips at the `times` (LANES, 1 + m) [s]."""
        equations = np.where(mesh.equations < 0, mesh.size, mesh.equations)
        rings = len(mesh.surface)
        tip, others = equations[0], equations[1:].reshape(rings, -1)
        radii = np.linalg.norm(mesh.nodes[1:].reshape(rings, -1, 2)[:, 0], axis=1)
        loads = np.array([drives.loading(time) for time in times.T])
        return cls(np.append(0.0, radii), np.vstack([np.resize(tip, others.shape[1]), others]), loads)

    def guess(self, step: int, states: States, change: np.ndarray, usual: np.ndarray, lanes: np.ndarray) -> np.ndarray:
        """Return the changes (size + 3, LANES) expected in step number `step`, counted from zero.

        Area and depth grow as powers of the load, those of the last step.

        Parameters
        ----------
        states
            What the last step led to.
        change : ndarray, shape (size + 3, LANES)
            In the last step.
        usual : ndarray, shape (size + 3, LANES)
            What is expected otherwise.
        lanes : ndarray of bool, shape (LANES,)
            Where the solution may be widened.
        """
        before = _growth(self.loads[max(step - 1, 0)], self.loads[step])
        growth = _growth(self.loads[step], self.loads[step + 1])
        lanes = lanes & (growth > GROWTH[0]) & (growth < GROWTH[1])
        if not lanes.any():
            return usual
        powers = zip((change[-1], np.log(_growth(states.depth - change[-2], states.depth))), SHARP, strict=True)
        known = before > GROWTH[0]
        last, more = np.log(np.where(known, before, np.e)), np.log(np.where(lanes, growth, 1.0))
        spread, deepened = (
            np.where(known, np.clip(grown / last, 0.0, STEEPEST), sharp) * more for grown, sharp in powers
        )
        displacement = self._widened(states.displacement, np.exp(0.5 * spread), np.exp(deepened))
        found = np.vstack([displacement - states.displacement, states.depth * np.expm1(deepened), spread])
        return np.where(lanes, found, usual)

    def _widened(self, before: np.ndarray, wider: np.ndarray, deeper: np.ndarray) -> np.ndarray:
        """Return displacements (size + 1, LANES) with lengths and depths larger by factors (LANES,)."""
        found = np.zeros_like(before)
        for lane, (wide, deep) in enumerate(zip(wider, deeper, strict=True)):
            place = np.interp(self.radii / wide, self.radii, np.arange(len(self.radii)))
            low = np.minimum(place.astype(int), len(place) - 2)
            part = (place - low)[:, None]
            rings = before[self.equations, lane]
            found[self.equations, lane] = deep * ((1.0 - part) * rings[low] + part * rings[low + 1])
        found[-1] = 0.0
        return found


def _growth(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the ratio (LANES,) of two numbers, one where the first is not positive or the second smaller."""
    positive = before > 0.0
    return np.maximum(np.where(positive, after / np.where(positive, before, 1.0), 1.0), 1.0)
