r"""How the load of a tip grows beyond first contact: the laws that a search for contact weighs against one another.

With :math:`x = (h - h_0) / (h_e - h_0)`, the way into the body as a share of that at the end of the fit,

    P / P_e = x^m              flat punch m = 1, Hertz's sphere 3/2, Sneddon's cone 2,
    P / P_e ~ x^{3/2}, then (x + c/3)^2 beyond x = c      a sphere that passes into a cone.

The last is the law of every real pyramid; its value and slope are continuous at c. Sources: I.N. Sneddon, Int. J. Eng.
Sci. 3 (1965) 47-57 (m of flat, paraboloid and cone); the rounded cone by matching Hertz's value and slope.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

NAMED = (1.0, 1.5, 2.0)  # exponents of punch, sphere and cone
STEEPEST = 2.5  # largest exponent on trial
ON_NAMED, ON_EXPONENTS, ON_CAPS = 0.17, 0.24, 0.25  # prior weights: each named law, all exponents, all rounded cones
SHALLOWEST_CAP = 0.02  # least c on trial
LEFT = 1e-4  # of the largest weight, with which a law stays on trial


@dataclass(frozen=True)
class Laws:
    """Laws on trial: exponents and caps of rounded cones, spread over ranges that a search narrows.

    The ranges (lower, upper) are those of m, and of c as a share of the way into the body.
    """

    exponents: tuple[float, float] = (1.0, STEEPEST)
    caps: tuple[float, float] = (SHALLOWEST_CAP, 1.0)

    @property
    def powers(self) -> np.ndarray:
        """Exponents on trial (k,), with the named ones among them."""
        lower, upper = self.exponents
        spread = np.unique(np.round([*np.linspace(lower, upper, 6), *NAMED], 9))
        return spread[(spread >= lower - 1e-9) & (spread <= upper + 1e-9)]

    @property
    def rounded(self) -> np.ndarray:
        """Caps on trial (6,)."""
        return np.geomspace(*self.caps, 6)

    def __len__(self) -> int:
        return len(self.powers) + len(self.rounded)

    @property
    def log_prior(self) -> np.ndarray:
        """Logarithm of the prior weight of each law (len(self),)."""
        powers, caps = self.powers, np.log(self.rounded)
        weight = ON_EXPONENTS * _widths(powers) / (STEEPEST - 1.0)
        weight += ON_NAMED * np.isin(powers, NAMED)
        on_caps = ON_CAPS * _widths(caps) / -np.log(SHALLOWEST_CAP)
        return np.log(np.maximum(np.append(weight, on_caps), 1e-300))

    def loads(self, depth: np.ndarray, contacts: np.ndarray, end: float) -> np.ndarray:
        """Return loads (n, k, len(self)) at depths (n,) for contacts (k,), one at the depth `end`."""
        way = np.clip(depth[:, None] - contacts, 0.0, None) / (end - contacts)
        with np.errstate(divide="ignore"):
            powers = np.exp(np.log(way)[:, :, None] * self.powers)
        cap, round_ = self.rounded, (way * np.sqrt(way))[:, :, None]
        way, round_ = way[:, :, None], 16 / 9 * np.sqrt(cap) * round_
        sharp = (way + cap / 3) ** 2
        return np.concatenate([powers, np.where(way > cap, sharp, round_) / (1 + cap / 3) ** 2], axis=2)

    def narrowed(self, weight: np.ndarray) -> Laws:
        """Return laws spread over what the posterior weights (len(self),) leave of each range, each by itself."""
        powers, caps = self.powers, self.rounded
        return Laws(_kept(powers, weight[: len(powers)]), _kept(caps, weight[len(powers) :]))


def _widths(values: np.ndarray) -> np.ndarray:
    """Return the width of the cell about each value (n,), ends halved."""
    steps = np.diff(values)
    return 0.5 * (np.append(0.0, steps) + np.append(steps, 0.0))


def _kept(values: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Return the range of values (n,) with any weight, one more on either side."""
    inside = np.flatnonzero(weight >= LEFT * weight.max())
    return float(values[max(inside[0] - 1, 0)]), float(values[min(inside[-1] + 1, len(values) - 1)])
