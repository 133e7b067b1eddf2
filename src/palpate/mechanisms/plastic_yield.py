"""Plastic yield: rate-independent flow beside the creep, once the stress reaches a yield stress."""

from __future__ import annotations

import math
from dataclasses import replace

from palpate.errors import InputError
from palpate.materials.bilinear_plasticity import LAW, PLASTIC
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Scale, Values
from palpate.study.specification import Specification

LARGEST_SHARE = 0.99  # of the flow stress that hardening gives; without a yield stress nothing would be elastic


def from_search(values: Values, scale: Scale) -> Values:
    """Divide the flow stress at Tabor's strain, 0.2 cot(alpha), between yield stress and hardening."""
    hardened = values["hardened_share"] * values["flow_stress"]
    strain = 0.2 / math.tan(math.radians(scale.half_angle or 70.3))
    return {"yield_stress": values["flow_stress"] - hardened, "hardening": hardened / strain}


def simulate(specification: Specification, values: Values) -> Specification:
    """Put yielding beside the creep; raises `InputError` for a law that yields already."""
    if specification.specimen.yields:
        raise InputError(
            f"plastic_yield does not apply to {specification.model}, which yields already",
            remedy="use a law without a yield stress",
            place="mechanisms.plastic_yield",
        )
    model = f"{specification.model}+{LAW.key}"
    return replace(specification, model=model, parameters={**specification.parameters, **values})


MECHANISM = Mechanism(
    key="plastic_yield",
    title="plastic yield",
    family="flow",
    effect="rate-independent plastic flow beside the creep",
    parameters=PLASTIC,
    neutral={"yield_stress": 1e3, "hardening": 0.0},
    example={"yield_stress": 0.15, "hardening": 0.2},
    source="Simo & Hughes, Computational Inelasticity (1998), section 3.3",
    plausible=lambda s: {
        "flow_stress": Range(
            0.25 * s.pressure,
            2.0 * s.pressure,
            log=True,
            least=0.0,
            unit="GPa",
            meaning="flow stress at Tabor's strain",
        ),
        "hardened_share": Range(0.0, 0.8, least=0.0, largest=LARGEST_SHARE, meaning="share of it due to hardening"),
    },
    concealed=lambda rng: {"yield_stress": log_uniform(rng, 0.07, 0.3), "hardening": rng.uniform(0.05, 0.8)},
    simulate=simulate,
    from_search=from_search,
    solver_scatter=0.03,
)
