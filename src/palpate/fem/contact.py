"""What holds where a rigid axisymmetric indenter touches: its profile, and Coulomb friction along its generator.

The indenter moves along z only, so a node that touches it at the distance R from the axis slips exactly when R changes.
Its friction T = -m N opposes the slip since first touch, up to the limit |m| = mu,

    m = mu clip((R - A) / (ELASTIC_SLIP r), -1, 1),

with the anchor A: R at first touch, dragged along when the node slips. The little slip that precedes the limit
stands for sticking; in proportion to the node's own distance r and normal force N, it adds no length to a sharp cone.
(Elastic-plastic analogy: Wriggers, Computational Contact Mechanics, 2nd ed. (2006), section 5.2.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from palpate.indenters import Indenter

SLOPE, CURVATURE, RATIO, RATIO_SLOPE = range(4)
ELASTIC_SLIP = 1e-4


@dataclass(frozen=True)
class Profile:
    """Height f(r) of an indenter above its apex, with slope and curvature: a cap that runs tangentially into a cone.

    Parameters
    ----------
    slope
        df/dr of the flank; infinite for a sphere.
    radius
        Radius of the cap [um]; zero for a sharp cone.
    """

    slope: float
    radius: float

    @classmethod
    def of(cls, indenter: Indenter) -> Profile:
        """Return the profile of an indenter, in um."""
        return cls(indenter.slope, indenter.radius * 1e-3)

    @property
    def junction(self) -> float:
        """Distance from the axis at which the cap meets the flank [um]."""
        return self.radius / math.sqrt(1.0 + self.slope**-2) if math.isfinite(self.slope) else self.radius

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return f, df/dr and d2f/dr2 at distances `r` [um]; a sphere continues flat beyond 0.99 of its radius."""
        if self.radius == 0.0:
            return self.slope * r, np.full_like(r, self.slope), np.zeros_like(r)
        edge = min(self.junction, 0.99 * self.radius)
        root = np.sqrt(self.radius**2 - np.minimum(r, edge) ** 2)
        slope = np.minimum(r, edge) / root
        on_cap = r < edge
        height = self.radius - root + np.where(on_cap, 0.0, (r - edge) * slope)
        return height, slope, np.where(on_cap, self.radius**2 / root**3, 0.0)

    def depth_for(self, r: float) -> float:
        """Return f at one distance [um]."""
        return float(self(np.array([r]))[0][0])


@dataclass(frozen=True)
class Friction:
    """Coulomb friction of the surface nodes.

    Parameters
    ----------
    coefficient
        mu.
    reach : ndarray, shape (k,)
        Slip at which a node that stuck reaches the limit [um].
    """

    coefficient: float
    reach: np.ndarray

    @classmethod
    def of(cls, coefficient: float, r: np.ndarray) -> Friction:
        """Return the friction of nodes at the undeformed distances `r` (k,) [um]."""
        return cls(coefficient, ELASTIC_SLIP * np.maximum(r, r[1]))

    def slip(self, distance: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """Return (R - A) / reach of nodes at the distances R; zero for one that did not touch before (anchor NaN)."""
        return np.nan_to_num((distance - anchor) / self.reach)

    def ratio(self, slip: np.ndarray, anchor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return m and dm/dR."""
        sticks = (np.abs(slip) < 1.0) & np.isfinite(anchor)
        return self.coefficient * np.clip(slip, -1.0, 1.0), np.where(sticks, self.coefficient / self.reach, 0.0)

    def dragged(self, distance: np.ndarray, anchor: np.ndarray, contact: np.ndarray) -> np.ndarray:
        """Return the anchors at the end of a step; a node that touches since this step is anchored where it is."""
        known = np.where(np.isfinite(anchor), anchor, distance)
        return np.where(contact, np.clip(known, distance - self.reach, distance + self.reach), np.nan)
