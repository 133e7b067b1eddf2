"""Amplitudes drawn at random over decades, for recordings that conceal a mechanism."""

from __future__ import annotations

import numpy as np


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a positive number from `low` to `high` whose logarithm is uniform."""
    return float(low * (high / low) ** rng.random())


def signed(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw such a number with either sign."""
    return float(rng.choice([-1.0, 1.0])) * log_uniform(rng, low, high)
