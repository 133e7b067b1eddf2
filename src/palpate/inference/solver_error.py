"""The error of the forward model: of its mesh, and of the law beyond that."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.linalg import block_diag

GRID = 0.005  # of the depth: largest error of grid convergence, of yielding bodies
SHAPE = 1.0 / 3.0  # of a law's discrepancy, which varies along a test
FADES_OVER = 0.1  # of the samples of a test


def model_covariance(
    curves: Mapping[str, np.ndarray], relative_error: float, shares: Mapping[str, float]
) -> np.ndarray:
    """Covariance (n, n) of the forward model's error, all conditions one after the other [nm^2].

    A mesh whose rings grow by a constant ratio makes the same relative error at every depth: all curves are off by one
    common factor, of standard deviation `relative_error`. The default of 0.003 covers what ``accuracy: standard``
    differs from the depth extrapolated in the mesh ratio: up to 0.2 % of the depth in elastic and creeping bodies; up
    to `GRID` where yielding prevails, which a study may state.

    What a study states beyond `GRID` is a discrepancy of the law (M. C. Kennedy and A. O'Hagan, J. R. Statist. Soc. B
    63 (2001) 425-464). It has a shape as well: a third of it varies along each test, as a random function of the
    sample's number whose correlation falls to 1/e over a tenth of them; half of its variance is common to all
    conditions.

    Where the load answers it departs by the `shares` of that, see `palpate.study.quantity.Quantity.share`.
    """
    depth = np.concatenate([shares.get(name, 1.0) * curve for name, curve in curves.items()])
    beyond = max(relative_error**2 - GRID**2, 0.0)
    relative = np.full((len(depth), len(depth)), relative_error**2)
    if beyond:
        place = np.concatenate([np.arange(len(curve)) / len(curve) for curve in curves.values()])
        same = block_diag(*(np.ones((len(curve), len(curve))) for curve in curves.values()))
        fades = np.exp(-np.abs(np.subtract.outer(place, place)) / FADES_OVER)
        relative += SHAPE**2 * beyond * fades * (1.0 + same) / 2.0
    return relative * np.outer(depth, depth)
