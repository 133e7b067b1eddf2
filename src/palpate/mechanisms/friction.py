"""Friction: the coefficient between indenter and surface differs from that of the base model."""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Put the true coefficient in place of the assumed one."""
    return replace(specification, indenter=replace(specification.indenter, friction=values["coefficient"]))


MECHANISM = Mechanism(
    key="friction",
    title="friction",
    family="friction",
    effect="friction between tip and surface differs from the assumed one",
    parameters=(
        Parameter("coefficient", r"\mu", "-", 0.0, 0.5, "Coulomb friction coefficient in place of the assumed one"),
    ),
    neutral={"coefficient": 0.0},
    example={"coefficient": 0.25},
    source="Bucaille et al., Acta Mater. 51 (2003) 1663-1678",
    plausible=lambda s: {"coefficient": Range(0.0, 0.5)},
    concealed=lambda rng: {"coefficient": log_uniform(rng, 0.02, 0.5)},
    simulate=simulate,
    solver_scatter=0.08,
    assumed=lambda s: {"coefficient": s.indenter.friction},
)
