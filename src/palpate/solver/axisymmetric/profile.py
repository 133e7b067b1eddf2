"""Profiles of rigid axisymmetric indenters: the height f(r) of their surface above the apex."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from palpate.study.area_function import AreaFunction
from palpate.study.indenter import GROWS_FROM, Indenter

SHALLOWEST, DEEPEST, KNOTS = 0.01, 1e4, 241  # nm; depths at which an area function is taken


class Profile:
    """Height f(r) of an indenter above its apex, with slope and curvature."""

    @staticmethod
    def of(indenter: Indenter) -> Profile:
        """Return the profile of an indenter, in um."""
        if indenter.area:
            return Measured(_meridian(indenter.area))
        return Capped(indenter.slope, indenter.radius * 1e-3)

    def in_units_of(self, unit: float) -> Profile:
        """Return the profile with lengths in units of so many um."""
        raise NotImplementedError

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return f, df/dr and d2f/dr2 at distances `r` [um]."""
        raise NotImplementedError

    def depth_for(self, r: float) -> float:
        """Return f at one distance [um]."""
        return float(self(np.array([r]))[0][0])

    def slope_for(self, r: float) -> float:
        """Return df/dr at one distance [um]."""
        return float(self(np.array([r]))[1][0])


@dataclass(frozen=True)
class Capped(Profile):
    """A cap that runs tangentially into a cone; each of them may be missing.

    Parameters
    ----------
    slope
        df/dr of the flank; infinite for a sphere.
    radius
        Radius of the cap [um]; zero for a sharp cone.
    """

    slope: float
    radius: float

    def in_units_of(self, unit: float) -> Capped:
        """Return the profile with lengths in units of so many um."""
        return replace(self, radius=self.radius / unit)

    @property
    def junction(self) -> float:
        """Distance from the axis at which the cap meets the flank [um]."""
        return self.radius / math.sqrt(1.0 + self.slope**-2) if math.isfinite(self.slope) else self.radius

    @property
    def edge(self) -> float:
        """Distance from the axis at which the cap ends: a sphere continues as a cone beyond 0.99 of its radius [um]."""
        return min(self.junction, 0.99 * self.radius)

    @property
    def flank(self) -> float:
        """df/dr beyond the cap."""
        return self.slope if self.radius == 0.0 else self.edge / math.sqrt(self.radius**2 - self.edge**2)

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return f, df/dr and d2f/dr2 at distances `r` [um]."""
        if self.radius == 0.0:
            return self.slope * r, np.full_like(r, self.slope), np.zeros_like(r)
        edge = self.edge
        root = np.sqrt(self.radius**2 - np.clip(r, -edge, edge) ** 2)
        slope = np.minimum(r, edge) / root
        on_cap = r < edge
        height = self.radius - root + np.where(on_cap, 0.0, (r - edge) * slope)
        return height, slope, np.where(on_cap, self.radius**2 / root**3, 0.0)


@dataclass(frozen=True, eq=False)
class Measured(Profile):
    """A profile by heights and slopes at some distances, cubic in between and straight beyond.

    Parameters
    ----------
    knots : ndarray, shape (m, 3)
        r, f [um] and df/dr; from the axis outwards.
    """

    knots: np.ndarray

    def in_units_of(self, unit: float) -> Measured:
        """Return the profile with lengths in units of so many um."""
        return Measured(self.knots / np.array([unit, unit, 1.0]))

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return f, df/dr and d2f/dr2 at distances `r` [um]."""
        place, height, slope = self.knots.T
        k = np.clip(np.searchsorted(place, r) - 1, 0, len(place) - 2)
        width = place[k + 1] - place[k]
        t = np.clip((r - place[k]) / width, 0.0, 1.0)
        rise, first, last = (height[k + 1] - height[k]) / width, slope[k], slope[k + 1]
        square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
        inclination = first + t * (2.0 * square + 3.0 * cube * t)
        curvature = np.where(r < place[-1], (2.0 * square + 6.0 * cube * t) / width, 0.0)
        beyond = np.maximum(r - place[-1], 0.0) * inclination
        return height[k] + width * t * (first + t * (square + cube * t)) + beyond, inclination, curvature


@lru_cache(maxsize=16)
def _meridian(coefficients: tuple[float, ...]) -> np.ndarray:
    """Return knots (m, 3) of the tip of revolution whose sections have the areas of an area function.

    Where they would make it hollow it is bridged straight, as a body that is pressed would see it from afar. So it is
    below the depths from which the areas are positive and grow.
    """
    function = AreaFunction(coefficients)
    low, high = function.holds_between(GROWS_FROM, DEEPEST)
    depth = np.geomspace(SHALLOWEST, DEEPEST, KNOTS)
    area = function.area(depth)
    sound = (area > 0.0) & ((depth >= low) | (low <= GROWS_FROM)) & (depth <= high)
    depth, area = depth[sound], area[sound]
    points = 1e-3 * np.column_stack([np.sqrt(area / np.pi), depth])
    hull = [np.zeros(2)]
    for point in points[np.argsort(points[:, 0], kind="stable")]:
        while len(hull) > 1 and _slope(hull[-2], hull[-1]) >= _slope(hull[-2], point):
            hull.pop()
        hull.append(point)
    r, f = np.array(hull).T
    secants = np.diff(f) / np.diff(r)
    inner = 2.0 * secants[:-1] * secants[1:] / (secants[:-1] + secants[1:])
    return np.column_stack([r, f, np.concatenate([secants[:1], inner, secants[-1:]])])


def _slope(begin: np.ndarray, end: np.ndarray) -> float:
    rise, run = end[1] - begin[1], end[0] - begin[0]
    return float(rise / run) if run > 0.0 else math.inf
