r"""Ludwik hardening: Hooke and J2 yielding, a power of the plastic strain.

$$\sigma = \sigma_Y + K \alpha^n$$

The hardening modulus is infinite where flow begins; $\alpha$ is the equivalent plastic strain.

Source: P. Ludwik, Elemente der technologischen Mechanik (1909).
"""

from __future__ import annotations

from palpate.base.parameters import Parameter
from palpate.materials.bilinear_plasticity import YIELD_STRESS, guess_yield_stress
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, exponential, logarithm, where_less
from palpate.materials.flow.registry import strength
from palpate.materials.law import Law, Yield

FLOW = (
    YIELD_STRESS,
    Parameter("strength", "K", "GPa", 0.0, 1e3, "rise of the yield stress over a plastic strain of one"),
    Parameter("hardening_exponent", "n", "-", 0.01, 1.0, "exponent of the plastic strain"),
)
SMALLEST = 1e-300  # of alpha that is not zero


@strength
def power_hardening(law, at, alpha, pressure):
    """Return sigma_Y + K alpha^n [GPa] and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.strength`.
    """
    sigma_y, k, n = entry(law, at), entry(law, at + 1), entry(law, at + 2)
    none, least = constant(alpha, 0.0), constant(alpha, SMALLEST)
    strain = where_less(alpha, least, least, alpha)
    rise = where_less(alpha, least, none, k * exponential(n * logarithm(strain)))
    return sigma_y + rise, n * rise / strain, none


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of yield stress, strength and exponent."""
    return guess_yield_stress(glimpse) | {
        "strength": Guessed((0.05 * glimpse.modulus, 0.3 * glimpse.modulus), "5 to 30 % of the modulus"),
        "hardening_exponent": Guessed((0.1, 0.8), USUAL),
    }


LAW = Law(
    "ludwik_plasticity",
    "Ludwik plasticity",
    FLOW,
    lambda values: [Yield(power_hardening, [values[p.name] for p in FLOW])],
    example={"yield_stress": 0.03, "strength": 0.1, "hardening_exponent": 0.3},
    guess=guess,
)
