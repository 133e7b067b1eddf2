"""A rigid cone on a linear viscoelastic, incompressible half-space, while contact grows.

    h(t)^2 = pi/(4 tan(alpha)) int_0^t J(t - t') dP(t')

This is Sneddon's solution with E/(1 - nu^2) = 4G at nu = 0.5 and 1/(2G) replaced by the hereditary operator J. Holds
while the contact area does not shrink; assumes a shallow frictionless cone and small strains.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845-854,
for any axisymmetric shape; K. L. Johnson, Contact Mechanics (1985), section 6.5.
"""

from __future__ import annotations

import numpy as np

from palpate.analytic.linear_viscoelastic import LinearBurgers
from palpate.study.protocol import Protocol


def depth(solid: LinearBurgers, protocol: Protocol, half_angle: float) -> np.ndarray:
    """Return the depth [nm] at the protocol's sampling times, shape (n,); half-angle in degrees.

    Raises
    ------
    InputError
        When the load falls before the last sample.
    """
    return 1e3 * np.sqrt(np.pi / (4 * np.tan(np.radians(half_angle))) * solid.hereditary_integral(protocol))
