"""What holds where a rigid axisymmetric indenter touches: which nodes do, its profile there, and friction.

A node that touches lies on the indenter, u_z = f(R) - depth at R = r + u_r. One that an iteration finds inside it joins
by the linearised constraint: the next change of displacements closes its gap together with everything around it, so
that a law with a yield stress never sees one node moved alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from palpate.fem.friction import Friction
from palpate.fem.mesh import Mesh
from palpate.indenters import Indenter

SLOPE, CURVATURE, RATIO, RATIO_SLOPE, GAP = range(5)
PENETRATION = 1e-9  # of the depth, below which a node counts as outside


@dataclass(frozen=True)
class Profile:
    """Height f(r) of an indenter above its apex, with slope and curvature: a cap that runs tangentially into a cone.

    Parameters
    ----------
    slope
        df/dr of the flank; infinite for a sphere.
    radius
        Radius of the cap [um]; zero for a sharp cone.
    """

    slope: float
    radius: float

    @classmethod
    def of(cls, indenter: Indenter) -> Profile:
        """Return the profile of an indenter, in um."""
        return cls(indenter.slope, indenter.radius * 1e-3)

    @property
    def junction(self) -> float:
        """Distance from the axis at which the cap meets the flank [um]."""
        return self.radius / math.sqrt(1.0 + self.slope**-2) if math.isfinite(self.slope) else self.radius

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return f, df/dr and d2f/dr2 at distances `r` [um]; a sphere continues flat beyond 0.99 of its radius."""
        if self.radius == 0.0:
            return self.slope * r, np.full_like(r, self.slope), np.zeros_like(r)
        edge = min(self.junction, 0.99 * self.radius)
        root = np.sqrt(self.radius**2 - np.clip(r, -edge, edge) ** 2)
        slope = np.minimum(r, edge) / root
        on_cap = r < edge
        height = self.radius - root + np.where(on_cap, 0.0, (r - edge) * slope)
        return height, slope, np.where(on_cap, self.radius**2 / root**3, 0.0)

    def depth_for(self, r: float) -> float:
        """Return f at one distance [um]."""
        return float(self(np.array([r]))[0][0])


@dataclass(eq=False)
class Contact:
    """The contact during the iterations of one time step.

    Attributes
    ----------
    surface : ndarray of int, shape (k,)
        Nodes that may touch.
    r : ndarray, shape (k,)
        Their undeformed distances from the axis [um].
    touching : ndarray of bool, shape (n,)
        Nodes that touch.
    anchor : ndarray, shape (k,)
        Anchors of friction at the start of the step [um]; NaN where a node did not touch.
    rule : ndarray, shape (n, 5)
        What holds at the nodes that touch: f', f'', m, dm/dR and the gap that the next change of displacements closes.
    joined
        Whether some gap is still to be closed.
    """

    profile: Profile
    friction: Friction
    surface: np.ndarray
    r: np.ndarray
    touching: np.ndarray
    anchor: np.ndarray
    rule: np.ndarray
    slip: np.ndarray
    joined: bool = False

    @classmethod
    def resume(
        cls, mesh: Mesh, profile: Profile, coefficient: float, touching: np.ndarray, anchor: np.ndarray
    ) -> Contact:
        """Begin a step with the nodes that touched and their anchors."""
        r = mesh.nodes[mesh.surface, 0]
        rule = np.zeros((len(mesh.nodes), 5))
        friction = Friction.of(coefficient, r)
        return cls(profile, friction, mesh.surface, r, touching.copy(), anchor, rule, np.zeros(len(r)))

    def follow(self, displacement: np.ndarray, depth: float) -> bool:
        """Put the nodes that touch onto the indenter, changing `displacement` (n, 2), find new ones, write the rule.

        Returns
        -------
        bool
            True where the same nodes touch, and the same of them slip, as in the iteration before.
        """
        same = self._rub(displacement)
        distance = self.r + displacement[self.surface, 0]
        height, slope, curvature = self.profile(distance)
        gap = height - depth - displacement[self.surface, 1]
        touched = self.touching[self.surface]
        displacement[self.surface, 1] += np.where(touched, gap, 0.0)
        joining = ~touched & (gap < -PENETRATION * abs(depth))
        self.joined = bool(joining.any())
        self.touching[self.surface] |= joining
        self.rule[self.surface, SLOPE] = np.where(self.r > 0.0, slope, 0.0)
        self.rule[self.surface, CURVATURE] = curvature
        self.rule[self.surface, GAP] = np.where(joining, gap, 0.0)
        return same and not self.joined

    def _rub(self, displacement: np.ndarray) -> bool:
        """Write the friction; a node whose slip reverses within one iteration is put back to where it stuck."""
        if self.friction.coefficient == 0.0:
            return True
        distance = self.r + displacement[self.surface, 0]
        slip, last = self.friction.slip(distance, self.anchor), self.slip
        slides, slid = np.abs(slip) > 1.0, np.abs(last) > 1.0
        turned = slides & slid & (slip * last < 0.0)
        displacement[self.surface[turned], 0] = (self.anchor - self.r)[turned]
        slip[turned] = 0.0
        self.slip = slip
        self.rule[self.surface, RATIO], self.rule[self.surface, RATIO_SLOPE] = self.friction.ratio(slip, self.anchor)
        return bool(np.array_equal(slides & ~turned, slid))

    def pulled(self, force: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which nodes (n,) the indenter would have to pull: by `force` (n, 2) [mN], more than `tolerance`."""
        return self.touching & (self.rule[:, SLOPE] * force[:, 0] - force[:, 1] < -tolerance)

    def release(self, pulled: np.ndarray, force: np.ndarray) -> None:
        """Let go the nodes that are `pulled`, but keep one."""
        self.touching &= ~pulled
        if not self.touching.any():
            self.touching[np.argmax(np.where(pulled, force[:, 1], -np.inf))] = True

    def anchors(self, displacement: np.ndarray) -> np.ndarray:
        """Return the anchors (k,) at the end of the step."""
        dragged = self.friction.dragged(self.r + displacement[self.surface, 0], self.anchor)
        return np.where(self.touching[self.surface], dragged, np.nan)
