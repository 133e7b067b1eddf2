"""Frictionless contact of surface nodes with a rigid indenter, along its true normal.

A node that touches lies on the indenter, u_z = f(x + u_x, y + u_y) - depth, and slides freely along it. One that an
iteration finds inside it joins by the linearised constraint: the next change of displacements closes its gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem3d.mesh import Mesh
from palpate.fem3d.tip import Tip

PENETRATION = 1e-9  # of the depth, below which a node counts as outside


@dataclass(eq=False)
class Contact:
    """The contact during the iterations of one time step.

    Attributes
    ----------
    touching : ndarray of bool, shape (n,)
        Nodes that touch.
    rule : ndarray, shape (n, 6)
        What holds there, along the axes of each node: df/d1, df/d2, their derivatives (11, 12, 22), and the gap that
        the next change of displacements closes.
    joined
        Whether some gap is still to be closed.
    """

    mesh: Mesh
    tip: Tip
    touching: np.ndarray
    rule: np.ndarray
    joined: bool = False

    @classmethod
    def resume(cls, mesh: Mesh, tip: Tip, touching: np.ndarray) -> Contact:
        """Begin a step with the nodes (n,) that touched at the end of the last one."""
        return cls(mesh, tip, touching.copy(), np.zeros((len(mesh.nodes), 6)))

    def follow(self, displacement: np.ndarray, depth: float) -> None:
        """Put the nodes that touch onto the indenter, changing `displacement` (n, 3), find new ones, write the rule."""
        surface = self.mesh.surface
        touched = self.touching[surface]
        (cos, sin), (one, two, vertical) = self.mesh.turn[surface].T, displacement[surface].T
        x = self.mesh.nodes[surface, 0] + cos * one - sin * two
        y = self.mesh.nodes[surface, 1] + sin * one + cos * two
        height, slope, curvature = self.tip(x, y)
        gap = height - depth - vertical
        displacement[surface, 2] += np.where(touched, gap, 0.0)
        joining = ~touched & (gap < -PENETRATION * abs(depth))
        self.touching[surface] |= joining
        self.joined = bool(joining.any())
        axes = np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=1)
        turned = axes @ curvature @ axes.transpose(0, 2, 1)
        self.rule[surface, :2] = np.einsum("kij,kj->ki", axes, slope)
        self.rule[surface, 2:5] = turned[:, [0, 0, 1], [0, 1, 1]]
        self.rule[surface, 5] = np.where(joining, gap, 0.0)

    def pulled(self, force: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which nodes (n,) the indenter would have to pull, by `force` (n,) along z [mN]."""
        return self.touching & (force > tolerance)

    def release(self, pulled: np.ndarray) -> None:
        """Let go the nodes that are `pulled`, but keep the tip."""
        self.touching &= ~pulled
        if not self.touching.any():
            self.touching[0] = True
