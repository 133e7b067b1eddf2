"""Sneddon's cone on an elastic half-space.

    P = (2/pi) E/(1 - nu^2) tan(alpha) h^2,    a = (2/pi) tan(alpha) h

Assumes small strains, a shallow frictionless rigid cone (the boundary condition is put on the undeformed surface, and
the radial displacement there is neglected) and no adhesion. `half_angle` is the angle between the axis and a flank.

`youngs_modulus` [GPa] and `poisson_ratio` [-] are those of the half-space, `half_angle` [deg] that of the cone.

Source: I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47-57, the conical punch; K. L. Johnson, Contact Mechanics (1985),
section 5.2, with his mean pressure (E*/2) cot(alpha).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

UM_PER_NM = 1e-3


def load(depth: ArrayLike, youngs_modulus: float, poisson_ratio: float, half_angle: float) -> np.ndarray:
    """Return the load [mN] at `depth` [nm], of the same shape; modulus in GPa, half-angle in degrees."""
    h = UM_PER_NM * np.asarray(depth, dtype=float)
    return 2 / np.pi * _plane_strain(youngs_modulus, poisson_ratio) * np.tan(np.radians(half_angle)) * h**2


def depth(load: ArrayLike, youngs_modulus: float, poisson_ratio: float, half_angle: float) -> np.ndarray:
    """Return the depth [nm] under `load` [mN], of the same shape; modulus in GPa, half-angle in degrees."""
    p = np.asarray(load, dtype=float)
    modulus = _plane_strain(youngs_modulus, poisson_ratio)
    return np.sqrt(np.pi / 2 * p / (modulus * np.tan(np.radians(half_angle)))) / UM_PER_NM


def _plane_strain(youngs_modulus: float, poisson_ratio: float) -> float:
    return youngs_modulus / (1 - poisson_ratio**2)
