"""Thermal drift: instrument and specimen expand at a steady rate while the test runs, so depth gains rate * t."""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.mechanism import Mechanism, Range, Values


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add rate * t."""
    return depth + values["rate"] * time


MECHANISM = Mechanism(
    "thermal_drift",
    "thermal drift",
    (Parameter("rate", r"\dot d", "nm/s", -100.0, 100.0, "drift rate of one recording"),),
    {"rate": 0.0},
    "Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, section III",
    lambda s: {"rate": Range(-0.3 * s.depth / s.duration, 0.3 * s.depth / s.duration)},
    record=record,
    varies=True,
)
