"""A rigid sphere at a given depth in a linear viscoelastic, incompressible half-space, while contact does not shrink.

    P(t) = (8/3) sqrt(R) int_0^t Y(t - t') d(h^(3/2))

This is Hertz' solution with E/(1 - nu^2) = 4G at nu = 0.5 and 2G replaced by the hereditary operator Y. Assumes a
contact much smaller than the sphere, small strains, and no friction.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845-854.
"""

from __future__ import annotations

import numpy as np

from palpate.analytic.relaxation_modulus import RelaxationModulus
from palpate.study.protocol import Protocol

EXPONENT = 1.5


def factor(radius: float) -> float:
    """Return P over the hereditary integral [mN / (GPa um^1.5)]; radius in nm."""
    return float(8 / 3 * np.sqrt(1e-3 * radius))


def load(modulus: RelaxationModulus, protocol: Protocol, radius: float) -> np.ndarray:
    """Return the load [mN] (n,) at the sampling times of a prescribed depth; raises `InputError` where that falls."""
    return factor(radius) * modulus.hereditary_integral(protocol, EXPONENT)
