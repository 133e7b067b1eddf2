"""The thesis' kernels taken literally, to see what its formulas alone account for.

No polynomial goes with the interpolant, one mode is kept, and the Gaussian lacks the square of the distance (thesis,
chapter 4, table of radial basis functions).
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

PRINTED = {
    "linear": lambda r, c: r,
    "cubic": lambda r, c: r**3,
    "multiquadric": lambda r, c: np.sqrt(1 + (r / c) ** 2),
    "gaussian": lambda r, c: np.exp(-r / c**2),
    "inverse_multiquadric": lambda r, c: 1 / np.sqrt(r**2 + c**2),
}


def predict_as_printed(
    kernel: str, shape: float, known: np.ndarray, depth: np.ndarray, wanted: np.ndarray
) -> np.ndarray:
    """Return curves (m, points) at `wanted` (m, p) from curves `depth` (n, points) at `known` (n, p), scaled points."""
    _, _, modes = np.linalg.svd(depth, full_matrices=False)
    amplitudes = depth @ modes[:1].T
    weights = np.linalg.solve(PRINTED[kernel](cdist(known, known), shape), amplitudes)
    return PRINTED[kernel](cdist(wanted, known), shape) @ weights @ modes[:1]
