r"""Yielding that pressure impedes (Drucker-Prager) with isochoric flow.

$$\sigma_e = \sigma_Y + H \alpha + \mu p$$

The pressure $p$ is positive in compression, and $\sigma_Y$ is the yield stress at zero pressure: in uniaxial tension it
is $\sigma_Y / (1 + \mu/3)$. Under tension the yield stress does not fall below a hundredth of $\sigma_Y$: isochoric
flow cannot return a stress to the apex of the cone.

Source: D.C. Drucker and W. Prager, Q. Appl. Math. 10 (1952) 157-165; P.B. Bowden and J.A. Jukes, J. Mater. Sci. 7
(1972) 52-63, for polymers.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.materials.bilinear_plasticity import HARDENING, YIELD_STRESS
from palpate.materials.bilinear_plasticity import guess as guess_hardening
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, where_less
from palpate.materials.flow.registry import strength
from palpate.materials.law import Law, Yield

FLOW = (
    replace(YIELD_STRESS, meaning="yield stress at zero pressure, as von Mises stress"),
    HARDENING,
    Parameter("pressure_coefficient", r"\mu", "-", 0.0, 1.0, "rise of the yield stress with pressure"),
)
LEAST = 0.01  # of sigma_Y


@strength
def pressed_hardening(law, at, alpha, pressure):
    """Return sigma_Y + H alpha + mu p [GPa] and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.strength`.
    """
    sigma_y, hardening, mu = entry(law, at), entry(law, at + 1), entry(law, at + 2)
    stress, least, none = sigma_y + hardening * alpha + mu * pressure, LEAST * sigma_y, constant(alpha, 0.0)
    return (
        where_less(stress, least, least, stress),
        where_less(stress, least, none, hardening),
        where_less(stress, least, none, mu),
    )


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of yield stress, hardening and its rise with pressure."""
    return guess_hardening(glimpse) | {"pressure_coefficient": Guessed((0.0, 0.3), USUAL)}


LAW = Law(
    "drucker_prager",
    "Drucker-Prager",
    FLOW,
    lambda values: [Yield(pressed_hardening, [values[p.name] for p in FLOW], pressed=True)],
    example={"yield_stress": 0.05, "hardening": 0.2, "pressure_coefficient": 0.15},
    guess=guess,
)
