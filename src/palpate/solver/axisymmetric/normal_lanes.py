"""The normal distribution in SIMD lanes.

The complementary error function is exp(-z^2) times a function that varies slowly. With 1 + 2 z that is a polynomial in
(z - 3) / (z + 3), to rounding (M. M. Shepherd & J. G. Laframboise, Math. Comp. 36 (1981) 249-253). Its coefficients are
those of the Chebyshev series that interpolates scipy's function.
"""

from __future__ import annotations

import math
from typing import Any

from numpy.polynomial.chebyshev import chebinterpolate
from scipy.special import erfcx

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import exponential, magnitude, smaller, splat, where_less

FARTHEST = 11.0  # standard deviations that x counts at most
MIDDLE, DEGREE = 3.0, 18  # of the polynomial; with these the tail errs by 3e-15 of itself
_HALF_SPAN = math.sqrt(0.5) * FARTHEST / (math.sqrt(0.5) * FARTHEST + MIDDLE)


def _slow_factor(t: Any) -> Any:
    """Return (1 + 2 z) exp(z^2) erfc(z) at numbers from -1 to 1."""
    part = _HALF_SPAN * (t + 1.0) - 1.0
    z = MIDDLE * (1.0 + part) / (1.0 - part)
    return (1.0 + 2.0 * z) * erfcx(z)


_COEFFICIENTS = tuple(map(float, chebinterpolate(_slow_factor, DEGREE)))


@inner_kernel(cache=True, error_model="numpy")
def normal_distribution(x):
    """Return Phi(x) and its density phi(x), at `FARTHEST` where x lies farther out."""
    z = math.sqrt(0.5) * smaller(magnitude(x), splat(FARTHEST))
    part = (z - MIDDLE) / (z + MIDDLE)
    t = (part + 1.0) * (1.0 / _HALF_SPAN) - 1.0
    last, before = splat(_COEFFICIENTS[DEGREE]), splat(0.0)
    for k in range(DEGREE - 1, 0, -1):
        last, before = 2.0 * t * last - before + _COEFFICIENTS[k], last
    slow = (t * last - before + _COEFFICIENTS[0]) / (1.0 + 2.0 * z)
    decay = exponential(splat(0.0) - z * z)
    tail = 0.5 * decay * slow
    return where_less(x, splat(0.0), tail, 1.0 - tail), decay * (1.0 / math.sqrt(2.0 * math.pi))
