"""The residual profile of an imprint: height over the distance from its middle, and how it is read from a CSV."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from indentation_files.errors import InputError, located_in
from indentation_files.recording import check_numbers
from indentation_files.recording_file import read_table

HEADER = "radius_nm,height_nm"
FEWEST = 5  # points
SHALLOWEST = 1.0  # nm; what is less deep is in um, or no imprint


@dataclass(frozen=True, eq=False)
class ImprintProfile:
    """Heights above the surface around, averaged over all directions; negative within the imprint.

    `radius` and `height` (n,) are in nm, the radius increasing from zero or above. Raises `InputError` when there are
    too few points, one is not a number, radii do not increase, or there is no imprint.
    """

    radius: np.ndarray
    height: np.ndarray
    name: str = ""

    def __post_init__(self) -> None:
        if len(self.radius) < FEWEST:
            raise InputError(f"it has {len(self.radius)} points", remedy=f"give {FEWEST} or more")
        check_numbers(dict(zip(HEADER.split(","), (self.radius, self.height), strict=True)))
        if self.radius[0] < 0.0 or np.any(np.diff(self.radius) <= 0.0):
            problem = "the radius does not increase from zero or above"
            raise InputError(problem, remedy="sort the points, and average both sides", place="radius_nm")
        if -self.height.min() < SHALLOWEST:
            problem = f"the deepest point lies at {self.height.min():.3g} nm: no imprint, or heights in um"
            raise InputError(problem, remedy="give nm, negative below the surface around", place="height_nm")


def read_imprint(path: str | Path) -> ImprintProfile:
    """Read a CSV with the header `HEADER`; raises `InputError` when it is missing, has another, or holds no imprint."""
    path = Path(path)
    (radius, height), _ = read_table(path, HEADER)
    with located_in(path):
        return ImprintProfile(radius, height, path.stem)
