"""Nonlinear Burgers solid: Hooke, power-law steady creep, and Voigt elements driven by a power of the stress.

    d e_s/dt                 = C_s J2^m_s s
    d e_t/dt + e_t/t_eps     = (C_t/t_eps) J2^m_t s        (one equation for each Voigt element)

Creep is isochoric. J2 = s:s/2 in GPa^2, so C_s has the unit GPa^-(2 m_s + 1) s^-1 and C_t GPa^-(2 m_t + 1).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.materials.law import NO_YIELD, POISSON_RATIO, YOUNGS_MODULUS, Law, elastic_coefficients
from palpate.parameters import Parameter

STEADY = (
    Parameter("steady_coefficient", "C_s", "GPa^-(2m_s+1)/s", 0.0, 1e6, "coefficient of steady creep"),
    Parameter("steady_exponent", "m_s", "-", 0.0, 10.0, "exponent of J2 in steady creep"),
)
VOIGT = (
    Parameter("transient_coefficient", "C_t", "GPa^-(2m_t+1)", 0.0, 1e6, "coefficient of transient creep"),
    Parameter("transient_exponent", "m_t", "-", 0.0, 10.0, "exponent of J2 in transient creep"),
    Parameter("retardation_time", r"t_\epsilon", "s", 1e-6, 1e9, "retardation time of the Voigt element"),
)


def voigt_elements(values: Mapping[str, object]) -> tuple[Parameter, ...]:
    """Return the parameters of all Voigt elements that `values` names (``..._2``, ``..._3`` for further ones)."""
    count = 1
    while any(f"{p.name}_{count + 1}" in values for p in VOIGT):
        count += 1
    further = tuple(
        Parameter(f"{p.name}_{k}", f"{p.symbol}^{{({k})}}", p.unit, p.lower, p.upper, f"{p.meaning}, element {k}")
        for k in range(2, count + 1)
        for p in VOIGT
    )
    return VOIGT + further


def voigt_coefficients(values: Mapping[str, float]) -> list[float]:
    """Return C_t, m_t, t_eps of each Voigt element, in order."""
    return [values[p.name] for p in voigt_elements(values)]


def declared(values: Mapping[str, object]) -> tuple[Parameter, ...]:
    """Return every parameter of the law with as many Voigt elements as `values` names."""
    return (YOUNGS_MODULUS, POISSON_RATIO, *STEADY, *voigt_elements(values))


def coefficients(values: Mapping[str, float]) -> np.ndarray:
    """Map checked values to the radial equation."""
    steady = [values["steady_coefficient"], values["steady_exponent"]]
    return np.array([*elastic_coefficients(values), *steady, NO_YIELD, 0.0, *voigt_coefficients(values)])


LAW = Law("nonlinear_burgers", "nonlinear Burgers", declared({}), coefficients, declared)
