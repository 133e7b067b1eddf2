"""The noise of a recorded channel, from differences of neighbouring points, in which a smooth path leaves little.

Differences of independent errors of the standard deviation sigma scatter by sqrt(6) sigma in second order, by sqrt(70)
sigma in fourth. The median of a normal variable's magnitude is 0.6745 standard deviations, and knows few outliers.
"""

from __future__ import annotations

import numpy as np

MEDIAN = 0.6745  # median of |x| over the standard deviation, of a normal distribution
FEWEST = 5  # points, chosen: fewer show no noise
FEWEST_AVERAGES = 40  # chosen, likewise of averages


def noise_of(values: np.ndarray) -> float:
    """Return the standard deviation of a channel's noise (n,), in its unit; zero where there are too few points."""
    if len(values) < FEWEST:
        return 0.0
    return float(np.median(np.abs(np.diff(values, 2))) / (MEDIAN * np.sqrt(6)))


def long_run_noise(values: np.ndarray) -> float:
    """Return the standard deviation of a channel's noise (n,) as averages over many points know it, times their root.

    It is larger than `noise_of` where neighbours share their noise. Averages are taken over 1, 4 and 16 points.
    """
    found = [noise_of(values)]
    for size in (1, 4, 16):
        count = len(values) // size
        if count >= FEWEST_AVERAGES:
            means = values[: count * size].reshape(count, size).mean(axis=1)
            found.append(float(np.median(np.abs(np.diff(means, 4))) * np.sqrt(size / 70) / MEDIAN))
    return max(found)
