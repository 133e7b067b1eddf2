"""A load that rises and falls in cycles."""

import numpy as np

PEAKS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def cycles(peaks=PEAKS, points=60):
    """Load and unload to a tenth, higher each time; returns time and load."""
    corners = np.concatenate([[0.0], np.ravel([[peak, 0.1 * peak] for peak in peaks])])
    time = np.linspace(0.0, len(corners) - 1.0, points * (len(corners) - 1) + 1)
    return time, np.interp(time, np.arange(len(corners)), corners)
