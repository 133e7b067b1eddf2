"""Curves between their points."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


def interpolated(time: np.ndarray, knots: np.ndarray, columns: Iterable[np.ndarray]) -> np.ndarray:
    """Return k columns (m,), known at times `knots` (m,) [s], along straight lines at times (n,) [s], shape (n, k)."""
    return np.stack([np.interp(time, knots, column) for column in columns], axis=1)


def depth_at(moments: np.ndarray, time: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the depth (m,) at some moments (m,) of a curve that starts at (0, 0), by its points at times (n,).

    Between points the square of the depth is linear, as that of a sharp tip is while the load grows evenly: straight
    lines through few points of a curve that begins like a root would lie below it by many nanometres.
    """
    square = np.interp(moments, np.append(0.0, time), np.append(0.0, depth * np.abs(depth)))
    return np.sign(square) * np.sqrt(np.abs(square))


def load_at(moments: np.ndarray, time: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the load (m,) at some moments (m,) of a curve that starts at (0, 0), along straight lines (n,)."""
    return np.interp(moments, np.append(0.0, time), np.append(0.0, load))
