r"""What answers to the drive of a test, in its own unit, and what a change of it means as a change of depth.

Under load control the depth answers. Under displacement control the load F answers, at a displacement z = h + C F of a
transducer of compliance C. A body that answers with dF more at the same displacement would under the same load be less
deep by

    dh = dF (1 / S + C),    S = n F / h,

with the contact stiffness S of a law F ~ h^n (n = 2 for a sharp tip, 3/2 for a sphere: Sneddon and Hertz). Through a
soft transducer, C >> 1 / S, this is the change of the recorded depth itself; under a rigid one, where the depth cannot
change, that of the contact. S is taken at the largest load, so that one factor serves a whole test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.study.indenter import Indenter
from palpate.study.protocol import LOAD, Protocol


@dataclass(frozen=True)
class Quantity:
    """What answers to the drive.

    Parameters
    ----------
    name
        ``depth`` or ``load``.
    unit
        ``nm`` or ``mN``.
    nm
        Change of depth under the same load for a unit of it [nm].
    share
        Its relative change for a relative change of depth under the same load, at the largest load; a load falls where
        the depth would rise.
    """

    name: str
    unit: str
    nm: float
    share: float

    @classmethod
    def of(cls, protocol: Protocol, indenter: Indenter, response: np.ndarray) -> Quantity:
        """Return what answers in a test in which the `response` (n,) was found at the sampling times."""
        if protocol.control == LOAD:
            return DEPTH
        peak = int(np.argmax(response))
        load, displacement = float(response[peak]), float(protocol.sample_drive[peak])
        if load <= 0.0:
            return cls(LOAD, "mN", max(protocol.compliance, 1.0), -1.0)
        depth = max(displacement - protocol.compliance * load, 1e-6 * displacement)
        nm = depth / ((1.5 if indenter.shape == "sphere" else 2.0) * load) + protocol.compliance
        return cls(LOAD, "mN", nm, -depth / (nm * load))


UNITS = {"depth": "nm", "load": "mN"}
DEPTH = Quantity("depth", "nm", 1.0, 1.0)
