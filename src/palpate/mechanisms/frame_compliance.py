"""Frame compliance: the load frame gives under the load, so depth gains compliance * load."""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.mechanism import Mechanism, Range, Values


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add compliance * load."""
    return depth + values["compliance"] * load


MECHANISM = Mechanism(
    "frame_compliance",
    "frame compliance",
    (Parameter("compliance", "C_f", "nm/mN", -1000.0, 1000.0, "compliance of the frame beyond what was corrected"),),
    {"compliance": 0.0},
    "Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, equation (8)",
    lambda s: {"compliance": Range(-0.3 * s.depth / s.load, 0.3 * s.depth / s.load)},
    record=record,
)
