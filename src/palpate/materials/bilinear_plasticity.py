r"""Bilinear elastic-plastic solid: Hooke, J2 yielding, linear isotropic hardening.

$$\sigma = \sigma_Y + H \alpha$$

with the equivalent plastic strain $\alpha$.
"""

from __future__ import annotations

from palpate.base.parameters import Parameter
from palpate.materials.first_guess import Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry
from palpate.materials.flow.registry import strength
from palpate.materials.law import Law, Yield

YIELD_STRESS = Parameter("yield_stress", r"\sigma_Y", "GPa", 1e-12, 1e3, "yield stress in uniaxial tension")
HARDENING = Parameter("hardening", "H", "GPa", 0.0, 1e3, "plastic modulus d sigma / d eps_p")
PLASTIC = (YIELD_STRESS, HARDENING)


@strength
def linear_hardening(law, at, alpha, pressure):
    """Return sigma_Y + H alpha [GPa] and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.strength`.
    """
    sigma_y, hardening = entry(law, at), entry(law, at + 1)
    return sigma_y + hardening * alpha, hardening, constant(alpha, 0.0)


def guess_yield_stress(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return a range of the yield stress (K.L. Johnson, Contact Mechanics, 1985, section 6.3)."""
    between = (0.2 * glimpse.hardness, 0.9 * glimpse.hardness)
    return {"yield_stress": Guessed(between, "a fifth to nine tenths of the hardness")}


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of yield stress and hardening."""
    hardening = Guessed((0.0, 0.1 * glimpse.modulus), "up to a tenth of the modulus")
    return guess_yield_stress(glimpse) | {"hardening": hardening}


LAW = Law(
    "bilinear_plasticity",
    "bilinear plasticity",
    PLASTIC,
    lambda values: [Yield(linear_hardening, [values[p.name] for p in PLASTIC])],
    example={"yield_stress": 0.05, "hardening": 0.3},
    guess=guess,
)
