"""Contact of surface nodes with a rigid indenter, along its true normal, with friction or without.

A node that touches lies on the indenter, u_z = f(x + u_x, y + u_y) - depth, and slides along it; at small strains f is
taken along its tangent at (x, y). One that an iteration finds inside it joins by the linearised constraint: the next
change of displacements closes its gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.solver.pyramid.friction_3d import Friction
from palpate.solver.pyramid.mesh_3d import Mesh3D
from palpate.solver.pyramid.problem_3d import Problem3D, State
from palpate.solver.pyramid.tip_3d import Tip

PENETRATION = 1e-9  # of the depth, below which a node counts as outside


@dataclass(eq=False)
class Contact3D:
    """The contact during the iterations of one time step.

    Attributes
    ----------
    place, start, drift : ndarray, shape (k, 2)
        Where the surface nodes lie undeformed and at the start of the step, and how far they are expected to move in
        it, along the axes of each node [um].
    opening, gap : ndarray, shape (k,)
        Gaps at the start of the step, and now [um].
    hold : ndarray, shape (k,)
        Force along z by which adhesion holds each node [mN].
    large
        Whether strains are.
    touching : ndarray of bool, shape (n,)
        Nodes that touch.
    anchor : ndarray, shape (k, 2)
        Anchors of friction [um]; NaN where a node did not touch.
    rule : ndarray, shape (n, 6)
        What holds there, along the axes of each node: df/d1, df/d2, their derivatives (11, 12, 22), and the gap that
        the next change of displacements closes.
    slip : ndarray, shape (k, 2)
        Slip since the anchor, in units of the friction's reach.
    joined
        Whether some gap is still to be closed.
    """

    mesh: Mesh3D
    tip: Tip
    friction: Friction
    place: np.ndarray
    start: np.ndarray
    drift: np.ndarray
    opening: np.ndarray
    touching: np.ndarray
    anchor: np.ndarray
    rule: np.ndarray
    slip: np.ndarray
    hold: np.ndarray
    large: bool
    gap: np.ndarray
    joined: bool = False

    @classmethod
    def resume(cls, problem: Problem3D, state: State, guess: State) -> Contact3D:
        """Begin a step at a `state`, with another that guesses its end."""
        mesh, tip = problem.mesh, problem.tip
        surface = mesh.surface
        (x, y, _), (cos, sin), u = mesh.nodes[surface].T, mesh.turn[surface].T, state.displacement[surface]
        place = np.stack([cos * x + sin * y, cos * y - sin * x], axis=1)
        opening = _indenter(mesh, tip, place, u[:, :2], problem.large)[0] - state.depth - u[:, 2]
        return cls(
            mesh,
            tip,
            Friction.of(problem.friction, tip(x, y)[0], mesh.equations[surface, :2] >= 0),
            place,
            start=place + u[:, :2],
            drift=guess.displacement[surface, :2] - u[:, :2],
            opening=opening,
            touching=state.contact.copy(),
            anchor=state.anchor.copy(),
            rule=np.zeros((len(mesh.nodes), 6)),
            slip=np.zeros_like(place),
            hold=problem.hold,
            large=problem.large,
            gap=opening,
        )

    @property
    def slope(self) -> np.ndarray:
        """Slopes (k, 2) of the indenter where the surface nodes lie."""
        return self.rule[self.mesh.surface, :2]

    @property
    def curvature(self) -> np.ndarray:
        """Its curvatures (k, 3) there: 11, 12 and 22."""
        return self.rule[self.mesh.surface, 2:5]

    def follow(self, displacement: np.ndarray, depth: float) -> bool:
        """Put the nodes that touch onto the indenter, changing `displacement` (n, 3), find new ones, write the rule.

        A new node is anchored where it was when its gap first closed, by linear interpolation within the step.

        Returns
        -------
        bool
            True where the same nodes touch, and the same of them slip, as in the iteration before.
        """
        surface = self.mesh.surface
        touched = self.touching[surface]
        if self.friction.coefficient > 0.0:
            self._reverse_slip(displacement)
        height, slope, curvature = _indenter(self.mesh, self.tip, self.place, displacement[surface, :2], self.large)
        self.gap = gap = height - depth - displacement[surface, 2]
        displacement[surface, 2] += np.where(touched, gap, 0.0)
        joining = ~touched & (gap < -PENETRATION * abs(depth))
        self.touching[surface] |= joining
        self.joined = bool(joining.any())
        new = joining & np.isnan(self.anchor[:, 0])
        closing = np.clip(self.opening[new] / (self.opening - gap)[new], 0.0, 1.0)
        self.anchor[new] = self.start[new] + closing[:, None] * self.drift[new]
        self.rule[surface, :2] = slope
        self.rule[surface, 2:5] = curvature[:, [0, 0, 1], [0, 1, 1]]
        self.rule[surface, 5] = np.where(joining, gap, 0.0)
        slipped = self._slips(self.slip)
        self.slip = self.friction.slip(self.place + displacement[surface, :2], self.anchor)
        return not self.joined and np.array_equal(slipped, self._slips(self.slip))

    def _slips(self, slip: np.ndarray) -> np.ndarray:
        return self.friction.coefficient * self.friction.size(slip, self.slope) > self.friction.coefficient

    def _reverse_slip(self, displacement: np.ndarray) -> None:
        """Put nodes whose slip reverses within one iteration back to where they stuck."""
        surface, slope = self.mesh.surface, self.slope
        slip = self.friction.slip(self.place + displacement[surface, :2], self.anchor)
        turned = np.einsum("ki,ki->k", slip, self.slip) < 0.0
        turned &= (self.friction.size(slip, slope) > 1.0) & (self.friction.size(self.slip, slope) > 1.0)
        displacement[surface[turned], :2] = (self.anchor - self.place)[turned]

    def pressure(self, force: np.ndarray) -> np.ndarray:
        """Return P (k,) [mN] of the contact, by the `force` (n, 3) of indenter and attraction together.

        P = f_i F_i - F_z, see `palpate.solver.pyramid.friction_3d`, and what the attraction holds beside.
        """
        along = self.friction.along(self.slope)
        held = self.hold * (1.0 + np.sum(along**2, axis=1))
        return np.einsum("ki,ki->k", along, force[self.mesh.surface, :2]) - force[self.mesh.surface, 2] + held

    def pulled(self, force: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which nodes (n,) would have to be pulled by more than they hold, by `force` (n, 3) [mN]."""
        surface, pulled = self.mesh.surface, np.zeros(len(self.touching), dtype=bool)
        steep = 1.0 + np.sum(self.friction.along(self.slope) ** 2, axis=1)
        pulled[surface] = self.touching[surface] & (self.pressure(force) < -tolerance * steep)
        return pulled

    def release(self, pulled: np.ndarray) -> None:
        """Let go the nodes that are `pulled`, but keep the tip."""
        self.touching &= ~pulled
        if not self.touching.any():
            self.touching[0] = True

    def anchors(self, displacement: np.ndarray) -> np.ndarray:
        """Return the anchors (k, 2) at the end of the step."""
        place = self.place + displacement[self.mesh.surface, :2]
        dragged = self.friction.dragged(place, self.anchor, self.slope)
        return np.where(self.touching[self.mesh.surface, None], dragged, np.nan)


def _indenter(
    mesh: Mesh3D, tip: Tip, place: np.ndarray, moved: np.ndarray, large: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return f (k,), its slopes (k, 2) and curvatures (k, 2, 2), for nodes of some `place` (k, 2) that `moved` (k, 2).

    All are along the axes of the nodes; small strains take f(x + u) = f(x) + f_i(x) u_i.
    """
    cos, sin = mesh.turn[mesh.surface].T
    one, two = (place + moved if large else place).T
    height, slope, curvature = tip(cos * one - sin * two, sin * one + cos * two)
    axes = np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=1)
    slope = np.einsum("kij,kj->ki", axes, slope)
    if not large:
        return height + np.einsum("ki,ki->k", slope, moved), slope, np.zeros_like(curvature)
    return height, slope, axes @ curvature @ axes.transpose(0, 2, 1)
