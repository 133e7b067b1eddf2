"""Hertz' rigid sphere on an elastic half-space.

    P = (4/3) E/(1 - nu^2) sqrt(R) h^(3/2),    a = sqrt(R h)

Assumes small strains, a contact much smaller than the sphere (a << R: the sphere is taken as a paraboloid), no friction
and no adhesion.

`youngs_modulus` [GPa] and `poisson_ratio` [-] are those of the half-space, `radius` [nm] that of the sphere.

Source: H. Hertz, J. reine angew. Math. 92 (1882) 156-171; K. L. Johnson, Contact Mechanics (1985), equations (4.22) and
(4.23).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

UM_PER_NM = 1e-3


def load(depth: ArrayLike, youngs_modulus: float, poisson_ratio: float, radius: float) -> np.ndarray:
    """Return the load [mN] at `depth` [nm], of the same shape; modulus in GPa, radius in nm."""
    h, r = UM_PER_NM * np.asarray(depth, dtype=float), UM_PER_NM * radius
    return 4 / 3 * youngs_modulus / (1 - poisson_ratio**2) * np.sqrt(r) * h**1.5


def depth(load: ArrayLike, youngs_modulus: float, poisson_ratio: float, radius: float) -> np.ndarray:
    """Return the depth [nm] under `load` [mN], of the same shape; modulus in GPa, radius in nm."""
    p, r = np.asarray(load, dtype=float), UM_PER_NM * radius
    return (3 / 4 * p * (1 - poisson_ratio**2) / (youngs_modulus * np.sqrt(r))) ** (2 / 3) / UM_PER_NM
