"""What holds where a rigid axisymmetric indenter touches: which nodes do, its profile there, and friction.

A node that touches lies on the indenter, u_z = f(R) - depth at R = r + u_r. At small strains f is taken along its
tangent at r, linear in the displacements like all else there: the curvature of f pushes nodes outwards, and without
what stress and stretch do against it at large strains a body that hardly hardens runs away under a sphere. A node that
an iteration finds inside the indenter joins by the linearised constraint: the next change of displacements closes its
gap together with everything around it, so that a law with a yield stress never sees one node moved alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from palpate.fem.friction import Friction
from palpate.fem.mesh import Mesh
from palpate.fem.profile import Profile

if TYPE_CHECKING:
    from palpate.fem.newton import State

SLOPE, CURVATURE, RATIO, RATIO_SLOPE, GAP = range(5)
PENETRATION = 1e-9  # of the depth, below which a node counts as outside


@dataclass(eq=False)
class Contact:
    """The contact during the iterations of one time step.

    Attributes
    ----------
    surface : ndarray of int, shape (k,)
        Nodes that may touch.
    r, start, drift, opening : ndarray, shape (k,)
        Their undeformed distances from the axis, those at the start of the step, how far the distances are expected to
        change in it, and the gaps at its start [um].
    touching : ndarray of bool, shape (n,)
        Nodes that touch.
    anchor : ndarray, shape (k,)
        Anchors of friction [um]; NaN where a node did not touch.
    rule : ndarray, shape (n, 5)
        What holds at the nodes that touch: f', f'', m, dm/dR and the gap that the next change of displacements closes.
    slip : ndarray, shape (k,)
        Slip since the anchor, in units of the friction's reach.
    hold : ndarray, shape (k,)
        Force along z by which adhesion holds each node [mN].
    large
        Whether strains are.
    joined
        Whether some gap is still to be closed.
    """

    profile: Profile
    friction: Friction
    surface: np.ndarray
    r: np.ndarray
    start: np.ndarray
    drift: np.ndarray
    opening: np.ndarray
    touching: np.ndarray
    anchor: np.ndarray
    rule: np.ndarray
    slip: np.ndarray
    hold: np.ndarray
    large: bool
    joined: bool = False

    @classmethod
    def resume(
        cls, mesh: Mesh, profile: Profile, coefficient: float, hold: np.ndarray, large: bool, state: State, guess: State
    ) -> Contact:
        """Begin a step at a `state`, with another that guesses its end."""
        surface = mesh.surface
        r = mesh.nodes[surface, 0]
        u = state.displacement[surface]
        return cls(
            profile,
            Friction.of(coefficient, profile(r)[0]),
            surface,
            r,
            start=r + u[:, 0],
            drift=guess.displacement[surface, 0] - u[:, 0],
            opening=profile.beneath(r, u[:, 0], large)[0] - state.depth - u[:, 1],
            touching=state.contact.copy(),
            anchor=state.anchor.copy(),
            rule=np.zeros((len(mesh.nodes), 5)),
            slip=np.zeros(len(r)),
            hold=hold,
            large=large,
        )

    def follow(self, displacement: np.ndarray, depth: float) -> bool:
        """Put the nodes that touch onto the indenter, changing `displacement` (n, 2), find new ones, write the rule.

        A new node is anchored where it was when its gap first closed, by linear interpolation within the step.

        Returns
        -------
        bool
            True where the same nodes touch, and the same of them slip, as in the iteration before.
        """
        surface, touched = self.surface, self.touching[self.surface]
        self._turn_back(displacement)
        moved = displacement[surface, 0]
        distance = self.r + moved
        height, slope, curvature = self.profile.beneath(self.r, moved, self.large)
        gap = height - depth - displacement[surface, 1]
        displacement[surface, 1] += np.where(touched, gap, 0.0)
        joining = ~touched & (gap < -PENETRATION * abs(depth))
        self.touching[surface] |= joining
        self.joined = bool(joining.any())
        new = joining & (self.opening > 0.0) & np.isnan(self.anchor)
        closing = self.opening[new] / (self.opening - gap)[new]
        self.anchor[new] = self.start[new] + closing * self.drift[new]
        slip, last = self.friction.slip(distance, self.anchor), self.slip
        self.rule[surface, SLOPE] = np.where(self.r > 0.0, slope, 0.0)
        self.rule[surface, CURVATURE] = curvature
        self.rule[surface, RATIO], self.rule[surface, RATIO_SLOPE] = self.friction.ratio(slip)
        self.rule[surface, GAP] = np.where(joining, gap, 0.0)
        self.slip = slip
        frictionless = self.friction.coefficient == 0.0
        return not self.joined and (frictionless or np.array_equal(np.abs(slip) > 1.0, np.abs(last) > 1.0))

    def _turn_back(self, displacement: np.ndarray) -> None:
        """Put nodes whose slip reverses within one iteration back to where they stuck."""
        slip = self.friction.slip(self.r + displacement[self.surface, 0], self.anchor)
        turned = (slip * self.slip < 0.0) & (np.abs(slip) > 1.0) & (np.abs(self.slip) > 1.0)
        if self.friction.coefficient > 0.0:
            displacement[self.surface[turned], 0] = (self.anchor - self.r)[turned]

    def pulled(self, force: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which nodes (n,) the indenter would have to pull by more than they hold: by `force` (n, 2) [mN]."""
        slope, pulled = self.rule[self.surface, SLOPE], np.zeros(len(self.touching), dtype=bool)
        pressure = slope * force[self.surface, 0] - force[self.surface, 1] + (1.0 + slope**2) * self.hold
        pulled[self.surface] = self.touching[self.surface] & (pressure < -tolerance)
        return pulled

    def release(self, pulled: np.ndarray, force: np.ndarray) -> None:
        """Let go the nodes that are `pulled`, but keep one."""
        self.touching &= ~pulled
        if not self.touching.any():
            self.touching[np.argmax(np.where(pulled, force[:, 1], -np.inf))] = True

    def anchors(self, displacement: np.ndarray) -> np.ndarray:
        """Return the anchors (k,) at the end of the step."""
        dragged = self.friction.dragged(self.r + displacement[self.surface, 0], self.anchor)
        return np.where(self.touching[self.surface], dragged, np.nan)
