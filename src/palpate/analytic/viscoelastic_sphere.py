"""A rigid sphere on a linear viscoelastic, incompressible half-space, while contact grows.

    h(t)^(3/2) = 3/(8 sqrt(R)) int_0^t J(t - t') dP(t')

This is Hertz' solution with E/(1 - nu^2) = 4G at nu = 0.5 and 1/(2G) replaced by the hereditary operator J. Holds
while the contact area does not shrink; assumes a contact much smaller than the sphere, small strains, and no
friction.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; K. L. Johnson, Contact Mechanics (1985), section
6.5.
"""

from __future__ import annotations

import numpy as np

from palpate.analytic.linear_viscoelastic import LinearBurgers
from palpate.study.protocol import Protocol


def depth(solid: LinearBurgers, protocol: Protocol, radius: float) -> np.ndarray:
    """Return the depth [nm] at the protocol's sampling times, shape (n,); radius in nm.

    Raises
    ------
    InputError
        When the load falls before the last sample.
    """
    root = np.sqrt(radius * 1e-3)
    return 1e3 * (3 / (8 * root) * solid.hereditary_integral(protocol)) ** (2 / 3)
