"""Frame compliance: the load frame deflects under the load, so depth gains compliance * load.

Frames of nanoindenters have compliances of 0.2 to 1.1 nm/mN (the files of public calibrations of fused silica; Oliver &
Pharr), of which a correction may leave any part. Other instruments are known by their shares of the depth alone.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Scale, Values

TYPICAL = 0.3  # nm/mN, of what is left of the compliance of a nanoindenter's frame
SHARE = 0.01  # of the depth, of other instruments
NANOINDENTER = (0.01, 1000.0)  # mN, largest loads of such instruments


def plausible(scale: Scale) -> dict[str, Range]:
    """Return the compliances that leave most of the depth to the specimen."""
    whole, (least, most) = scale.depth / scale.load, NANOINDENTER
    typical = TYPICAL if least <= scale.load <= most else 0.0
    return {"compliance": Range(-0.3 * whole, 0.3 * whole, typical=min(max(typical, SHARE * whole), 0.1 * whole))}


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
    plausible=plausible,
    concealed=lambda rng: {"compliance": signed(rng, 0.1, 5.0)},
    record=record,
    unidentifiable_at_one_load=True,
    remedy="four or more unloadings from loads that span a factor of ten, within each test",
    of_the_instrument=True,
)
