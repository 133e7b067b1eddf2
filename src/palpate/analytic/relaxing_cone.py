"""A rigid cone at a given depth in a linear viscoelastic, incompressible half-space, while contact does not shrink.

    P(t) = (4/pi) tan(alpha) int_0^t Y(t - t') d(h^2)

This is Sneddon's solution with E/(1 - nu^2) = 4G at nu = 0.5 and 2G replaced by the hereditary operator Y. Assumes a
shallow frictionless cone and small strains.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845-854.
"""

from __future__ import annotations

import numpy as np

from palpate.analytic.relaxation_modulus import RelaxationModulus
from palpate.study.protocol import Protocol

EXPONENT = 2.0


def factor(half_angle: float) -> float:
    """Return P over the hereditary integral [mN / (GPa um^2)]; half-angle in degrees."""
    return float(4 / np.pi * np.tan(np.radians(half_angle)))


def load(modulus: RelaxationModulus, protocol: Protocol, half_angle: float) -> np.ndarray:
    """Return the load [mN] (n,) at the sampling times of a prescribed depth; raises `InputError` where that falls."""
    return factor(half_angle) * modulus.hereditary_integral(protocol, EXPONENT)
