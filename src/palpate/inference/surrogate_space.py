"""The parameters of a calibration: which are free, and their coordinates scaled to [0, 1]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError


@dataclass(frozen=True, eq=False)
class Space:
    """Bounds of all parameters; one whose bounds are equal is held.

    Parameters
    ----------
    bounds
        (lower, upper) of each parameter, in the order of the surrogates' columns.

    Raises
    ------
    InputError
        When bounds are in the wrong order or no parameter is free.
    """

    bounds: Mapping[str, tuple[float, float]]

    def __post_init__(self) -> None:
        for name, (lower, upper) in self.bounds.items():
            if not lower <= upper:
                raise InputError(
                    f"bounds of {name} are {lower!r} to {upper!r}", remedy="put the smaller first", place=name
                )
        if not self.free.any():
            raise InputError(
                "every parameter is held", remedy="give one of them at least two levels", place="parameters"
            )

    @property
    def lower(self) -> np.ndarray:
        """Lower bounds (p,)."""
        return np.array([bound[0] for bound in self.bounds.values()], dtype=float)

    @property
    def extent(self) -> np.ndarray:
        """Upper less lower bounds (p,)."""
        return np.array([upper - lower for lower, upper in self.bounds.values()], dtype=float)

    @property
    def free(self) -> np.ndarray:
        """Whether each parameter is free (p,)."""
        return self.extent > 0

    @property
    def names(self) -> list[str]:
        """Names of the free parameters."""
        return [name for name, free in zip(self.bounds, self.free, strict=True) if free]

    @property
    def dimensions(self) -> int:
        """Number of free parameters k."""
        return int(self.free.sum())

    def physical(self, scaled: np.ndarray) -> np.ndarray:
        """Physical values (n, p) of scaled coordinates (n, k) of the free parameters."""
        scaled = np.atleast_2d(scaled)
        values = np.tile(self.lower, (len(scaled), 1))
        values[:, self.free] += scaled * self.extent[self.free]
        return values

    def named(self, scaled: np.ndarray) -> dict[str, float]:
        """Physical values by name of scaled coordinates (k,)."""
        return dict(zip(self.bounds, map(float, self.physical(scaled)[0]), strict=True))
