"""Film on a substrate: the tested material is a film on an elastic body of another modulus."""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Put an elastic substrate under the material; its Poisson's ratio is the film's."""
    return replace(specification, film_thickness=values["thickness"], substrate_modulus=values["substrate_modulus"])


MECHANISM = Mechanism(
    key="film_on_substrate",
    title="film on a substrate",
    family="layer",
    effect="the tested material is a film on an elastic body of another modulus",
    parameters=(
        Parameter("thickness", "t_f", "nm", 1.0, 1e9, "thickness of the film"),
        Parameter("substrate_modulus", "E_s", "GPa", 1e-6, 2000.0, "Young's modulus of the substrate"),
    ),
    neutral={"thickness": 1e9, "substrate_modulus": 70.0},
    example={"thickness": 1500.0, "substrate_modulus": 70.0},
    source="Gao, Chiu & Lee, Int. J. Solids Struct. 29 (1992) 2471-2492 (elastic film on a substrate)",
    plausible=lambda s: {
        "thickness": Range(s.depth, 30.0 * s.depth, log=True),
        "substrate_modulus": Range(0.2 * s.modulus, 50.0 * s.modulus, log=True),
    },
    concealed=lambda rng: {
        "thickness": log_uniform(rng, 3000.0, 30000.0),
        "substrate_modulus": log_uniform(rng, 0.8, 100.0),
    },
    simulate=simulate,
    solver_scatter=0.015,
    breaks=frozenset({Assumption.UNIFORM}),
    unidentifiable_at_one_load=True,
)
