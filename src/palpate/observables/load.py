r"""Load in response to a prescribed displacement z = h + C F of a transducer of compliance C.

Where the load is larger by dF at the same displacement, the depth under the same load would be smaller by

    dh = dF (1 / S + C),    S = n F / h,

with the contact stiffness S of a law F ~ h^n (n = 2 for a sharp tip, 3/2 for a sphere: Sneddon and Hertz). Through a
soft transducer, C >> 1 / S, this is the change of the recorded depth itself; under a rigid one, where the depth cannot
change, that of the contact. S is taken at the largest load, so that one factor serves a whole test.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.base.interpolation import load_at
from palpate.observables.observable import Observable
from palpate.study.indenter import Indenter
from palpate.study.protocol import DISPLACEMENT, Protocol


def scale(protocol: Protocol, indenter: Indenter, response: np.ndarray) -> tuple[float, float]:
    """Return dh / dF [nm/mN], and the relative change of the load by a relative one of the depth, which is negative.

    Parameters
    ----------
    protocol
        Of the test.
    indenter
        Its shape gives the exponent n.
    response : ndarray, shape (n,)
        Load at the sampling times [mN].
    """
    peak = int(np.argmax(response))
    load, displacement = float(response[peak]), float(protocol.sample_drive[peak])
    if load <= 0.0:
        return max(protocol.compliance, 1.0), -1.0
    depth = max(displacement - protocol.compliance * load, 1e-6 * displacement)
    nm = depth / ((1.5 if indenter.shape == "sphere" else 2.0) * load) + protocol.compliance
    return nm, -depth / (nm * load)


def recorded(protocol: Protocol, simulation: Any, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the load (n,) [mN], and the depth (n,) [nm] that the transducer leaves of its displacement.

    Parameters
    ----------
    protocol
        Says how compliant the transducer is.
    simulation
        A simulated curve.
    response : ndarray, shape (n,)
        Load in place of the simulated one [mN].
    """
    return response, simulation.depth - protocol.compliance * (response - simulation.load)


OBSERVABLE = Observable(
    name="load",
    unit="mN",
    control=DISPLACEMENT,
    of_simulation=lambda simulation: simulation.load,
    of_recording=lambda protocol, time, load, depth: load_at(protocol.sample_time, time, load),
    recorded=recorded,
    scale=scale,
)
