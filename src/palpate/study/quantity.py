r"""The response to the drive of a test, in its own unit, and the change of depth that corresponds to a change of it.

Under load control the response is the depth. Under displacement control it is the load F, at a displacement z = h + C F
of a transducer of compliance C. Where the load is larger by dF at the same displacement, the depth under the same load
would be smaller by

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
    """The response to the drive.

    Parameters
    ----------
    name
        ``depth`` or ``load``.
    unit
        ``nm`` or ``mN``.
    nm
        Change of depth under the same load that corresponds to one unit [nm].
    share
        Relative change of the response that corresponds to a relative change of depth under the same load, at the
        largest load; negative for a load.
    """

    name: str
    unit: str
    nm: float
    share: float

    @classmethod
    def of(cls, protocol: Protocol, indenter: Indenter, response: np.ndarray) -> Quantity:
        """Return the quantity of a test whose `response` (n,) is known at the sampling times."""
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
