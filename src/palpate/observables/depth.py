"""Depth in response to a prescribed load: the quantity by which everything else is scaled."""

from __future__ import annotations

from palpate.base.interpolation import depth_at
from palpate.observables.observable import Observable, Quantity
from palpate.study.protocol import LOAD

OBSERVABLE = Observable(
    name="depth",
    unit="nm",
    control=LOAD,
    of_simulation=lambda simulation: simulation.depth,
    of_recording=lambda time, recorded_time, load, depth: depth_at(time, recorded_time, depth),
    recorded=lambda protocol, simulation, response: (simulation.load, response),
    scale=lambda protocol, indenter, response: (1.0, 1.0),
    adds_instrument=True,
    drawn_over="load",
)
DEPTH = Quantity(OBSERVABLE)
