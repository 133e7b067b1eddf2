"""The profile of a rigid axisymmetric indenter, and which surface nodes it touches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from palpate.indenters import Indenter


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
