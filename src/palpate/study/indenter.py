"""Indenters: cones, spheres, cones with a spherical tip, Berkovich pyramids, area functions; rigid or elastic."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from palpate.base.parameters import Parameter, check_values, is_finite_number
from palpate.errors import InputError
from palpate.study.area_function import GIVE_COEFFICIENTS, AreaFunction

HALF_ANGLE = Parameter("half_angle", r"\alpha", "deg", 20.0, 89.0, "half-angle of the cone, from its axis")
FACE_ANGLE = Parameter("face_angle", r"\theta", "deg", 20.0, 89.0, "angle between face and axis", default=65.27)
RADIUS = Parameter("radius", "R", "nm", 1e-3, 1e9, "radius of the sphere or of the spherical cap")
BALL = Parameter("radius", "R", "nm", 0.0, 1e9, "radius of the ball that rounds apex and edges", default=0.0)
FRICTION = Parameter("friction", r"\mu", "-", 0.0, 0.5, "Coulomb friction coefficient", default=0.0)
MODULUS = Parameter("modulus", "E_i", "GPa", 1.0, 5000.0, "Young's modulus of the indenter", default=math.inf)
POISSON_RATIO = Parameter("poisson_ratio", r"\nu_i", "-", 0.0, 0.4999, "its Poisson's ratio", default=0.0)
SURFACE = (FRICTION, MODULUS, POISSON_RATIO)
EQUAL_SECTIONS = math.sqrt(math.pi / math.sqrt(27.0))  # slope of a cone over that of the faces of a pyramid as wide
SHAPES = {
    "cone": (HALF_ANGLE, *SURFACE),
    "sphere": (RADIUS, *SURFACE),
    "sphero_cone": (HALF_ANGLE, RADIUS, *SURFACE),
    "berkovich": (FACE_ANGLE, BALL, *SURFACE),
    "area_function": SURFACE,
}
AREA = "area"  # the coefficients of an area function, a list
GROWS_FROM, GROWS_TO = 1.0, 1e4  # nm; depths between which an area function is looked at
LEAST_STRETCH = 10.0  # ratio of depths over which it must be positive and grow; a test needs about as much


@dataclass(frozen=True)
class Indenter:
    """An indenter.

    Parameters
    ----------
    shape
        ``cone``, ``sphere``, ``sphero_cone``, ``berkovich``, a three-sided pyramid, or ``area_function``.
    half_angle
        Half-angle of the cone [deg]; 0 for other shapes.
    radius
        Radius of the sphere or cap [nm]; 0 for other shapes. The cap runs tangentially into the cone. A
        pyramid's is that of a ball that rolls inside the sharp one, so that edges are rounded, too.
    friction
        Coulomb coefficient.
    modulus, poisson_ratio
        Of the indenter itself [GPa], [-]; infinite for a rigid one. See `palpate.study.specimen.under_tip`.
    face_angle
        Between a pyramid's faces and its axis [deg]; 0 for other shapes.
    area
        Coefficients of the area function, see `palpate.study.area_function`; none for other shapes.
    """

    shape: str
    half_angle: float = 0.0
    radius: float = 0.0
    friction: float = 0.0
    modulus: float = math.inf
    poisson_ratio: float = 0.0
    face_angle: float = 0.0
    area: tuple[float, ...] = ()

    @classmethod
    def from_mapping(cls, values: Mapping[str, object]) -> Indenter:
        """Build from configuration keys; raises `InputError` on an unknown shape, key or value out of range."""
        shape = values.get("shape")
        if not isinstance(shape, str) or shape not in SHAPES:
            raise InputError(
                f"indenter shape {shape!r} is not known", remedy=f"use one of: {', '.join(SHAPES)}", place="shape"
            )
        given = {name: value for name, value in values.items() if name != "shape"}
        area = _checked_area(given.pop(AREA, None)) if shape == "area_function" else ()
        return cls(shape, **check_values(SHAPES[shape], given, f"indenter {shape}"), area=area)

    @property
    def of_revolution(self) -> bool:
        """Whether the indenter is axisymmetric."""
        return self.shape != "berkovich"

    @property
    def sharp(self) -> bool:
        """Whether the tip has no length scale of its own."""
        return self.radius == 0.0 and not self.area

    @property
    def holds_between(self) -> tuple[float, float]:
        """Depths [nm] between which an area function is used; the tip runs straight to its apex and beyond them."""
        return AreaFunction(self.area).holds_between(GROWS_FROM, GROWS_TO) if self.area else (0.0, math.inf)

    @property
    def slope(self) -> float:
        """Slope dz/dr of the conical flank, cot(half_angle); infinite for a sphere.

        A pyramid has that of the cone whose sections are as large: 3 sqrt(3) slope^2 = pi cot^2(face_angle); an area
        function that of its first term.
        """
        if self.area:
            return math.sqrt(math.pi / self.area[0]) if self.area[0] > 0.0 else math.inf
        if self.face_angle:
            return EQUAL_SECTIONS * self.face_slope
        return 1.0 / math.tan(math.radians(self.half_angle)) if self.half_angle else math.inf

    def of_half_angle(self, half_angle: float) -> Indenter:
        """Return the cone with another half-angle [deg], or the pyramid whose equivalent cone has it.

        Raises
        ------
        InputError
            For a shape that has none.
        """
        if self.face_angle:
            face_angle = math.degrees(math.atan(EQUAL_SECTIONS * math.tan(math.radians(half_angle))))
            return replace(self, face_angle=face_angle)
        if not self.half_angle:
            raise InputError(f"shape {self.shape} has no half-angle", remedy="use a cone", place="shape")
        return replace(self, half_angle=half_angle)

    @property
    def equivalent_cone(self) -> Indenter:
        """A pyramid's cone whose sections are as large, rounded alike; other shapes are their own."""
        if not self.face_angle:
            return self
        shape, half_angle = "sphero_cone" if self.radius else "cone", math.degrees(math.atan(1.0 / self.slope))
        return replace(self, shape=shape, half_angle=half_angle, face_angle=0.0)

    @property
    def face_slope(self) -> float:
        """Slope of a pyramid's face along its middle, cot(face_angle)."""
        return 1.0 / math.tan(math.radians(self.face_angle))

    @property
    def compliance(self) -> float:
        """Inverse plane-strain modulus (1 - nu_i^2) / E_i of the indenter [1/GPa]; zero for a rigid one."""
        return (1.0 - self.poisson_ratio**2) / self.modulus


