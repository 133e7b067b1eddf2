"""Isotropic linear elasticity (Hooke)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.materials.law import NO_YIELD, POISSON_RATIO, YOUNGS_MODULUS, Law, elastic_coefficients


def coefficients(values: Mapping[str, float]) -> np.ndarray:
    """Map checked values to the radial equation."""
    return np.array([*elastic_coefficients(values), 0.0, 0.0, NO_YIELD, 0.0])


LAW = Law("elastic", "linear elasticity", (YOUNGS_MODULUS, POISSON_RATIO), coefficients)
