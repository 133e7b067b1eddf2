"""Frame compliance: the load frame deflects under the load, so depth gains compliance * load."""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add compliance * load.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth + values["compliance"] * load


MECHANISM = Mechanism(
    key="frame_compliance",
    title="frame compliance",
    family="frame",
    effect="depth gains compliance * load, the same compliance in every test",
    parameters=(
        Parameter("compliance", "C_f", "nm/mN", -1000.0, 1000.0, "compliance of the frame beyond what was corrected"),
    ),
    neutral={"compliance": 0.0},
    example={"compliance": 5.0},
    source="Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, equation (8)",
    plausible=lambda s: {"compliance": Range(-0.3 * s.depth / s.load, 0.3 * s.depth / s.load)},
    concealed=lambda rng: {"compliance": signed(rng, 0.1, 5.0)},
    record=record,
    unidentifiable_at_one_load=True,
    remedy="four or more unloadings from loads that span a factor of ten, within each test",
)
