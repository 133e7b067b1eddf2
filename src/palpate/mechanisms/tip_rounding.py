"""Tip rounding: the apex of the cone is a spherical cap that runs tangentially into the flank.

A pyramid's edges are rounded with the same radius.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import InputError
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.indenter import RADIUS
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Give the cone or pyramid a cap; raises `InputError` for other shapes."""
    indenter = specification.indenter
    if not (indenter.half_angle or indenter.face_angle):
        raise InputError(
            f"shape {indenter.shape} cannot be rounded",
            remedy="use a cone or a pyramid",
            place="mechanisms.tip_rounding",
        )
    shape = "sphero_cone" if indenter.half_angle else indenter.shape
    return replace(specification, indenter=replace(indenter, shape=shape, radius=values["radius"]))


MECHANISM = Mechanism(
    key="tip_rounding",
    title="tip rounding",
    family="tip",
    effect="the tip is a spherical cap that runs tangentially into the cone",
    parameters=(RADIUS,),
    neutral={"radius": 1e-3},
    example={"radius": 200.0},
    source="Cheng & Cheng, J. Appl. Phys. 84 (1998) 1284-1291",
    plausible=lambda s: {"radius": Range(1.0, 600.0, least=1.0)},
    concealed=lambda rng: {"radius": log_uniform(rng, 10.0, 400.0)},
    simulate=simulate,
    solver_scatter=0.06,
    unidentifiable_at_one_load=True,
    of_the_tip=True,
)
