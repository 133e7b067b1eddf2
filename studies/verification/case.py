"""What a verification case takes and what it hands back."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.errors import PalpateError
from palpate.solver.simulation import simulate
from palpate.study.specification import Specification


@dataclass(frozen=True)
class Settings:
    """How thorough a verification is.

    Parameters
    ----------
    quick
        Leave out what takes long.
    calculix
        CalculiX' program, if it is to run.
    reference
        Folder of reference curves, if there is one.
    """

    quick: bool = False
    calculix: Path | None = None
    reference: Path | None = None

    @classmethod
    def found(cls, quick: bool, reference: Path | None) -> Settings:
        """Return the settings with CalculiX where it is on the PATH and has the time to run."""
        program = None if quick else shutil.which("ccx")
        return cls(quick, Path(program) if program else None, reference)


@dataclass(frozen=True)
class Row:
    """One quantity, as it should be and as it was found.

    Parameters
    ----------
    quantity
        What it is, with its unit.
    expected, found
        Found is NaN when the simulation failed.
    allowed
        Largest relative deviation; ``None`` for a value that is only reported.
    note
        Where the expectation or the allowance is from.
    measure
        The relative deviation, where it is not that of the two values (such as a root mean square over a curve).
    """

    quantity: str
    expected: float
    found: float
    allowed: float | None
    note: str = ""
    measure: float | None = None

    @property
    def deviation(self) -> float:
        """Relative deviation of what was found."""
        return self.found / self.expected - 1 if self.measure is None else self.measure

    @property
    def passed(self) -> bool | None:
        """Whether the deviation is within what is allowed; ``None`` where nothing is."""
        return None if self.allowed is None else bool(abs(self.deviation) <= self.allowed)


def not_run(title: str, error: PalpateError) -> Row:
    """Return the row of a comparison that failed to run, which counts as a check that failed."""
    return Row(f"{title} could run", 1.0, math.nan, 0.0, str(error))


@dataclass(frozen=True)
class PlottedSeries:
    """One line of a plot: `x` and `y` of equal length, kept as lists; `marks` draws points instead of a line."""

    label: str
    x: Sequence[float] | np.ndarray
    y: Sequence[float] | np.ndarray
    marks: bool = False

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            object.__setattr__(self, name, np.asarray(getattr(self, name)).tolist())


@dataclass(frozen=True)
class Plot:
    """Lines over common axes; `lower` holds deviations in per cent drawn underneath."""

    name: str
    x_label: str
    y_label: str
    series: Sequence[PlottedSeries]
    lower: Sequence[PlottedSeries] = ()
    logarithmic: bool = False


@dataclass(frozen=True)
class Outcome:
    """Rows and plots of a case, with sentences that a reader needs."""

    rows: Sequence[Row]
    plots: Sequence[Plot] = ()
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Verification:
    """A verification case: its key, its title for people, and what it does."""

    key: str
    title: str
    run: Callable[[Settings], Outcome]


def depth(specification: Specification) -> np.ndarray:
    """Return the simulated depth [nm] at the samples, shape (n,); NaN from a failure on."""
    return simulate(specification).depth


def worst(quantity: str, expected: np.ndarray, found: np.ndarray, allowed: float | None, note: str = "") -> Row:
    """Return the row of the sample where `found` departs most from `expected`; a failed sample is the worst of all.

    Parameters
    ----------
    quantity
        What is compared, with its unit.
    expected, found : ndarray, shape (n,)
        Reference values and those of palpate.
    allowed
        Largest relative deviation; None where it is reported only.
    note
        Shown beside the row.
    """
    deviation = np.abs(found / expected - 1)
    k = int(np.argmax(np.where(np.isnan(deviation), np.inf, deviation)))
    return Row(quantity, float(expected[k]), float(found[k]), allowed, note)


def rms(quantity: str, expected: np.ndarray, found: np.ndarray) -> Row:
    """Return the row, which is only reported, of the root mean square relative deviation of a curve `found` (n,).

    The values shown are those at the largest depth.
    """
    k = int(np.argmax(expected))
    measure = float(np.sqrt(np.mean((found / expected - 1) ** 2)))
    return Row(quantity, float(expected[k]), float(found[k]), None, measure=measure)
