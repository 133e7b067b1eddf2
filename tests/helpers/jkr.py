"""Rigid sphere and cone on an elastic half-space, with adhesion of short range.

A contact of radius a carries the pressure of the contact without adhesion, less that of a flat punch whose edge
releases the work w,

    P = P_0(a) - sqrt(8 pi E* w a^3),    h = h_0(a) - sqrt(2 pi w a / E*),    E* = E/(1 - nu^2),

    sphere:  P_0 = 4 E* a^3 / (3 R),          h_0 = a^2 / R;
    cone:    P_0 = (pi/2) E* a^2 cot(alpha),  h_0 = (pi/2) a cot(alpha).

Assumes small strains, small slopes, no friction, and a range of attraction much shorter than the elastic deformation
that it causes.

Sources: K. L. Johnson, K. Kendall and A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313 (sphere); D. Maugis and
M. Barquins, J. Phys. D 11 (1978) 1989-2023 (cone).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

UM_PER_NM = 1e-3
GPA_UM = 1e-6  # one mJ/m^2


@dataclass(frozen=True)
class AdhesiveContact:
    """An adhesive contact.

    Parameters
    ----------
    load_without, depth_without
        Load [mN] and depth [um] at a contact radius [um] without adhesion.
    modulus
        Plane strain modulus E* [GPa].
    work
        Work of adhesion [mJ/m^2].
    """

    load_without: Callable
    depth_without: Callable
    modulus: float
    work: float

    @classmethod
    def sphere(cls, youngs_modulus, poisson_ratio, radius, work):
        """Return the contact of a sphere; modulus in GPa, radius in nm, work in mJ/m^2."""
        e, r = youngs_modulus / (1 - poisson_ratio**2), UM_PER_NM * radius
        return cls(lambda a: 4 / 3 * e * a**3 / r, lambda a: a**2 / r, e, work)

    @classmethod
    def cone(cls, youngs_modulus, poisson_ratio, half_angle, work):
        """Return the contact of a cone; modulus in GPa, half-angle in degrees, work in mJ/m^2."""
        e, slope = youngs_modulus / (1 - poisson_ratio**2), 1 / np.tan(np.radians(half_angle))
        return cls(lambda a: np.pi / 2 * e * slope * a**2, lambda a: np.pi / 2 * slope * a, e, work)

    def load(self, radius):
        """Return the load [mN] at a contact radius [um]."""
        return float(self.load_without(radius) - np.sqrt(8 * np.pi * self.modulus * GPA_UM * self.work * radius**3))

    def radius(self, load):
        """Return the contact radius [um] under a compressive `load` [mN]."""
        largest = 1.0
        while self.load(largest) <= load:
            largest *= 2.0
        smallest = largest
        while self.load(smallest) > load:
            smallest *= 0.5
        return brentq(lambda a: self.load(a) - load, smallest, largest, xtol=1e-15)

    def depth(self, load):
        """Return the depth [nm] under compressive loads [mN], of the same shape."""
        a = np.vectorize(self.radius, otypes=[float])(np.asarray(load, dtype=float))
        without = np.vectorize(self.depth_without, otypes=[float])(a)
        return (without - np.sqrt(2 * np.pi * GPA_UM * self.work * a / self.modulus)) / UM_PER_NM
