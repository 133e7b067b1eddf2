r"""Size effect: at small depth the material resists inelastic flow more.

The factor of its resistance is $\sqrt{1 + \mathrm{length} / h}$ at the depth $h$.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Let the resistance to inelastic flow depend on the depth."""
    return replace(specification, size_length=values["length"])


MECHANISM = Mechanism(
    key="size_effect",
    title="indentation size effect",
    family="size",
    effect="resistance to inelastic flow grows by sqrt(1 + length / depth) at small depth",
    parameters=(
        Parameter(
            "length", "h^*", "nm", 0.0, 1e6, "depth at which the resistance is sqrt(2) times that at large depth"
        ),
    ),
    neutral={"length": 0.0},
    example={"length": 50.0},
    source="Nix & Gao, J. Mech. Phys. Solids 46 (1998) 411-425, equation (9)",
    plausible=lambda s: {"length": Range(0.0, 600.0)},
    concealed=lambda rng: {"length": log_uniform(rng, 5.0, 300.0)},
    simulate=simulate,
    solver_scatter=0.01,
    breaks=frozenset({Assumption.UNIFORM}),
    unidentifiable_at_one_load=True,
)
