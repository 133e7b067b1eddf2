"""The tip of a draft: as it was given, as the files state it, or a Berkovich tip's equivalent cone, a guess."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.analytic import hertz, sneddon
from palpate.classical.oliver_pharr import DIAMOND
from palpate.draft.stated import Stated
from palpate.errors import InputError
from palpate.study.area_function import BERKOVICH, AreaFunction
from palpate.study.indenter import Indenter

BERKOVICH_CONE = 70.3  # degrees; its sections are as large as those of the pyramid at the same depths
EQUIVALENT_CONES = {"berkovich": BERKOVICH_CONE, "vickers": 70.3, "cube corner": 42.28}  # half-angles [degrees]
ROUND_TO = 0.1  # radii of depth to which the round end of a cone decides
THINNEST = 0.5  # of the ideal tip's area, that an area function gives at least where it was calibrated
FILES = "as the files state"


def unusable(area: Sequence[float], depth: float) -> str:
    """Return why an area function cannot be used for tests of a depth [nm], 0 if unknown; empty where it can.

    A tip is blunter than the ideal one, whose area is the first term; a series that falls far below that has left the
    depths of its calibration.
    """
    try:
        low, high = Indenter.from_mapping({"shape": "area_function", "area": list(area)}).holds_between
    except InputError as error:
        return error.problem
    if not depth:
        return ""
    if not low < depth < high:
        return f"it is positive and grows from {low:.3g} to {high:.3g} nm, where the tests do not lie"
    found, ideal = float(AreaFunction(tuple(area)).area(np.array(depth))), area[0] * depth**2
    if found < THINNEST * ideal:
        return f"at the tests' {depth:.3g} nm it gives {found / ideal:.0%} of the area that its first term does"
    return ""


@dataclass(frozen=True)
class KnownTip:
    """A tip with where it is known from.

    Parameters
    ----------
    keys
        Of a study's ``indenter``.
    why
        Where it is known from.
    """

    keys: Mapping[str, object] = field(default_factory=lambda: {"shape": "cone", "half_angle": BERKOVICH_CONE})
    why: str = "guess: a Berkovich tip, by its equivalent cone"

    @classmethod
    def of(cls, stated: Stated, sphere: float | None, deepest: float) -> KnownTip:
        """Return the tip that was given as a sphere of a radius [nm], is stated, or is guessed.

        A radius that is stated without a shape is a sphere's where a test is less than one radius deep, else that of
        the end of a pyramid.

        Parameters
        ----------
        deepest
            Largest depth of all tests [nm].
        """
        if sphere is not None:
            return cls({"shape": "sphere", "radius": sphere}, "nm, as given")
        if stated.area and not unusable(stated.area, deepest):
            keys: dict[str, object] = {"shape": "area_function", "area": list(stated.area)}
            low = Indenter.from_mapping(keys).holds_between[0]
            return cls(keys, f"nm, {FILES}" + (f", from {low:.3g} nm on, where it grows" if low > 1.0 else ""))
        angle = EQUIVALENT_CONES.get(stated.shape)
        if stated.radius and (stated.shape == "sphere" or (angle is None and deepest < stated.radius)):
            return cls({"shape": "sphere", "radius": stated.radius}, f"nm, {FILES}")
        if stated.radius:
            known = FILES if angle else f"{FILES}; the angle is a guess"
            keys = {"shape": "sphero_cone", "half_angle": angle or BERKOVICH_CONE, "radius": stated.radius}
            return cls(keys, f"nm, {known}")
        if angle:
            return cls({"shape": "cone", "half_angle": angle}, f"{FILES}: {stated.shape}, by its equivalent cone")
        if stated.sphere and not stated.shape:
            keys = {"shape": "sphere", "radius": float(f"{stated.sphere:.3g}")}
            return cls(keys, "nm, from the contact area and depth that the files state")
        return cls()

    @property
    def of_diamond(self) -> KnownTip:
        """The same tip with the elastic constants of diamond (Oliver and Pharr, J. Mater. Res. 7 (1992) 1564)."""
        modulus, poisson_ratio = DIAMOND
        return replace(self, keys={**self.keys, "modulus": modulus, "poisson_ratio": poisson_ratio})

    @property
    def area(self) -> tuple[float, ...]:
        """Coefficients of the area function [nm]; none without."""
        return tuple(self.keys.get("area", ()))  # type: ignore[arg-type]

    @property
    def radius(self) -> float:
        """Of the sphere or the round end [nm]; zero without."""
        return float(self.keys.get("radius", 0.0))  # type: ignore[arg-type]

    @property
    def half_angle(self) -> float:
        """Of the cone, or of that whose sections are those of the first term of the area function [degrees]."""
        first = self.area[0] if self.area else 0.0
        angle = math.degrees(math.atan(math.sqrt(first / math.pi))) if first > 0.0 else BERKOVICH_CONE
        return float(self.keys.get("half_angle", angle))  # type: ignore[arg-type]

    def rounded_at(self, depth: float) -> bool:
        """Return whether a sphere describes it at a depth [nm], rather than a cone."""
        return bool(self.radius) and (self.keys["shape"] == "sphere" or depth < ROUND_TO * self.radius)

    def area_at(self, depth: float) -> AreaFunction:
        """Return the area function that describes it at a depth [nm]."""
        if self.area:
            return AreaFunction(self.area)
        if self.rounded_at(depth):
            return AreaFunction((-np.pi, 2.0 * np.pi * self.radius))
        first = np.pi * math.tan(math.radians(self.half_angle)) ** 2
        first = BERKOVICH if self.half_angle == BERKOVICH_CONE else first
        blunted = self.radius * (1.0 / math.sin(math.radians(self.half_angle)) - 1.0)
        return AreaFunction((float(first), 2.0 * float(first) * blunted))

    def elastic_load(self, depth: float, poisson_ratio: float) -> float:
        """Return the load [mN] at a depth [nm] on an elastic half-space of 1 GPa (Sneddon 1965, Hertz 1882)."""
        if self.rounded_at(depth):
            return float(hertz.load(depth, 1.0, poisson_ratio, self.radius))
        return float(sneddon.load(depth, 1.0, poisson_ratio, self.half_angle))