def _checked_area(given: object) -> tuple[float, ...]:
    """Return the coefficients of an area function, or raise `InputError` where they are no tip."""
    if not isinstance(given, list) or not given or not all(map(is_finite_number, given)):
        raise InputError(f"{AREA} is {given!r}, expected coefficients", remedy=GIVE_COEFFICIENTS, place=AREA)
    area = tuple(map(float, given))
    low, high = AreaFunction(area).holds_between(GROWS_FROM, GROWS_TO)
    if high < LEAST_STRETCH * low:
        raise InputError(
            f"{AREA} is positive and grows over no stretch of depths between {GROWS_FROM:g} and {GROWS_TO:g} nm",
            remedy=GIVE_COEFFICIENTS,
            place=AREA,
        )
    check_cone(AreaFunction(area), high)
    return area


def check_cone(tip: AreaFunction, depth: float) -> None:
    """Refuse an area function whose cross-section at a depth [nm] is that of no cone of an admissible half-angle.

    Raises
    ------
    InputError
        As where the areas are in um^2 and the depths in nm.
    """
    half_angle = math.degrees(math.atan(math.sqrt(float(tip.area(np.array(depth))) / math.pi) / depth))
    if not HALF_ANGLE.lower <= half_angle <= HALF_ANGLE.upper:
        raise InputError(
            f"{AREA} at {depth:.4g} nm is that of a cone of half-angle {half_angle:.3g} degrees, expected "
            f"{HALF_ANGLE.lower:g} to {HALF_ANGLE.upper:g}",
            remedy=GIVE_COEFFICIENTS,
            place=AREA,
        )
