"""Tip angle: the cone is blunter or sharper than nominal.

ISO 14577-2 allows 0.3 degrees for the faces of a Berkovich pyramid, whose equivalent cone then differs by as much.
Cones are ground to about a degree.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import InputError
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.indenter import HALF_ANGLE
from palpate.study.specification import Specification

TYPICAL = 1.0  # deg


def simulate(specification: Specification, values: Values) -> Specification:
    """Put the true half-angle in place of the nominal one; a pyramid's is that of its equivalent cone.

    Raises
    ------
    InputError
        For a shape that has none.
    """
    try:
        return replace(specification, indenter=specification.indenter.of_half_angle(values["half_angle"]))
    except InputError as error:
        raise InputError(error.problem, remedy=error.remedy, place="mechanisms.tip_angle") from None


MECHANISM = Mechanism(
    key="tip_angle",
    title="tip angle",
    family="tip",
    effect="the cone is blunter or sharper than nominal",
    parameters=(HALF_ANGLE,),
    neutral={"half_angle": 70.3},
    example={"half_angle": 71.0},
    source="Fischer-Cripps, Nanoindentation, 3rd ed. (2011), section 4.7",
    plausible=lambda s: {"half_angle": Range(s.half_angle - 4.0, s.half_angle + 4.0, typical=TYPICAL)},
    concealed=lambda rng: {"half_angle": 70.3 + signed(rng, 0.2, 2.5)},
    simulate=simulate,
    solver_scatter=0.001,
    assumed=lambda s: {"half_angle": s.indenter.half_angle},
    of_the_tip=True,
)
