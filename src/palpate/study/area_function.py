r"""Area function of a tip: A(h_c) = C_0 h_c^2 + C_1 h_c + C_2 h_c^(1/2) + C_3 h_c^(1/4) + ...

(Oliver and Pharr 1992, J. Mater. Res. 7, 1564, eq. 20). The first term is the ideal tip, 24.5 for a Berkovich pyramid
and for the cone of half-angle 70.3 degrees; the others describe its rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError

BERKOVICH = 24.5
DEPTHS = 400


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
        return _terms(np.asarray(contact_depth, dtype=float), len(self.coefficients)) @ np.array(self.coefficients)

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

    @classmethod
    def calibrated(
        cls, contact_depth: np.ndarray, area: np.ndarray, terms: int, first: float | None = BERKOVICH
    ) -> AreaFunction:
        """Fit the coefficients to areas measured on a reference material, with relative residuals.

        Parameters
        ----------
        contact_depth, area : ndarray, shape (n,)
            [nm], [nm^2].
        terms
            Number of terms.
        first
            C_0 held at this value; ``None`` fits it too.

        Raises
        ------
        InputError
            With fewer measurements than coefficients to fit.
        """
        contact_depth, area = np.asarray(contact_depth, dtype=float), np.asarray(area, dtype=float)
        free = terms - (first is not None)
        if len(area) < free or terms < 1:
            raise InputError(f"{len(area)} areas cannot fix {free} coefficients", remedy="use fewer terms")
        columns = _terms(contact_depth, terms) / area[:, None]
        if first is None:
            return cls(tuple(map(float, np.linalg.lstsq(columns, np.ones(len(area)))[0])))
        rest = np.linalg.lstsq(columns[:, 1:], 1 - first * columns[:, 0])[0] if terms > 1 else []
        return cls((float(first), *map(float, rest)))


def _terms(depth: np.ndarray, count: int) -> np.ndarray:
    return np.stack([depth ** (2.0 / 2**n) for n in range(count)], axis=-1)
