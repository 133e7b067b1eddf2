r"""Gain of the load: the load cell is off by a factor, and springs beside the specimen bear a part of the load.

The load that acts is

$$\mathrm{gain} \cdot P_\mathrm{recorded} + \mathrm{spring} \cdot h.$$

A tip is hung on springs, whose share of the load grows with the depth; what is subtracted for them is never exact. A
gain alone acts as if all stresses of the law were larger by a factor: only a known material, such as one with uniaxial
tests, tells it from the material's parameters.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Scale, Values
from palpate.study.protocol import LOAD
from palpate.study.specification import Specification, axisymmetric_only

TYPICAL = 0.01  # of the load: what ISO 14577-2 allows
SHARE = 0.005  # of the largest load, of what is left of the springs; chosen


def plausible(scale: Scale) -> dict[str, Range]:
    """Return the ranges of gain and spring."""
    whole = scale.load / scale.depth
    return {
        "gain": Range(0.9, 1.1, typical=TYPICAL),
        "spring": Range(-0.2 * whole, 0.2 * whole, typical=SHARE * whole),
    }


def simulate(specification: Specification, values: Values) -> Specification:
    """Let another load act.

    Raises
    ------
    InputError
        Where a displacement is prescribed, and for a spring beside a pyramid.
    """
    protocol = specification.protocol
    if protocol.control != LOAD:
        raise InputError(
            "load_gain does not apply where a displacement is prescribed",
            remedy="leave it out, or use tests under load control",
            place="mechanisms.load_gain",
        )
    if values["spring"] and not specification.indenter.of_revolution:
        raise axisymmetric_only("a spring beside the specimen", "mechanisms.load_gain.spring")
    drive, spring = values["gain"] * protocol.knot_drive, protocol.spring + values["spring"]
    if values["gain"] == 1.0 and spring == protocol.spring:
        return specification
    return replace(specification, protocol=replace(protocol, knot_drive=drive, spring=spring))


MECHANISM = Mechanism(
    key="load_gain",
    title="gain of the load",
    family="load",
    effect="the load that acts is gain * recorded load + spring * depth",
    parameters=(
        Parameter("gain", "g", "-", 0.1, 10.0, "load that acts per recorded load"),
        Parameter("spring", "k", "mN/nm", -1.0, 1.0, "load that acts per depth"),
    ),
    neutral={"gain": 1.0, "spring": 0.0},
    example={"gain": 1.05, "spring": 0.0},
    source="ISO 14577-2:2015 (force); Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, section II (support springs)",
    plausible=plausible,
    concealed=lambda rng: {"gain": 1.0 + signed(rng, 0.005, 0.1), "spring": signed(rng, 1e-5, 2e-4)},
    simulate=simulate,
    breaks=frozenset({Assumption.RECORDED_LOAD_ACTS}),
    unidentifiable_at_one_load=True,
    by_default=False,
    of_the_instrument=True,
)
