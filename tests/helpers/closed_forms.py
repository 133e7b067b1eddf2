"""A forward model in closed form, for tests of the inference: a linear viscoelastic cone, and what instruments add."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from palpate.models.coordinates import Coordinate, Coordinates
from palpate.solver.variation import added_by_instrument

MATERIAL = Coordinates(
    [Coordinate("modulus", 0.7, 1.4, 1e-3, np.inf), Coordinate("fluidity", 0.0, 0.03, 0.0, np.inf)], {}
)
TRUTH = {"modulus": 1.0, "fluidity": 0.01}
STEP = 1e-6


def cone(protocol, modulus, fluidity):
    """Depth (n,): h^2 = c J * P with a modulus and a viscosity, exact for loading, good enough here."""
    flow = np.cumsum(protocol.sample_load * np.diff(protocol.sample_time, prepend=0.0))
    return 500.0 * np.sqrt(protocol.sample_load / modulus + fluidity * flow + 0.05)


def rounded(protocol, values):
    """Depth (n,) that a cap takes away from the true cone's: a part of its radius, more where that is shallow."""
    depth = cone(protocol, **TRUTH)
    return -values["radius"] * depth / (depth + 300.0)


@dataclass(frozen=True, eq=False)
class ClosedForms:
    """The cone under some conditions, as `palpate.models.forward.Forward`.

    Parameters
    ----------
    conditions
    coordinates
    mechanisms, scale
        That act, too: by what they record, or by `bodily` effects.
    bodily
        Effects of mechanisms that act on the body: functions of a protocol and an amplitude's parameters, by key.
    keep
        Samples that are kept, by condition; by default all.
    """

    conditions: tuple
    coordinates: Coordinates = MATERIAL
    mechanisms: tuple = ()
    scale: object = None
    bodily: dict = field(default_factory=dict)
    keep: dict = field(default_factory=dict)

    def under(self, names):
        return replace(self, conditions=tuple(c for c in self.conditions if c.name in names))

    def joined(self, mechanisms, scale):
        coordinates = self.coordinates.joined(mechanisms, scale)
        return replace(self, coordinates=coordinates, mechanisms=(*self.mechanisms, *mechanisms), scale=scale)

    def amplitudes(self, u):
        named, found = self.coordinates.named(u), {}
        for mechanism in self.mechanisms:
            searched = {name: named[f"{mechanism.key}.{name}"] for name in mechanism.searched(self.scale)}
            found[mechanism.key] = dict(mechanism.from_search(searched, self.scale))
        return found

    @property
    def refinements(self):
        return {}

    def reanchored(self, u):
        return self

    def refined(self, u):
        return None

    def extrapolated(self, u):
        return None

    def points_per_batch(self, u):
        return 4

    def thinned(self):
        keep = {c.name: np.arange(len(c.protocol.sample_time)) % 3 == 2 for c in self.conditions}
        return replace(self, keep=keep), keep

    def curves(self, points):
        return [{c.name: self._curve(u, c) for c in self.conditions} for u in points]

    def tangents(self, points):
        found = []
        for u, here in zip(points, self.curves(points), strict=True):
            ends = self.curves([u + side * step for step in STEP * np.eye(len(u)) for side in (1, -1)])
            slopes = {
                c.name: np.stack(
                    [(a[c.name] - b[c.name]) / (2 * STEP) for a, b in zip(ends[::2], ends[1::2], strict=True)], axis=1
                )
                for c in self.conditions
            }
            found.append((here, slopes))
        return found

    def _curve(self, u, condition):
        protocol, named = condition.protocol, self.coordinates.named(u)
        depth = cone(protocol, named["modulus"], named["fluidity"])
        for key, values in self.amplitudes(u).items():
            if key in self.bodily:
                depth = depth + self.bodily[key](protocol, values)
            else:
                depth = depth + added_by_instrument({key: values}, protocol, depth, condition.order)
        return depth[self.keep[condition.name]] if self.keep else depth
