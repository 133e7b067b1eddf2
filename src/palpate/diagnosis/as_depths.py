"""Loads that answer to a displacement, as the depths that they amount to: a diagnosis reckons in nm throughout.

Noise, drift and misfit of all conditions are then of one kind. The factor of each condition is that of
`palpate.quantity`, taken from its recordings.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from palpate.calibration import Observation
from palpate.diagnosis.effects import Effect, Effects
from palpate.surrogate import PODRBF


@dataclass(frozen=True, eq=False)
class Scaled:
    """A surrogate whose curves are multiplied by a factor."""

    surrogate: PODRBF
    factor: float

    @property
    def loo_error_(self) -> np.ndarray:
        """Leave-one-out errors, shape (n_snapshots, n_points)."""
        return self.factor * self.surrogate.loo_error_

    def evaluate(self, X: np.ndarray) -> np.ndarray:
        """Curves (n, n_points) at parameters X (n, n_parameters)."""
        return self.factor * self.surrogate.evaluate(X)


def observed_depth(item: Observation) -> Observation:
    """Return what was measured in one condition in nm."""
    return replace(item, response=item.quantity.nm * item.response, quantity=replace(item.quantity, unit="nm", nm=1.0))


def effects_in_nm(effects: Effects, nm: float) -> Mapping[str, Effect]:
    """Return the effects under one condition in nm, for so many nm in a unit of what answers."""
    return {
        key: replace(effect, spread=nm * effect.spread, error=nm * effect.error, unresolved=nm * effect.unresolved)
        for key, effect in effects.mechanisms.items()
    }
