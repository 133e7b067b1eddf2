"""A uniaxial test of the bulk: time, logarithmic strain and true stress, and how it is read from a CSV."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from indentation_files.errors import InputError, located_in
from indentation_files.recording import check_numbers
from indentation_files.recording_file import read_table

HEADER = "time_s,strain,stress_GPa"
ENGINEERING = "engineering"  # comment: nominal stress and engineering strain, which are converted
COMPRESSION = "compression"  # comment: positive in compression
FEWEST = 5  # points
MOST = 400  # points that are kept: a law's response is compared at no more
STRAIN, STRESS = "strain", "stress"
HELD = 0.01  # of its range, within which a signal is held
HOLDS = 0.2  # share of the time by which the stress must be held longer than the strain, as in creep; chosen


@dataclass(frozen=True, eq=False)
class UniaxialTest:
    """Time, logarithmic strain and true stress of one test in tension or compression; tension is positive.

    `time` [s] increases, `strain` is a ratio, `stress` is in GPa, each (n,). Raises `InputError` when there are too few
    points, one is not a number, or a time does not increase.
    """

    time: np.ndarray
    strain: np.ndarray
    stress: np.ndarray
    name: str = ""

    def __post_init__(self) -> None:
        if len(self.time) < FEWEST:
            raise InputError(f"it has {len(self.time)} points", remedy=f"give {FEWEST} or more")
        check_numbers(dict(zip(HEADER.split(","), (self.time, self.strain, self.stress), strict=True)))
        steps = np.diff(self.time)
        if np.any(steps <= 0.0):
            point = int(np.flatnonzero(steps <= 0.0)[0]) + 1
            problem = f"time does not increase from point {point} ({self.time[point - 1]:g} s) to point {point + 1}"
            raise InputError(problem, remedy="sort the points and drop repeated times", place="time_s")

    @property
    def held_longer(self) -> str:
        """What its machine prescribed: the stress where it was held much longer than the strain, as in creep."""
        held = {key: _time_held(self.time, values) for key, values in ((STRAIN, self.strain), (STRESS, self.stress))}
        return STRESS if held[STRESS] > held[STRAIN] + HOLDS else STRAIN


def _time_held(time: np.ndarray, values: np.ndarray) -> float:
    """Return the share of the time during which a signal (n,) stays near the value at which it does so longest."""
    weights = np.gradient(time)
    near = np.abs(values[:, None] - values) < HELD * max(float(np.ptp(np.append(values, 0.0))), 1e-300)
    return float((near @ weights).max() / weights.sum())


def read_uniaxial(path: str | Path) -> UniaxialTest:
    """Read a CSV with the header `HEADER`; of more than `MOST` points as many are kept, evenly.

    A comment ``# engineering`` says that strain and stress are nominal; they are converted by ln(1 + strain) and stress
    (1 + strain), for a body that keeps its volume. ``# compression`` says that both are positive in compression. Raises
    `InputError` when the file is missing or has another header, a line is no numbers, or they are no test.
    """
    path = Path(path)
    (time, strain, stress), notes = read_table(path, HEADER)
    said = {note.strip().lower() for note in notes}
    with located_in(path):
        if COMPRESSION in said:
            strain, stress = -strain, -stress
        if ENGINEERING in said:
            if strain.min(initial=0.0) <= -1.0:
                problem = f"the engineering strain {strain.min():g} leaves nothing of the body"
                raise InputError(problem, remedy="give it as a ratio, not in per cent", place="strain")
            strain, stress = np.log1p(strain), stress * (1.0 + strain)
        every = UniaxialTest(time, strain, stress, path.stem)
        kept = np.unique(np.linspace(0, len(time) - 1, min(len(time), MOST)).round().astype(int))
        return UniaxialTest(every.time[kept], every.strain[kept], every.stress[kept], path.stem)
