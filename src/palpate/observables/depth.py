"""Depth in response to a prescribed load: the quantity by which everything else is scaled."""

from __future__ import annotations

import numpy as np

from palpate.base.interpolation import depth_at
from palpate.observables.observable import Observable, Quantity
from palpate.study.protocol import LOAD, Protocol


def of_recording(protocol: Protocol, time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the depth (n,) [nm] at the sample times, see `palpate.base.interpolation.depth_at`.

    Parameters
    ----------
    protocol
        Of the condition.
    time, load, depth : ndarray, shape (m,)
        Of a recording [s], [mN], [nm].
    """
    return depth_at(protocol.sample_time, time, depth, protocol.knot_time, protocol.knot_drive)


OBSERVABLE = Observable(
    name="depth",
    unit="nm",
    control=LOAD,
    of_simulation=lambda simulation: simulation.depth,
    of_recording=of_recording,
    recorded=lambda protocol, simulation, response: (simulation.load, response),
    scale=lambda protocol, indenter, response: (1.0, 1.0),
    adds_instrument=True,
    drawn_over="load",
)
DEPTH = Quantity(OBSERVABLE)
