"""Plastic yield: rate-independent flow beside the creep, once the stress reaches a yield stress."""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import InputError
from palpate.materials.bilinear_plasticity import PLASTIC
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Put yielding beside the creep."""
    if specification.model != "nonlinear_burgers":
        raise InputError(
            f"plastic_yield does not apply to {specification.model}",
            remedy="use nonlinear_burgers",
            place="mechanisms.plastic_yield",
        )
    return replace(specification, model="burgers_plasticity", parameters={**specification.parameters, **values})


MECHANISM = Mechanism(
    "plastic_yield",
    "plastic yield",
    PLASTIC,
    {"yield_stress": 1e3, "hardening": 0.0},
    "Simo & Hughes, Computational Inelasticity (1998), section 3.3",
    lambda s: {
        "yield_stress": Range(0.01 * s.modulus, 0.12 * s.modulus, log=True),
        "hardening": Range(0.0, 0.3 * s.modulus),
    },
    simulate=simulate,
)
