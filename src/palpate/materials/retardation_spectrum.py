r"""Retardation spectrum: linear Voigt elements at times spaced evenly in the logarithm, of power-law compliance.

$$\dot\varepsilon_k + \frac{\varepsilon_k}{t_k} = \frac{J_k s}{t_k}, \qquad J_k = C \, (t_k / 1 \mathrm{s})^n$$

for $N$ times from the shortest, $t_1$, to the longest, $t_N$. The sum of $J_k (1 - \exp(-t/t_k))$ then grows about as
$t^n$ between the shortest and the longest time.

Source: J.D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 3.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.law import Law, LinearVoigt

FLOW = (
    Parameter(
        "spectrum_coefficient", "C", "1/GPa", 0.0, 1e12, "compliance of an element with a retardation time of 1 s"
    ),
    Parameter("spectrum_exponent", "n", "-", -5.0, 5.0, "exponent of the retardation time in the compliance"),
    Parameter("shortest_time", "t_1", "s", 1e-6, 1e9, "shortest retardation time", default=0.1),
    Parameter("longest_time", "t_N", "s", 1e-6, 1e9, "longest retardation time", default=1000.0),
    Parameter("elements", "N", "-", 2, 60, "number of Voigt elements", default=9, whole=True),
)


def terms(values: Mapping[str, float]) -> list[LinearVoigt]:
    """Return the Voigt elements; raises `InputError` when the times do not rise."""
    first, last = values["shortest_time"], values["longest_time"]
    if last <= first:
        raise InputError(
            f"longest_time = {last:g} s does not exceed shortest_time = {first:g} s",
            remedy="give a longer one",
            place="longest_time",
        )
    times = np.geomspace(first, last, int(values["elements"]))
    compliances = values["spectrum_coefficient"] * times ** values["spectrum_exponent"]
    return [LinearVoigt(time, compliance) for time, compliance in zip(times, compliances, strict=True)]


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of coefficient and exponent."""
    return {
        "spectrum_coefficient": Guessed((0.0, 0.1 / glimpse.modulus), "up to a tenth of the elastic compliance"),
        "spectrum_exponent": Guessed((-0.2, 0.2), USUAL),
    }


LAW = Law(
    "retardation_spectrum",
    "retardation spectrum",
    FLOW,
    terms,
    example={"spectrum_coefficient": 0.05, "spectrum_exponent": 0.2, "elements": 5},
    guess=guess,
)
