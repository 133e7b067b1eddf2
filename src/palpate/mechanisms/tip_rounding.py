"""Tip rounding: the apex of the cone is a spherical cap that runs tangentially into the flank."""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import InputError
from palpate.indenters import RADIUS
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Give the cone a cap."""
    if not specification.indenter.half_angle:
        shape = specification.indenter.shape
        raise InputError(f"shape {shape} cannot be rounded", remedy="use a cone", place="mechanisms.tip_rounding")
    rounded = replace(specification.indenter, shape="sphero_cone", radius=values["radius"])
    return replace(specification, indenter=rounded)


MECHANISM = Mechanism(
    "tip_rounding",
    "tip rounding",
    (RADIUS,),
    {"radius": 1e-3},
    "Cheng & Cheng, J. Appl. Phys. 84 (1998) 1284-1291",
    lambda s: {"radius": Range(1.0, 600.0)},
    simulate=simulate,
    solver_scatter=0.003,
)
