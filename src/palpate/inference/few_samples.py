"""What few samples tell of all."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


def interpolated(time: np.ndarray, knots: np.ndarray, columns: Iterable[np.ndarray]) -> np.ndarray:
    """Return each of k columns (m,), known at times `knots` (m,) [s], at all times (n,) [s], shape (n, k)."""
    return np.stack([np.interp(time, knots, column) for column in columns], axis=1)
