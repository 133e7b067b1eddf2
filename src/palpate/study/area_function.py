r"""Area function of a tip: A(h_c) = C_0 h_c^2 + C_1 h_c + C_2 h_c^(1/2) + C_3 h_c^(1/4) + ...

(Oliver and Pharr 1992, J. Mater. Res. 7, 1564, eq. 20). The first term is the ideal tip, 24.5 for a Berkovich pyramid
and for the cone of half-angle 70.3 degrees; the others describe its rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError

BERKOVICH = 24.5  # C_0 of the ideal tip, 3 sqrt(3) tan(65.27 degrees)^2 rounded
GIVE_COEFFICIENTS = "give the list [C_0, C_1, ...] of A = C_0 h^2 + C_1 h + C_2 h^(1/2) + ..., in nm"  # a remedy
DEPTHS = 400  # chosen: so many depths resolve a stretch to 2 % over four decades


@dataclass(frozen=True)
class AreaFunction:
    """Projected contact area against contact depth.

    Parameters
    ----------
    coefficients
        C_0, C_1, ...: any number of terms; C_n multiplies h_c^(2 / 2^n), so its unit is nm^(2 - 2 / 2^n).
    """

    coefficients: tuple[float, ...] = (BERKOVICH,)

    def __post_init__(self) -> None:
        if not self.coefficients:
            raise InputError("the area function has no terms", remedy="give C_0 at least", place="coefficients")

    def area(self, contact_depth: np.ndarray) -> np.ndarray:
        """Return the projected area (...,) [nm^2] at contact depths (...,) [nm]."""
        depth = np.asarray(contact_depth, dtype=float)
        terms = np.stack([depth ** (2.0 / 2**n) for n in range(len(self.coefficients))], axis=-1)
        return terms @ np.array(self.coefficients)

    def holds_between(self, shallowest: float, deepest: float) -> tuple[float, float]:
        """Return the ends of the longest stretch of depths [nm], by their ratio, where the area is positive and grows.

        A series that was fitted to a calibration does not hold outside the depths of that. Both ends are equal where
        there is no such stretch between `shallowest` and `deepest`.
        """
        depth = np.geomspace(shallowest, deepest, DEPTHS)
        area = self.area(depth)
        sound = (area[:-1] > 0.0) & (np.diff(area) > 0.0)
        ends = np.flatnonzero(np.diff(np.concatenate([[False], sound, [False]]).astype(int)))
        if not len(ends):
            return shallowest, shallowest
        first, last = max(zip(ends[::2], ends[1::2], strict=True), key=lambda pair: pair[1] - pair[0])
        return float(depth[first]), float(depth[last])
