"""Bilinear elastic-plastic solid: Hooke, J2 yielding, linear isotropic hardening, sigma = sigma_Y + H alpha."""

from __future__ import annotations

from palpate.base.parameters import Parameter
from palpate.materials.flow.arithmetic import constant, entry
from palpate.materials.flow.registry import strength
from palpate.materials.law import Law, Yield

YIELD_STRESS = Parameter("yield_stress", r"\sigma_Y", "GPa", 1e-9, 1e3, "yield stress in uniaxial tension")
HARDENING = Parameter("hardening", "H", "GPa", 0.0, 1e3, "plastic modulus d sigma / d eps_p")
PLASTIC = (YIELD_STRESS, HARDENING)


@strength
def linear_hardening(law, at, alpha, pressure):
    """Return sigma_Y + H alpha [GPa] and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.strength`.
    """
    sigma_y, hardening = entry(law, at), entry(law, at + 1)
    return sigma_y + hardening * alpha, hardening, constant(alpha, 0.0)


LAW = Law(
    "bilinear_plasticity",
    "bilinear plasticity",
    PLASTIC,
    lambda values: [Yield(linear_hardening, [values[p.name] for p in PLASTIC])],
)
