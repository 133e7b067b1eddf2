"""What a mechanism of missing physics declares, and where it acts: before the simulation or on what is recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from palpate.parameters import Parameter, check_values
from palpate.specification import Specification

Values = Mapping[str, float]


def unchanged_specification(specification: Specification, values: Values) -> Specification:
    """Simulate what the base model says."""
    return specification


def unchanged_depth(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Record the depth as it is."""
    return depth


@dataclass(frozen=True)
class Mechanism:
    """One effect that a base model leaves out.

    Parameters
    ----------
    key, title
        Key of the contracts, and name for people.
    parameters
        Its amplitudes.
    neutral
        Values, or limits of values, at which it does nothing.
    source
        Where the effect is described.
    simulate
        Changes what is simulated: tip, material, load that acts.
    record
        Changes the depth (n,) [nm] that the instrument writes, from time [s], recorded load [mN] and true depth.
    """

    key: str
    title: str
    parameters: tuple[Parameter, ...]
    neutral: Values
    source: str
    simulate: Callable[[Specification, Values], Specification] = unchanged_specification
    record: Callable[[np.ndarray, np.ndarray, np.ndarray, Values], np.ndarray] = unchanged_depth

    def check(self, values: Mapping[str, object]) -> dict[str, float]:
        """Return all parameters by name, checked; raises `InputError`."""
        return check_values(self.parameters, values, f"mechanism {self.key}")
