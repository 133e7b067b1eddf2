"""Nonlinear Burgers creep with rate-independent J2 yielding beside it; both flow along the stress deviator."""

from __future__ import annotations

from dataclasses import replace

from palpate.materials import bilinear_plasticity, nonlinear_burgers
from palpate.materials.first_guess import Glimpse, Guessed
from palpate.materials.joined import joined


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of the plastic flow, and linear transient creep beside it."""
    creep = nonlinear_burgers.linear_creep((0.0,), (0.0, 0.3 / glimpse.modulus), "linear creep beside the plastic flow")
    held = {"retardation_time": Guessed((0.5 * glimpse.shortest,), "half of the shortest loading")}
    return {**bilinear_plasticity.guess(glimpse), **creep, **held}


LAW = replace(
    joined((nonlinear_burgers.LAW, bilinear_plasticity.LAW), "burgers_plasticity", "nonlinear Burgers with yielding"),
    guess=guess,
)
