"""Second Voigt element: part of the strain recovers on a time scale that the base model does not have."""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.materials.nonlinear_burgers import VOIGT
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Scale, Values
from palpate.study.specification import Specification

NAMES = ("coefficient", "exponent", "retardation_time")


def from_search(values: Values, scale: Scale) -> Values:
    """Turn the compliance at the stress of the study, J2 = (pressure / 3)^2, into a coefficient."""
    coefficient = values["compliance"] * (scale.pressure / 3) ** (-2 * values["exponent"])
    return {**{name: values[name] for name in NAMES[1:]}, "coefficient": coefficient}


def simulate(specification: Specification, values: Values) -> Specification:
    """Add one more Voigt element to the law; raises `InputError` for one that has none."""
    present = specification.parameters
    if VOIGT[0].name not in present:
        raise InputError(
            f"{specification.model} has no Voigt element to add to",
            remedy="use nonlinear_burgers",
            place="mechanisms.second_voigt",
        )
    count = 2
    while f"{VOIGT[0].name}_{count}" in present:
        count += 1
    further = {f"{p.name}_{count}": values[name] for p, name in zip(VOIGT, NAMES, strict=True)}
    return replace(specification, parameters={**present, **further})


MECHANISM = Mechanism(
    key="second_voigt",
    title="second Voigt element",
    family="creep",
    effect="one more Voigt element: strain recovers on a time scale that the base model does not have",
    parameters=tuple(
        Parameter(name, p.symbol, p.unit, p.lower, p.upper, f"second element: {p.meaning}")
        for p, name in zip(VOIGT, NAMES, strict=True)
    ),
    neutral={"coefficient": 0.0, "exponent": 0.3, "retardation_time": 10.0},
    example={"coefficient": 0.1, "exponent": 0.3, "retardation_time": 10.0},
    source="Findley, Lai & Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (1976), chapter 5",
    plausible=lambda s: {
        "compliance": Range(
            0.0,
            0.5 / s.modulus,
            least=0.0,
            unit="1/GPa",
            meaning="compliance at the stress of the tests",
            proportional=True,
        ),
        "exponent": Range(0.0, 0.6),
        "retardation_time": Range(0.1 * s.loading_time, s.duration, log=True),
    },
    concealed=lambda rng: {
        "coefficient": log_uniform(rng, 0.02, 0.5),
        "exponent": rng.uniform(0.1, 0.5),
        "retardation_time": log_uniform(rng, 2.0, 150.0),
    },
    simulate=simulate,
    from_search=from_search,
    solver_scatter=0.01,
    breaks=frozenset({Assumption.ALL_CREEP_IS_KNOWN}),
)
