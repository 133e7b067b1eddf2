r"""Skin: the modulus changes towards the surface, as by weathering, a moulded skin or a polished layer.

$$E(z) = E \, (1 + \mathrm{contrast} \, \exp(-z / \mathrm{depth})),$$

with the depth $z$ below the undeformed surface. Inelastic flow is that of the body. Far below a skin a contact is that
of the body alone; a skin far deeper than the contact is a body of another modulus.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform, signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Let the modulus change towards the surface."""
    return replace(specification, skin_contrast=values["contrast"], skin_depth=values["depth"])


MECHANISM = Mechanism(
    key="skin",
    title="skin of another modulus",
    family="layer",
    effect="the modulus is E (1 + contrast * exp(-z / depth)) below the surface",
    parameters=(
        Parameter("contrast", "c", "-", -0.95, 100.0, "modulus of the surface over that of the body, less one"),
        Parameter("depth", "d", "nm", 1.0, 1e9, "depth at which the contrast has fallen to 37 %"),
    ),
    neutral={"contrast": 0.0, "depth": 100.0},
    example={"contrast": 0.5, "depth": 300.0},
    source="Suresh, Science 292 (2001) 2447-2451 (graded surfaces)",
    plausible=lambda s: {
        "contrast": Range(-0.5, 2.0, least=-0.9),
        "depth": Range(0.1 * s.depth, 5.0 * s.depth, log=True, least=0.01 * s.depth),
    },
    concealed=lambda rng: {"contrast": 0.3 + signed(rng, 0.1, 0.7), "depth": log_uniform(rng, 50.0, 2000.0)},
    simulate=simulate,
    solver_scatter=0.02,
    breaks=frozenset({Assumption.UNIFORM}),
    unidentifiable_at_one_load=True,
    by_default=False,
)
