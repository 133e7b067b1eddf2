"""Zero offset: contact was found too early or too late, so all depths of a recording are off by a constant.

Instruments find it to some nanometres (ISO 14577-1 allows 1 % of the largest depth). Recordings whose contact was
sought state the interval that holds it.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values

TYPICAL = 3.0  # nm
SHARE = 0.005  # of the depth


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add the offset.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth + values["offset"]


MECHANISM = Mechanism(
    key="zero_offset",
    title="zero offset",
    family="zero",
    effect="depth is off by a constant, because contact was found too early or too late",
    parameters=(Parameter("offset", "h_0", "nm", -1e5, 1e5, "depth recorded at contact"),),
    neutral={"offset": 0.0},
    example={"offset": 4.0},
    source="ISO 14577-1:2015, section 7.3 (zero point)",
    plausible=lambda s: {
        "offset": Range(-0.2 * s.depth, 0.2 * s.depth, typical=min(max(TYPICAL, SHARE * s.depth), 0.05 * s.depth))
    },
    concealed=lambda rng: {"offset": signed(rng, 0.5, 20.0)},
    record=record,
    varies=True,
)
