"""Depth and load between the points of a curve."""

from __future__ import annotations

import numpy as np


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
