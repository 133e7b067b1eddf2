"""Adhesion: tip and surface attract each other, so the tip sinks in deeper and is held back in unloading.

At a given load the depth grows in proportion to the work of adhesion. Terms with its square root cancel: the wider
contact adds what the tension at its edge takes away. A curve shows adhesion at small loads, and most of all late in
unloading. Depth is zero where the tip meets the undeformed surface, so a surface that jumps into contact begins at a
depth above zero.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Let the surface be attracted."""
    return replace(specification, adhesion=values["work"])


MECHANISM = Mechanism(
    key="adhesion",
    title="adhesion",
    family="adhesion",
    effect="attraction between tip and surface",
    parameters=(Parameter("work", "w", "mJ/m^2", 0.0, 1e5, "work of adhesion per area"),),
    neutral={"work": 0.0},
    example={"work": 100.0},
    source="Johnson, Kendall & Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313",
    plausible=lambda s: {"work": Range(0.0, 500.0)},
    concealed=lambda rng: {"work": log_uniform(rng, 2.0, 300.0)},
    simulate=simulate,
    solver_scatter=0.03,
    breaks=frozenset({Assumption.UNIFORM}),
)
