r"""Voce hardening: Hooke and J2 yielding, which saturates.

$$\sigma = \sigma_s - (\sigma_s - \sigma_Y) \exp(-\alpha / \epsilon_c)$$

The yield stress rises from $\sigma_Y$ to the saturation stress $\sigma_s$; $\alpha$ is the equivalent plastic strain.

Source: E. Voce, J. Inst. Met. 74 (1948) 537-562.
"""

from __future__ import annotations

from collections.abc import Mapping

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.materials.bilinear_plasticity import YIELD_STRESS, guess_yield_stress
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, exponential, where_less
from palpate.materials.flow.registry import strength
from palpate.materials.law import Law, Yield

FLOW = (
    YIELD_STRESS,
    Parameter("saturation_stress", r"\sigma_s", "GPa", 1e-12, 1e3, "yield stress after large plastic strains"),
    Parameter("saturation_strain", r"\epsilon_c", "-", 1e-6, 1e2, "plastic strain at which 63 % of the rise is over"),
)


@strength
def saturating_hardening(law, at, alpha, pressure):
    """Return the yield stress [GPa] and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.strength`.
    """
    sigma_y, sigma_s, eps_c = entry(law, at), entry(law, at + 1), entry(law, at + 2)
    decay, most = alpha / eps_c, constant(alpha, 700.0)
    rest = (sigma_s - sigma_y) * exponential(constant(alpha, 0.0) - where_less(decay, most, decay, most))
    return sigma_s - rest, rest / eps_c, constant(alpha, 0.0)


def terms(values: Mapping[str, float]) -> list[Yield]:
    """Return the yield stress; raises `InputError` where it would fall."""
    first, last = values["yield_stress"], values["saturation_stress"]
    if last < first:
        raise InputError(
            f"saturation_stress = {last:g} GPa is below yield_stress = {first:g} GPa",
            remedy=f"give at least {first:g} GPa: the law hardens",
            place="saturation_stress",
        )
    return [Yield(saturating_hardening, [values[p.name] for p in FLOW])]


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of yield stress, saturation stress and strain."""
    stress = (0.9 * glimpse.hardness, 1.5 * glimpse.hardness)
    return guess_yield_stress(glimpse) | {
        "saturation_stress": Guessed(stress, "0.9 to 1.5 times the hardness"),
        "saturation_strain": Guessed((0.02, 0.3), USUAL),
    }


LAW = Law(
    "voce_plasticity",
    "Voce plasticity",
    FLOW,
    terms,
    example={"yield_stress": 0.03, "saturation_stress": 0.07, "saturation_strain": 0.01},
    guess=guess,
)
