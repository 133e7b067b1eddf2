"""Attraction between surface and tip: a traction that decays with the gap, so that separating costs the work w.

    sigma(g) = sigma_0 exp(-g / d),    sigma_0 d = w,

with g the gap along z. It has the potential  -w exp(-g / d)  for each undeformed area, so its force points along the
normal of the indenter. Where the surface touches, the gap is none and the contact acts beside sigma_0: a net tension up
to sigma_0 is carried before the surfaces part.

The true range of attraction is that of atoms, far below any element. What decides a curve is then the work w alone
(the limit of Johnson, Kendall & Roberts, for large Tabor parameters), and d regularises: it is chosen so that the zone
over which the attraction decays at the edge of contact, about (pi/8) E* w / sigma_0^2, spans `ZONE` elements there.

Coulomb friction feels the pressure of the unilateral contact, which the attraction raises (Derjaguin).

Sources: K. L. Johnson, K. Kendall and A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313; D. Maugis, J. Colloid
Interface Sci. 150 (1992) 243-269; for the length of the zone, G. I. Barenblatt, Adv. Appl. Mech. 7 (1962) 55-129.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from palpate.solver.axisymmetric.contact_size import GPA_UM
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.study.specimen import Specimen, plane_strain_modulus

ZONE = 2.0  # elements, chosen: fewer do not resolve how the attraction decays


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


def attraction(specimen: Specimen, resolution: Resolution, largest: float, area: np.ndarray) -> Adhesion:
    """Return the adhesion of a specimen that has one, ranged for the elements at the edge of the largest contact [um].

    Parameters
    ----------
    specimen
        The body.
    resolution
        Of the mesh.
    largest
        Largest contact radius [um].
    area : ndarray, shape (k,)
        Undeformed area of each surface node [um^2].
    """
    work, element = GPA_UM * specimen.adhesion, (resolution.growth - 1.0) * largest
    strength = math.sqrt(math.pi / 8 * plane_strain_modulus(specimen.coefficients) * work / (ZONE * element))
    return Adhesion(strength, work / strength, area)


def nodal_areas(r: np.ndarray) -> np.ndarray:
    """Return the area (k,) that belongs to each node of a flat surface, by linear interpolation; `r` increases."""
    length = np.diff(r)
    area = np.zeros(len(r))
    area[:-1] += np.pi / 3 * length * (2 * r[:-1] + r[1:])
    area[1:] += np.pi / 3 * length * (r[:-1] + 2 * r[1:])
    return area
