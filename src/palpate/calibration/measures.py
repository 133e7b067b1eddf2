"""Error measures between a recorded and a simulated curve."""

from __future__ import annotations

import numpy as np


def mean_squared(simulated: np.ndarray, recorded: np.ndarray) -> np.ndarray:
    """Return mean((h_exp - h_sim)^2) [nm^2] over the last axis (the thesis' chapter 5)."""
    return np.mean((recorded - simulated) ** 2, axis=-1)


def relative(simulated: np.ndarray, recorded: np.ndarray) -> np.ndarray:
    """Return sqrt(mean(((h_sim - h_exp) / h_exp)^2)) over the last axis (the thesis' chapter 4)."""
    return np.sqrt(np.mean(((simulated - recorded) / recorded) ** 2, axis=-1))


OBJECTIVES = {"squared": mean_squared, "relative": relative}


def error_table(simulated: np.ndarray, recorded: np.ndarray) -> dict[str, float]:
    """Return the four measures of the thesis' tables for one curve.

    Parameters
    ----------
    simulated, recorded : ndarray, shape (n,)
        Depths [nm].
    """
    difference = simulated - recorded
    spread = np.sum((recorded - recorded.mean()) ** 2)
    return {
        "rmse_nm": float(np.sqrt(np.mean(difference**2))),
        "r2": float(1 - np.sum(difference**2) / spread),
        "mean_abs_error_nm": float(np.mean(np.abs(difference))),
        "percent_error": float(100 * np.mean(np.abs(difference)) / np.mean(recorded)),
    }
