r"""How the load of a tip grows beyond first contact: the laws that a search for contact weighs against one another.

With :math:`x = (h - h_0) / (h_e - h_0)`, the way into the body as a share of that at the end of the fit,

    P / P_e = x^m              flat punch m = 1, Hertz's sphere 3/2, Sneddon's cone 2,
    P / P_e ~ x^{3/2}, then (x + c/3)^2 beyond x = c      a sphere that passes into a cone.

The last is the law of every real pyramid; its value and slope are continuous at c. Sources: I.N. Sneddon, Int. J. Eng.
Sci. 3 (1965) 47-57 (m of flat, paraboloid and cone); the rounded cone by matching Hertz's value and slope.
"""

from __future__ import annotations

import numpy as np

NAMED = (1.0, 1.5, 2.0)  # exponents of punch, sphere and cone
STEEPEST = 2.5  # largest exponent on trial
ON_NAMED, ON_EXPONENTS, ON_CAPS = 0.17, 0.24, 0.25  # prior weights: each named law, all exponents, all rounded cones
SHALLOWEST_CAP = 0.02  # least c on trial
POWERS = np.unique(np.round([*np.linspace(1.0, STEEPEST, 6), *NAMED], 9))  # exponents on trial
CAPS = np.geomspace(SHALLOWEST_CAP, 1.0, 4)  # caps of rounded cones on trial, c


def loads_of_laws(depth: np.ndarray, contacts: np.ndarray, end: float) -> np.ndarray:
    """Return the loads (n, k, laws) of each law at depths (n,) for contacts (k,), one at the depth `end`."""
    way = np.clip(depth[:, None] - contacts, 0.0, None) / (end - contacts)
    with np.errstate(divide="ignore"):
        powers = np.exp(np.log(way)[:, :, None] * POWERS)
    way, round_ = way[:, :, None], 16 / 9 * np.sqrt(CAPS) * (way * np.sqrt(way))[:, :, None]
    sharp = (way + CAPS / 3) ** 2
    return np.concatenate([powers, np.where(way > CAPS, sharp, round_) / (1 + CAPS / 3) ** 2], axis=2)


def _log_prior() -> np.ndarray:
    """Return the logarithm of the prior weight of each law (laws,)."""
    weight = ON_EXPONENTS * _widths(POWERS) / (STEEPEST - 1.0) + ON_NAMED * np.isin(POWERS, NAMED)
    on_caps = ON_CAPS * _widths(np.log(CAPS)) / -np.log(SHALLOWEST_CAP)
    return np.log(np.append(weight, on_caps))


def _widths(values: np.ndarray) -> np.ndarray:
    """Return the width of the cell about each value (n,), ends halved."""
    steps = np.diff(values)
    return 0.5 * (np.append(0.0, steps) + np.append(steps, 0.0))


LOG_PRIOR = _log_prior()
