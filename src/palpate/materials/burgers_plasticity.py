"""Nonlinear Burgers creep with rate-independent J2 yielding beside it; both flow along the stress deviator."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.materials import bilinear_plasticity, nonlinear_burgers
from palpate.materials.law import Law
from palpate.parameters import Parameter


def declared(values: Mapping[str, object]) -> tuple[Parameter, ...]:
    """Return every parameter of the law with as many Voigt elements as `values` names."""
    return (*nonlinear_burgers.declared(values), *bilinear_plasticity.PLASTIC)


def coefficients(values: Mapping[str, float]) -> np.ndarray:
    """Map checked values to the radial equation."""
    row = nonlinear_burgers.coefficients(values)
    row[4:6] = values["yield_stress"], values["hardening"]
    return row


LAW = Law("burgers_plasticity", "nonlinear Burgers with yielding", declared({}), coefficients, declared)
