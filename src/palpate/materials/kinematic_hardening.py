r"""Kinematic hardening: a back stress in proportion to the strain of the flow, which acts against it.

$$X = \frac{2}{3} C \varepsilon_f$$

Creep, yielding and Voigt elements that are not linear flow by $s - X$ in place of $s$, and $\varepsilon_f$ is their
strain together; Hooke's law and linear Voigt elements are driven by $s$. In uniaxial tension the back stress is
$C \varepsilon_f$. The law is joined to one that flows, such as `eyring+kinematic_hardening`.

Source: W. Prager, J. Appl. Mech. 23 (1956) 493-496; for polymers R.N. Haward and G. Thackray, Proc. R. Soc. Lond. A 302
(1968) 453-472, whose chain network bears the back stress.
"""

from __future__ import annotations

from palpate.base.parameters import Parameter
from palpate.materials.first_guess import Glimpse, Guessed
from palpate.materials.law import BackStress, Law

MODULUS = Parameter("kinematic_modulus", "C", "GPa", 0.0, 1e3, "rise of the back stress with the strain of the flow")


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return a range of the modulus."""
    return {MODULUS.name: Guessed((0.0, 0.2 * glimpse.modulus), "up to a fifth of the modulus")}


LAW = Law(
    "kinematic_hardening",
    "kinematic hardening",
    (MODULUS,),
    lambda values: [BackStress(values[MODULUS.name])],
    example={MODULUS.name: 0.4},
    guess=guess,
)
