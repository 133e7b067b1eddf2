"""Adhesion: tip and surface attract each other, so the tip sinks in deeper and clings on unloading.

At a given load the depth gains in proportion to the work, not to its root: what the wider contact adds to first order,
the pull at its edge takes away. A curve shows adhesion at small loads, and most of all late in unloading. Depth counts
from where the undeformed surface would touch, so a surface that jumps into contact is deep at once.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.base.parameters import Parameter
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Let the surface be attracted."""
    return replace(specification, adhesion=values["work"])


MECHANISM = Mechanism(
    "adhesion",
    "adhesion",
    (Parameter("work", "w", "mJ/m^2", 0.0, 1e5, "work that separates tip and surface, for each area"),),
    {"work": 0.0},
    "Johnson, Kendall & Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313",
    lambda s: {"work": Range(0.0, 500.0)},
    simulate=simulate,
    solver_scatter=0.03,
)
