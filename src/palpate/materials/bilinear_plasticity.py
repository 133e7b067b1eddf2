"""Bilinear elastic-plastic solid: Hooke, J2 yielding, linear isotropic hardening, sigma = sigma_Y + H eps_p."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.materials.law import POISSON_RATIO, YOUNGS_MODULUS, Law, elastic_coefficients
from palpate.parameters import Parameter

PLASTIC = (
    Parameter("yield_stress", r"\sigma_Y", "GPa", 1e-9, 1e3, "yield stress in uniaxial tension"),
    Parameter("hardening", "H", "GPa", 0.0, 1e3, "plastic modulus d sigma / d eps_p"),
)


def coefficients(values: Mapping[str, float]) -> np.ndarray:
    """Map checked values to the radial equation."""
    return np.array([*elastic_coefficients(values), 0.0, 0.0, values["yield_stress"], values["hardening"]])


LAW = Law("bilinear_plasticity", "bilinear plasticity", (YOUNGS_MODULUS, POISSON_RATIO, *PLASTIC), coefficients)
