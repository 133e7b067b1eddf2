"""Attraction between surface and tip: a traction that decays with the gap, so that separating costs the work w.

    sigma(g) = sigma_0 exp(-g / d),    sigma_0 d = w,

with g the gap along z. It has the potential  -w exp(-g / d)  for each undeformed area, so its force points along the
normal of the indenter. Where the surface touches, g = 0 and the unilateral contact acts beside sigma_0: a net tension
up to sigma_0 is carried before a node lets go, and the law has no jump there.

The true range of attraction is that of atoms, far below any element. What decides a curve is then the work w alone
(the limit of Johnson, Kendall & Roberts, for large Tabor parameters), and d regularises: it is chosen so that the zone
over which the attraction decays at the edge of contact, about (pi/8) E* w / sigma_0^2, spans `ZONE` elements there.

Coulomb friction feels the pressure of the unilateral contact, which the attraction raises (Derjaguin).

Sources: K. L. Johnson, K. Kendall and A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313; D. Maugis, J. Colloid
Interface Sci. 150 (1992) 243-269; for the length of the zone, G. I. Barenblatt, Adv. Appl. Mech. 7 (1962) 55-129.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from palpate.errors import ConvergenceError
from palpate.fem.contact import RATIO, RATIO_SLOPE, Contact
from palpate.fem.mesh import Mesh

if TYPE_CHECKING:
    from palpate.fem.newton import Workspace

ZONE = 2.0
LEAST_PART = 1 / 32  # of the attraction, the least growth that is tried
State = TypeVar("State")
GPA_UM = 1e-6  # one mJ/m^2


@dataclass(frozen=True, eq=False)
class Adhesion:
    """Attraction between the surface nodes and the indenter.

    Parameters
    ----------
    strength
        Largest traction sigma_0 [GPa].
    reach
        Gap d over which it falls by e [um].
    area : ndarray, shape (k,)
        Undeformed area of each surface node [um^2].
    """

    strength: float
    reach: float
    area: np.ndarray

    @classmethod
    def of(cls, work: float, modulus: float, element: float, area: np.ndarray) -> Adhesion:
        """Return the attraction of work `work` [mJ/m^2].

        Parameters
        ----------
        modulus
            Plane strain modulus E* of the body during the test [GPa].
        element
            Length of the elements at the edge of contact [um].
        area
            As for the class.
        """
        w = GPA_UM * work
        strength = math.sqrt(math.pi / 8 * modulus * w / (ZONE * element))
        return cls(strength, w / strength, area)

    @property
    def hold(self) -> np.ndarray:
        """Force along z (k,) [mN] that parts a node from the indenter."""
        return self.strength * self.area

    def weakened(self, part: float) -> Adhesion:
        """Return the attraction with a `part` of its strength and of its work."""
        return replace(self, strength=part * self.strength)

    def traction(self, gap: np.ndarray) -> np.ndarray:
        """Return sigma (k,) [GPa] across gaps [um]."""
        return self.strength * np.exp(-gap / self.reach)

    def add(
        self,
        contact: Contact,
        mesh: Mesh,
        displacement: np.ndarray,
        depth: float,
        work: Workspace,
        diagonal: int,
        force: np.ndarray,
        softening: bool,
    ) -> float:
        """Add the attraction to the assembled system and to the `force` (n, 2) of the indenter on the nodes.

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)
        depth
            Depth of the indenter [um].
        diagonal
            Column of the band's diagonal.
        softening
            Keep the stiffness that decaying attraction takes away; without it the matrix stays positive definite.

        Returns
        -------
        float
            What it adds to the diagonal entry of the depth.
        """
        surface, touching = contact.surface, contact.touching[contact.surface]
        equations = mesh.equations[surface]
        height, slope, curvature = contact.profile.beneath(contact.r, displacement[surface, 0], contact.large)
        slope = np.where(contact.r > 0.0, slope, 0.0)
        pull = self.area * self.traction(np.where(touching, 0.0, height - depth - displacement[surface, 1]))
        stiffness = np.where(touching | (not softening), 0.0, -pull / self.reach)
        free = ~touching
        force[surface[free]] = np.column_stack([-slope * pull, pull])[free]
        ratio, ratio_slope = contact.rule[surface, RATIO], contact.rule[surface, RATIO_SLOPE]
        along = np.where(touching, ratio * (1.0 + slope**2) * pull, slope * pull)
        along_slope = np.where(
            touching,
            (ratio_slope * (1.0 + slope**2) + 2.0 * ratio * slope * curvature) * pull,
            stiffness * slope**2 + curvature * pull,
        )
        r, z = equations[:, 0] >= 0, (equations[:, 1] >= 0) & free
        i, j = equations[r, 0], equations[z, 1]
        work.residual[i] += along[r]
        work.residual[j] -= pull[z]
        work.band[i, diagonal] += along_slope[r]
        work.band[j, diagonal] += stiffness[z]
        work.border[i] -= (stiffness * slope)[r, None]
        work.border[j] += stiffness[z, None]
        both = r & z
        coupling = -(stiffness * slope)[both]
        work.band[equations[both, 0], diagonal + 1] += coupling
        if diagonal > 0:
            work.band[equations[both, 1], diagonal - 1] += coupling
        return float(stiffness.sum())


def grown(step: Callable[[Any, State], State], problem: Any, guess: State) -> State:
    """Return the state after a step whose attraction grows in parts, which may change the contact much.

    Each part repeats the whole step and begins where the part before it ended, so only the last one counts.

    Parameters
    ----------
    step
        Takes the problem, with an `adhesion` of part strength, and a guess of the state at the end of the step.

    Raises
    ------
    ConvergenceError
        When the smallest part does not converge either.
    """
    done, more = -0.25, 0.25
    while done < 1.0:
        part = min(done + more, 1.0)
        try:
            guess = step(replace(problem, adhesion=problem.adhesion.weakened(part)), guess)
            done, more = part, 1.5 * more
        except ConvergenceError:
            more *= 0.5
            if more < LEAST_PART or done < 0.0:
                raise
    return guess


def nodal_areas(r: np.ndarray) -> np.ndarray:
    """Return the area (k,) that belongs to each node of a flat surface, by linear interpolation; `r` increases."""
    length = np.diff(r)
    area = np.zeros(len(r))
    area[:-1] += np.pi / 3 * length * (2 * r[:-1] + r[1:])
    area[1:] += np.pi / 3 * length * (r[:-1] + 2 * r[1:])
    return area
